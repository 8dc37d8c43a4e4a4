//! How a file or arrays are read, as Python passes it.

use std::path::PathBuf;

use anyhow::anyhow;
use breakaway::command::UsageError;
use breakaway::recording::{ReadOptions, Selection};
use pyo3::prelude::*;

/// The keywords of `breakaway.read`; each is the flag of the command with the same name.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Options {
    time: Option<String>,
    time_unit: Option<String>,
    input: Option<String>,
    position: Option<String>,
    current: Option<String>,
    fs: Option<f64>,
    encoder_step: Option<f64>,
    wrap: Option<String>,
    counts_per_turn: Option<f64>,
    select: Vec<String>,
    from_s: Option<f64>,
    to_s: Option<f64>,
    dbc: Option<PathBuf>,
}

impl Options {
    /// The same as the reader takes them.
    ///
    /// # Errors
    /// A keyword whose text says nothing.
    pub fn read(self) -> anyhow::Result<ReadOptions> {
        let refused = |name: &str| {
            let name = name.to_owned();
            move |expected: String| anyhow!(UsageError(format!("{name}: {expected}")))
        };
        let window = self.from_s.is_some() || self.to_s.is_some();
        Ok(ReadOptions {
            time: self.time,
            time_unit: self.time_unit.map(|text| text.parse().map_err(refused("time_unit"))).transpose()?,
            input: self.input,
            position: self.position,
            current: self.current,
            fs_hz: self.fs,
            encoder_step: self.encoder_step,
            wrap: self.wrap.map(|text| text.parse().map_err(refused("wrap"))).transpose()?,
            counts_per_turn: self.counts_per_turn,
            window_s: window.then(|| (self.from_s.unwrap_or(f64::NEG_INFINITY), self.to_s.unwrap_or(f64::INFINITY))),
            max_rows: None,
            dbc: self.dbc,
            select: self
                .select
                .iter()
                .map(|text| text.parse::<Selection>().map_err(refused("where")))
                .collect::<anyhow::Result<_>>()?,
        })
    }
}
