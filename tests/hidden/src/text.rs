//! Plain text: recordings as CSV for the tool, the truth as `key: value` and CSV for the scorer.

use crate::{
    experiment::Role,
    session::{Record, Session},
    truth::{Truth, TruthRecord},
};
use std::{fmt::Write, fs, io, path::Path};

impl Session {
    /// One recording as CSV with a commented header; says nothing of what is hidden.
    pub fn csv(&self, record: &Record) -> String {
        let mut text = format!(
            "# experiment: {}\n# drive_unit: {}\n# position_unit: {}\n# encoder_step: {:e}\nt,u,x\n",
            record.name, self.drive_unit, self.position_unit, self.encoder_step
        );
        for ((t, u), x) in record.t.iter().zip(&record.u).zip(&record.x) {
            let _ = writeln!(text, "{t:.*},{u:.9},{x:.9}", self.stamp_decimals);
        }
        text
    }
}

impl Truth {
    /// Everything but the traces, one `key: value` a line.
    pub fn to_text(&self) -> String {
        let mut text = String::new();
        let mut put = |key: &str, value: &dyn std::fmt::Display| {
            let _ = writeln!(text, "{key}: {value}");
        };
        put("seed", &self.seed);
        put("size_percent", &self.size_percent);
        put("b", &self.base.b);
        put("c", &self.base.c);
        put("f1", &self.base.f1);
        put("amplitude", &self.amplitude);
        put("noise_floor", &self.noise_floor);
        put("gap_peak_percent", &self.gap_peak_percent);
        put("gap_rms_percent", &self.gap_rms_percent);
        put("gap_rms_refit_percent", &self.gap_rms_refit_percent);
        put("visibility", &self.visibility);
        if !self.world.is_kind() {
            put("world", &self.world.text());
        }
        for effect in &self.effects {
            put("effect", &effect.hidden.name());
            put("coordinate", &effect.coordinate);
            for (symbol, value) in &effect.parameters {
                put(&format!("{}.{symbol}", effect.hidden.name()), value);
            }
        }
        text
    }
}

impl TruthRecord {
    /// The noise-free traces as CSV.
    pub fn csv(&self) -> String {
        let mut text = String::from("x_true,v_true,load,gap_force\n");
        for k in 0..self.x.len() {
            let _ = writeln!(text, "{:.9},{:.9},{:.9},{:.9}", self.x[k], self.v[k], self.load[k], self.gap_force[k]);
        }
        text
    }
}

/// Writes `fit-*.csv` and `score-*.csv` to `records`, and the truth to `sealed` (`truth.txt` and the
/// noise-free traces), so that the two can be kept apart.
///
/// # Errors
/// Whatever creating the directories or writing the files gives.
pub fn write_session(session: &Session, truth: &Truth, records: &Path, sealed: &Path) -> io::Result<()> {
    fs::create_dir_all(records)?;
    fs::create_dir_all(sealed)?;
    for record in &session.records {
        let role = match record.role {
            Role::Fit => "fit",
            Role::Score => "score",
        };
        let file = records.join(format!("{role}-{}.csv", record.name));
        fs::write(file, session.csv(record))?;
    }
    fs::write(sealed.join("truth.txt"), truth.to_text())?;
    for record in &truth.records {
        fs::write(sealed.join(format!("{}.csv", record.name)), record.csv())?;
    }
    Ok(())
}
