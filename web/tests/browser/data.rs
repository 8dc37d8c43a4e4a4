//! The folder of measured recordings.

use std::path::PathBuf;

/// `BREAKAWAY_DATA`, or `../shared/data` beside the checkout; `None` where there is none. The path has no `..`.
pub fn measured_data() -> Option<PathBuf> {
    let folder = std::env::var_os("BREAKAWAY_DATA")
        .map_or_else(|| PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data")), PathBuf::from);
    // Chromium lets no page read a file whose path has `..` in it.
    if let Ok(folder) = folder.canonicalize() {
        return Some(folder);
    }
    assert!(std::env::var_os("CI").is_none(), "no measured recordings in {}", folder.display());
    println!("NOT RUN: no measured recordings in {}", folder.display());
    None
}
