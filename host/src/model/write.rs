//! Model files out: whole or not at all, with the unit of each number beside it.

use std::fmt::Write as _;
use std::path::Path;

use super::effects::known_effect;
use super::{EffectEntry, Model, ModelError, catalogue};
use crate::file::{FileError, write_whole};

impl Model {
    /// Writes the model to `path`, whole or not at all.
    ///
    /// # Errors
    /// [`FileError::Write`]; a file already there is then untouched.
    pub fn write(&self, path: &Path) -> Result<(), ModelError> {
        write_whole(path, |out| out.write_all(self.to_toml().as_bytes()))
            .map_err(|source| FileError::writing(path, &source).into())
    }

    /// The model as TOML; numbers have the fewest digits that give the same bits back.
    pub fn to_toml(&self) -> String {
        let mut out = String::new();
        for remark in &self.provenance {
            // TOML allows a tab in a comment, and characters beyond ASCII; what was read is written again.
            let remark = remark.replace(|c: char| c.is_ascii_control() && c != '\t', " ");
            line(&mut out, format!("# {}", remark.trim()).trim_end());
        }
        if !self.provenance.is_empty() {
            out.push('\n');
        }
        let units = [self.units.of_b(), self.units.of_c(), self.units.of_f1()];
        let base = [self.base.b, self.base.c, self.base.f1];
        line(&mut out, "[base]");
        line(&mut out, "# b·x'' + c·x' + f1·sgn(x') = u");
        for ((symbol, value), unit) in ["b", "c", "f1"].iter().zip(base).zip(&units) {
            line(&mut out, &format!("{symbol} = {value:?}  # {}", comment(unit)));
        }
        let errors = [self.base_se.b, self.base_se.c, self.base_se.f1];
        if errors.iter().any(Option::is_some) {
            line(&mut out, "\n[base.se]");
            line(&mut out, "# Standard errors, in the units above");
            for (symbol, error) in ["b", "c", "f1"].iter().zip(errors) {
                if let Some(error) = error {
                    line(&mut out, &format!("{symbol} = {error:?}"));
                }
            }
        }
        line(&mut out, "\n[units]");
        line(&mut out, &format!("u = {}", quoted(&self.units.u)));
        line(&mut out, &format!("x = {}", quoted(&self.units.x)));
        for effect in &self.effects {
            line(&mut out, "\n[[effect]]");
            line(&mut out, &format!("name = {}", quoted(&effect.name)));
            self.parameters(&mut out, effect);
            if !effect.se.is_empty() {
                line(&mut out, "[effect.se]");
                for (symbol, error) in &effect.se {
                    line(&mut out, &format!("{symbol} = {error:?}"));
                }
            }
        }
        out
    }

    /// An effect's parameters in the catalogue's order, each with its unit; what the catalogue does not know follows.
    fn parameters(&self, out: &mut String, effect: &EffectEntry) {
        let known = known_effect(&effect.name).map_or(&[][..], |definition| definition.parameters);
        for parameter in known {
            if let Some(value) = effect.parameters.get(parameter.symbol) {
                let unit = match parameter.unit {
                    "1" => String::new(),
                    unit => format!("  # {}", comment(&catalogue::unit(unit, &self.units))),
                };
                line(out, &format!("{} = {value:?}{unit}", parameter.symbol));
            }
        }
        for (symbol, value) in &effect.parameters {
            if known.iter().all(|parameter| parameter.symbol != symbol) {
                line(out, &format!("{symbol} = {value:?}"));
            }
        }
    }
}

fn line(out: &mut String, text: &str) {
    // Writing to a String cannot fail.
    let _ = writeln!(out, "{text}");
}

fn comment(text: &str) -> String {
    text.replace(char::is_control, " ")
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
