//! Our sine fits on the records that `bench/peers/sine.py` has drawn. `sine FOLDER` reads `sine.csv`, which has the
//! samples, the period and the estimate of each record. It reads their samples from `sine.bin`, and writes
//! `sine_ours.csv`.

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use breakaway_bench::{read_numbers, timed};
use breakaway_core::estimate::sine::{
    BlockSums, FrequencySearch, SineError, SineFit, SineModel, StreamingSine, even, fit_free,
};

/// Each fit is timed as the median of so many.
const REPEATS: usize = 5;

fn streaming(samples: &[f32], omega_rad_s: f64, ts: f64) -> Result<SineFit, SineError> {
    let config = StreamingSine::new(omega_rad_s, ts)?;
    let mut sums: BlockSums<f32> = BlockSums::new();
    config.push_slice(&mut sums, samples);
    config.fit(&sums)
}

fn main() -> Result<()> {
    let folder = PathBuf::from(std::env::args().nth(1).context("sine FOLDER")?);
    let numbers = read_numbers(&folder.join("sine.bin"))?;
    let list = fs::read_to_string(folder.join("sine.csv"))?;
    let mut rest = numbers.as_slice();
    let mut rows = String::from("record,method,omega_rad_s,amplitude,seconds\n");
    for (record, line) in list.lines().skip(1).enumerate() {
        let cells: Vec<f64> = line.split(',').map(str::parse).collect::<Result<_, _>>().context("sine.csv")?;
        let [samples, ts, estimate, ..] = cells[..] else { anyhow::bail!("sine.csv: {line}") };
        let samples = samples as usize;
        ensure!(rest.len() >= samples, "sine.bin is shorter than sine.csv says");
        let (y, later) = rest.split_at(samples);
        rest = later;
        let narrow: Vec<f32> = y.iter().map(|y| *y as f32).collect();
        let search = FrequencySearch::around(estimate);
        let batch = timed(REPEATS, || fit_free(even(y, 0.0, ts), search, SineModel::default()));
        let blocks = timed(REPEATS, || streaming(&narrow, estimate, ts));
        for (method, (fit, seconds)) in [("batch", batch), ("streaming f32", blocks)] {
            let (omega, amplitude) = fit.map_or((f64::NAN, f64::NAN), |fit| (fit.omega_rad_s, fit.amplitude));
            writeln!(rows, "{record},{method},{omega:.17e},{amplitude:.17e},{seconds:e}")?;
        }
    }
    fs::write(folder.join("sine_ours.csv"), rows)?;
    Ok(())
}
