//! The folder of measured recordings.

use std::path::PathBuf;

/// `BREAKAWAY_DATA`, or `../shared/data` beside the checkout; `None` where there is none.
pub fn measured_data() -> Option<PathBuf> {
    let folder = std::env::var_os("BREAKAWAY_DATA")
        .map_or_else(|| PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data")), PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    assert!(std::env::var_os("CI").is_none(), "no measured recordings in {}", folder.display());
    println!("NOT RUN: no measured recordings in {}", folder.display());
    None
}
