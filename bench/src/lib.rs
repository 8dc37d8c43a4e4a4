//! What the benches against the peers share: files of plain numbers, and the median time of a call.

use std::fs;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result};

/// Reads a file of little-endian f64, as numpy's `tofile` writes it.
///
/// # Errors
/// The file cannot be read.
pub fn read_numbers(path: &Path) -> Result<Vec<f64>> {
    let bytes = fs::read(path).with_context(|| path.display().to_string())?;
    Ok(bytes.as_chunks::<8>().0.iter().map(|chunk| f64::from_le_bytes(*chunk)).collect())
}

/// Writes such a file, for numpy's `fromfile`.
///
/// # Errors
/// The file cannot be written.
pub fn write_numbers(path: &Path, numbers: &[f64]) -> Result<()> {
    let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    fs::write(path, bytes).with_context(|| path.display().to_string())
}

/// What a call gives, and the median of the seconds that `repeats` calls of it took.
pub fn timed<T>(repeats: usize, mut call: impl FnMut() -> T) -> (T, f64) {
    let mut seconds = Vec::with_capacity(repeats);
    let mut last = None;
    for _ in 0..repeats.max(1) {
        let start = Instant::now();
        last = Some(black_box(call()));
        seconds.push(start.elapsed().as_secs_f64());
    }
    seconds.sort_by(f64::total_cmp);
    let median = seconds[seconds.len() / 2];
    match last {
        Some(last) => (last, median),
        None => unreachable!("called at least once"),
    }
}
