//! A motor card: a machine, its model, and what the model was made from and judged by. TOML.

use std::fmt::Write as _;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::CardError;
use crate::export::Motor;
use crate::file::{CARD_MARK, read_as};
use crate::mistaken::Content;
use crate::model::Model;

/// A card.
#[derive(Clone, Debug, PartialEq)]
pub struct Card {
    /// Which machine.
    pub head: Head,
    /// What the model was made from.
    pub data: Data,
    /// What is known of motor and gear.
    pub motor: Constants,
    /// Where the recordings were.
    pub range: Range,
    /// How well the model does on what was held out.
    pub held_out: HeldOut,
    /// The model.
    pub model: Model,
}

/// Which machine.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Head {
    /// Short name: the card's file is `NAME.toml`.
    pub name: String,
    /// What the machine is.
    pub machine: String,
    /// Who recorded it, and where the recordings are.
    pub source: String,
    /// The command that gives the model again.
    pub repeat: String,
}

/// What the model was made from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Data {
    /// Licence of the recordings, or that none is stated.
    pub licence: String,
    /// Column of time.
    pub time: String,
    /// Column of the drive.
    pub input: String,
    /// Column of the position.
    pub position: String,
    /// Conditions `column=value` on the rows.
    #[serde(default, rename = "where")]
    pub select: Vec<String>,
    /// The files, in their order.
    pub file: Vec<File>,
}

/// A recording.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct File {
    /// Path under the folder of the data.
    pub name: String,
    /// SHA-256 of its bytes, in hex.
    pub sha256: String,
}

/// What is known of motor and gear; see [`Motor`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Constants {
    /// Torque constant, N·m/A.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motor_constant: Option<f64>,
    /// Resistance, Ω.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resistance: Option<f64>,
    /// Voltage of the supply, V.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub supply: Option<f64>,
    /// Gear.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gear: Option<f64>,
    /// Force at the load per drive unit, N·m or N.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drive_gain: Option<f64>,
    /// Position units per turn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub counts_per_turn: Option<f64>,
}

/// Where the recordings were: the model says nothing beyond.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Range {
    /// Smallest and largest position, position units.
    pub position: [f64; 2],
    /// Largest speed, position units/s.
    pub speed: f64,
    /// Largest drive, drive units.
    pub drive: f64,
}

/// How well the model does on what was held out: the last third of every recording.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HeldOut {
    /// Length of the windows, s.
    pub window_s: f64,
    /// Windows.
    pub windows: usize,
    /// Root mean square error of the simulation, position units.
    pub rmse: f64,
    /// The same of an axis that stands still, position units.
    pub standstill_rmse: f64,
}

#[derive(Debug, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
struct Document {
    card: Head,
    data: Data,
    #[serde(default)]
    motor: Constants,
    range: Range,
    held_out: HeldOut,
    #[schemars(with = "serde_json::Value")]
    model: toml::Table,
}

impl Constants {
    /// The same as the export takes it; what `given` has goes first.
    pub fn beside(&self, given: &Motor) -> Motor {
        // Either the constants or the gain that stands for them.
        let gain = given.drive_gain.is_some();
        let own = given.motor_constant.is_some();
        let unless = |value: Option<f64>, not: bool| value.filter(|_| !not);
        Motor {
            motor_constant: given.motor_constant.or(unless(self.motor_constant, gain)),
            resistance: given.resistance.or(unless(self.resistance, gain)),
            supply: given.supply.or(unless(self.supply, gain)),
            gear: given.gear.or(self.gear),
            drive_gain: given.drive_gain.or(unless(self.drive_gain, own)),
            counts_per_turn: given.counts_per_turn.or(self.counts_per_turn),
            ..*given
        }
    }
}

impl Card {
    /// Reads a card.
    ///
    /// # Errors
    /// [`CardError`], with the file.
    pub fn read(path: &Path) -> Result<Self, CardError> {
        read_as(path, Content::Toml, Self::parse)
    }

    /// Reads a card from text; `file` is its name in messages.
    ///
    /// # Errors
    /// [`CardError`], with the file.
    pub fn parse(file: &str, text: &str) -> Result<Self, CardError> {
        let malformed = |reason: String| CardError::Malformed { file: file.to_owned(), reason };
        let Document { card: head, data, motor, range, held_out, model } =
            toml::from_str(text).map_err(|error| malformed(error.to_string().trim_end().to_owned()))?;
        let model = toml::to_string(&model).map_err(|error| malformed(error.to_string()))?;
        let model = Model::parse("its [model]", &model).map_err(|error| malformed(error.to_string()))?;
        Ok(Self { head, data, motor, range, held_out, model })
    }

    /// The card as TOML; numbers of the model have the fewest digits that give the same bits back.
    pub fn to_toml(&self) -> String {
        let mut out = format!("{CARD_MARK}, breakaway {}.\n", env!("CARGO_PKG_VERSION"));
        out.push_str(&table("card", &self.head));
        let Data { licence, time, input, position, select, file } = &self.data;
        let columns = [("licence", licence), ("time", time), ("input", input), ("position", position)];
        out.push_str("\n[data]\n");
        for (key, value) in columns {
            let _ = writeln!(out, "{key} = {}", quoted(value));
        }
        if !select.is_empty() {
            let list: Vec<String> = select.iter().map(|condition| quoted(condition)).collect();
            let _ = writeln!(out, "where = [{}]", list.join(", "));
        }
        for File { name, sha256 } in file {
            let _ = write!(out, "\n[[data.file]]\nname = {}\nsha256 = {}\n", quoted(name), quoted(sha256));
        }
        if self.motor != Constants::default() {
            out.push_str(&table("motor", &self.motor));
        }
        out.push_str(&table("range", &self.range));
        out.push_str(&table("held_out", &self.held_out));
        out.push('\n');
        for line in self.model.to_toml().lines().skip_while(|line| line.starts_with('#') || line.is_empty()) {
            let line = match line {
                "[base]" | "[base.se]" | "[units]" => line.replacen('[', "[model.", 1),
                "[[effect]]" => "[[model.effect]]".to_owned(),
                "[effect.se]" => "[model.effect.se]".to_owned(),
                other => other.to_owned(),
            };
            let _ = writeln!(out, "{line}");
        }
        out
    }
}

/// A table of a card.
fn table<T: Serialize>(name: &str, value: &T) -> String {
    // Texts, numbers and lists of them have a form in TOML.
    format!("\n[{name}]\n{}", toml::to_string(value).unwrap_or_default())
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
