//! Writes the table of docs/robustness.md: `cargo run --release -p breakaway-tests --example robustness -- docs/robustness.md`;
//! without a file, to standard output.

use std::path::PathBuf;

use breakaway::file::write_whole;
use breakaway_tests::robustness_page;

/// Below this line the page is not this program's.
const BY_HAND: &str = "<!-- below: not written by the example -->";

fn main() -> std::io::Result<()> {
    let mut page = robustness_page::page();
    if let Some(path) = std::env::args_os().nth(1).map(PathBuf::from) {
        // What is measured elsewhere stays.
        if let Some((_, rest)) = std::fs::read_to_string(&path).unwrap_or_default().split_once(BY_HAND) {
            page = format!("{page}\n{BY_HAND}{rest}");
        }
        return write_whole(&path, |out| out.write_all(page.as_bytes()));
    }
    print!("{page}");
    Ok(())
}
