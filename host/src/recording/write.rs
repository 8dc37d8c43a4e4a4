//! Recordings out: the same file the reader takes, every number bit for bit.

use std::io::{self, Write};
use std::path::Path;

use super::header::one_line;
use super::{CURRENT, Container, Recording, RecordingError};
use crate::file::{FileError, write_whole};

impl Recording {
    /// Writes the recording to `path`, whole or not at all, in the form that the name's ending asks for ([`Container`]).
    /// It has the columns `t,u,x`, and `i_A` where there is a current. The header has units and provenance.
    ///
    /// # Errors
    /// [`FileError::Write`]; a file already there is then untouched.
    pub fn write(&self, path: &Path) -> Result<(), RecordingError> {
        let written = write_whole(path, |mut out| match Container::of(path) {
            Container::Csv => self.write_to(&mut out),
            other => {
                let mut csv = Vec::new();
                self.write_to(&mut csv)?;
                other.write(&csv[..], &mut out)
            }
        });
        written.map_err(|source| FileError::writing(path, &source).into())
    }

    /// Writes the recording as CSV. Floats have the fewest digits that give the same bits back.
    ///
    /// # Errors
    /// What `out` reports; `InvalidInput` if the columns differ in length or hold a number that is not finite.
    pub fn write_to(&self, out: &mut impl Write) -> io::Result<()> {
        let measured = !self.current.is_empty();
        let current = if measured { self.current.len() } else { self.t.len() };
        if [self.u.len(), self.x.len(), current] != [self.t.len(); 3] {
            return Err(invalid("the columns differ in length"));
        }
        if let Some(tick_s) = self.evenly_sampled() {
            writeln!(out, "# tick: {:?} s", decimal(tick_s))?;
        }
        let (u, x) = (unit(&self.units.u), unit(&self.units.x));
        let (column, of_current) =
            if measured { (format!(",{CURRENT}"), format!(", {CURRENT}=A")) } else { Default::default() };
        writeln!(out, "# units: t=s, u={u}, x={x}{of_current}")?;
        if let Some(step) = self.encoder_step {
            writeln!(out, "# encoder step: {step:?} {x}")?;
        }
        if let Some(counts) = self.counts_per_turn {
            writeln!(out, "# counts per turn: {counts:?}")?;
        }
        if !self.gaps.is_empty() {
            let rows: Vec<String> = self.gaps.iter().map(usize::to_string).collect();
            writeln!(out, "# gaps: {}", rows.join(", "))?;
        }
        for (key, value) in &self.meta {
            let key = one_line(key).replace(':', " ");
            writeln!(out, "# {}: {}", key.trim(), one_line(value).trim())?;
        }
        writeln!(out, "t,u,x{column}")?;
        for (k, ((t, u), x)) in self.t.iter().zip(&self.u).zip(&self.x).enumerate() {
            let current = self.current.get(k);
            if !(t.is_finite() && u.is_finite() && x.is_finite() && current.is_none_or(|i| i.is_finite())) {
                return Err(invalid("a number is not finite"));
            }
            // Debug, not Display: it changes to an exponent where zeros would fill the line.
            write!(out, "{t:?},{u:?},{x:?}")?;
            match current {
                Some(current) => writeln!(out, ",{current:?}")?,
                None => writeln!(out)?,
            }
        }
        Ok(())
    }
}

/// A tick without the last digits that differences of a running time leave: 0.001, not 0.001000000000000004.
fn decimal(tick_s: f64) -> f64 {
    let rate_hz = (1.0 / tick_s).round();
    if rate_hz >= 1.0 && (tick_s * rate_hz - 1.0).abs() < 1e-9 { 1.0 / rate_hz } else { tick_s }
}

fn invalid(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, what)
}

/// A unit as the `units` line can hold it.
fn unit(text: &str) -> String {
    one_line(text).replace([',', '='], " ").trim().to_owned()
}
