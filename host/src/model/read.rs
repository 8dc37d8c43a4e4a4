//! Model files in, each mistake with its line.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;

use breakaway_core::plant::Base;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::effects::known_effect;
use super::error::out_of_range;
use super::{BaseSe, EffectEntry, Model, ModelError, known_effects};
use crate::file::read_as;
use crate::mistaken::Content;
use crate::nearest::nearest;
use crate::recording::Units;

type Value<'a> = Spanned<DeValue<'a>>;

impl Model {
    /// Reads the file at `path`.
    ///
    /// # Errors
    /// [`ModelError`], with file, line and the nearest valid name.
    pub fn read(path: &Path) -> Result<Self, ModelError> {
        read_as(path, Content::Model, Self::parse)
    }

    /// Reads a model from text; `file` is its name in messages.
    ///
    /// # Errors
    /// [`ModelError`], with file, line and the nearest valid name.
    pub fn parse(file: &str, text: &str) -> Result<Self, ModelError> {
        let source = Source { file, text };
        let root = DeTable::parse(text).map_err(|error| ModelError::Syntax {
            file: file.to_owned(),
            line: source.line(error.span().map_or(0, |span| span.start)),
            message: error.message().to_owned(),
        })?;
        let root = Table { source, name: "the file".to_owned(), at: 0, keys: root.get_ref() };
        root.only("key", &["base", "units", "effect"])?;

        let base = root.table_at("base", "[base]")?.ok_or_else(|| root.missing("base"))?;
        base.only("key of [base]", &["b", "c", "f1", "se"])?;
        let number = |key| base.number(key)?.ok_or_else(|| base.missing(key));
        let (b, c, f1) = (number("b")?, number("c")?, number("f1")?);
        let plant = Base::new(b, c, f1).map_err(|error| {
            let (key, expected) = out_of_range(error);
            base.wrong(key, expected)
        })?;
        let mut base_se = BaseSe::default();
        if let Some(se) = base.table_at("se", "[base.se]")? {
            se.only("key of [base.se]", &["b", "c", "f1"])?;
            base_se = BaseSe { b: se.standard_error("b")?, c: se.standard_error("c")?, f1: se.standard_error("f1")? };
        }

        let mut units = Units::default();
        if let Some(table) = root.table_at("units", "[units]")? {
            table.only("key of [units]", &["u", "x"])?;
            units.u = table.text("u")?.unwrap_or(units.u);
            units.x = table.text("x")?.unwrap_or(units.x);
        }
        let effects = root.tables("effect", "[[effect]]")?.iter().map(effect).collect::<Result<_, _>>()?;
        Ok(Self { base: plant, base_se, units, effects, provenance: provenance(text) })
    }
}

/// The comments before the first blank line or table.
fn provenance(text: &str) -> Vec<String> {
    text.lines().map_while(|line| line.strip_prefix('#')).map(|line| line.trim().to_owned()).collect()
}

fn effect(table: &Table<'_, '_>) -> Result<EffectEntry, ModelError> {
    let name = table.text("name")?.ok_or_else(|| table.missing("name"))?;
    let Some(known) = known_effect(&name) else {
        let names: Vec<&str> = known_effects().map(|known| known.name).collect();
        return Err(table.unknown("effect", "name", &name, &names));
    };
    let symbols: Vec<&str> = known.parameters.iter().map(|parameter| parameter.symbol).collect();
    table.only(&format!("parameter of {name}"), &[&["name", "se"], symbols.as_slice()].concat())?;
    let mut parameters = BTreeMap::new();
    for parameter in known.parameters {
        let symbol = parameter.symbol;
        let value = table.number(symbol)?.or(parameter.default).ok_or_else(|| table.missing(symbol))?;
        if !(parameter.min..=parameter.max).contains(&value) {
            let (min, max) = (parameter.min, parameter.max);
            return Err(table.wrong(symbol, format!("from {min:?} to {max:?} ({})", parameter.meaning)));
        }
        parameters.insert(symbol.to_owned(), value);
    }
    let mut se = BTreeMap::new();
    if let Some(errors) = table.table_at("se", "[effect.se]")? {
        errors.only(&format!("parameter of {name}"), &symbols)?;
        for symbol in symbols {
            if let Some(value) = errors.standard_error(symbol)? {
                se.insert(symbol.to_owned(), value);
            }
        }
    }
    Ok(EffectEntry { name, parameters, se })
}

#[derive(Clone, Copy)]
struct Source<'a> {
    file: &'a str,
    text: &'a str,
}

impl Source<'_> {
    fn line(&self, at: usize) -> usize {
        let before = self.text.as_bytes().get(..at).unwrap_or_default();
        before.split(|&byte| byte == b'\n').count()
    }
}

/// A table, and where it stands.
struct Table<'t, 'a> {
    source: Source<'a>,
    name: String,
    at: usize,
    keys: &'t DeTable<'a>,
}

impl<'t, 'a> Table<'t, 'a> {
    fn get(&self, key: &str) -> Option<&'t Value<'a>> {
        self.keys.get(key)
    }

    fn missing(&self, key: &str) -> ModelError {
        ModelError::Missing {
            file: self.source.file.to_owned(),
            line: self.source.line(self.at),
            key: key.to_owned(),
            table: self.name.clone(),
        }
    }

    /// The value of `key` is not what it must be.
    fn wrong(&self, key: &str, expected: impl Into<Cow<'static, str>>) -> ModelError {
        let value = self.get(key);
        let span = value.map_or(self.at..self.at, Spanned::span);
        let found = match value.map(Spanned::get_ref) {
            Some(DeValue::Table(_)) => "a table",
            Some(DeValue::Array(_)) => "a list",
            _ => self.source.text.get(span.clone()).unwrap_or_default(),
        };
        ModelError::Value {
            file: self.source.file.to_owned(),
            line: self.source.line(span.start),
            key: key.to_owned(),
            found: found.to_owned(),
            expected: expected.into(),
        }
    }

    fn unknown(&self, what: &str, key: &str, found: &str, valid: &[&str]) -> ModelError {
        let key_at = self.keys.keys().find(|name| name.get_ref() == key);
        let at = if key == found { key_at.map(Spanned::span) } else { self.get(key).map(Spanned::span) };
        ModelError::Unknown {
            file: self.source.file.to_owned(),
            line: self.source.line(at.map_or(self.at, |span| span.start)),
            what: what.into(),
            found: found.to_owned(),
            nearest: nearest(found, valid.iter().copied()).map(Box::from),
            valid: valid.iter().map(|&name| name.to_owned()).collect(),
        }
    }

    /// Refuses the first key that is not one of `valid`.
    fn only(&self, what: &str, valid: &[&str]) -> Result<(), ModelError> {
        let keys = self.keys.keys().map(|key| key.get_ref().as_ref());
        let mut wrong = keys.filter(|key| !valid.contains(key));
        match wrong.next() {
            Some(key) => Err(self.unknown(what, key, key, valid)),
            None => Ok(()),
        }
    }

    fn number(&self, key: &str) -> Result<Option<f64>, ModelError> {
        let Some(value) = self.get(key) else {
            return Ok(None);
        };
        let number = match value.get_ref() {
            DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse().ok(),
            DeValue::Float(float) => float.as_str().parse().ok(),
            _ => None,
        };
        number.filter(|number: &f64| number.is_finite()).map(Some).ok_or_else(|| self.wrong(key, "a finite number"))
    }

    fn standard_error(&self, key: &str) -> Result<Option<f64>, ModelError> {
        match self.number(key)? {
            Some(number) if number < 0.0 => Err(self.wrong(key, "a finite number, 0 or more")),
            other => Ok(other),
        }
    }

    fn text(&self, key: &str) -> Result<Option<String>, ModelError> {
        let Some(value) = self.get(key) else {
            return Ok(None);
        };
        let text = value.get_ref().as_str();
        text.map(|text| Some(text.to_owned())).ok_or_else(|| self.wrong(key, "a text in quotes"))
    }

    fn table_at(&self, key: &str, name: &str) -> Result<Option<Table<'t, 'a>>, ModelError> {
        let Some(value) = self.get(key) else {
            return Ok(None);
        };
        let table = value.get_ref().as_table();
        let table = table.ok_or_else(|| self.wrong(key, "a table"))?;
        Ok(Some(Table { source: self.source, name: name.to_owned(), at: value.span().start, keys: table }))
    }

    fn tables(&self, key: &str, name: &str) -> Result<Vec<Table<'t, 'a>>, ModelError> {
        let Some(value) = self.get(key) else {
            return Ok(Vec::new());
        };
        let wrong = || self.wrong(key, "a list of tables, each under [[effect]]");
        let items = value.get_ref().as_array().ok_or_else(wrong)?;
        items
            .iter()
            .map(|item| {
                Ok(Table {
                    source: self.source,
                    name: name.to_owned(),
                    at: item.span().start,
                    keys: item.get_ref().as_table().ok_or_else(wrong)?,
                })
            })
            .collect()
    }
}
