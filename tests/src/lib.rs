//! Shared helpers of the cross-crate tests.

pub mod adaptive;
pub mod adaptive_default;
pub mod adaptive_page;
pub mod blind;
pub mod drift;
pub mod fuzz;
pub mod machines;
pub mod markdown;
pub mod mujoco;
pub mod papers;
pub mod requests;
pub mod robustness;
pub mod robustness_page;
pub mod sentences;
#[cfg(unix)]
pub mod soak;
use std::path::PathBuf;

/// The folder of measured recordings: `BREAKAWAY_DATA`, or `../shared/data` beside the checkout.
///
/// `None` where there is none: the test then says that it was not run and where the data comes from.
///
/// # Panics
/// In CI (`CI` is set) their absence is a failure.
pub fn measured_data() -> Option<PathBuf> {
    let folder = std::env::var_os("BREAKAWAY_DATA")
        .map_or_else(|| PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data")), PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    assert!(std::env::var_os("CI").is_none(), "no measured recordings in {}", folder.display());
    println!(
        "NOT RUN: no measured recordings in {}. EMPS (emps/emps_train.csv) is the benchmark of Janot, Gautier and Brunot, \
         2019, nonlinearbenchmark.org; laas-motor/ is the anti-cogging bench of H. Andrade, LAAS. Set BREAKAWAY_DATA to \
         the folder that holds both.",
        folder.display()
    );
    None
}
