//! Writes the table of docs/robustness.md: `cargo run --release -p breakaway-tests --example robustness -- docs/robustness.md`;
//! without a file, to standard output.

use std::path::PathBuf;

use breakaway::file::write_whole;
use breakaway_tests::robustness_page;

fn main() -> std::io::Result<()> {
    let page = robustness_page::page();
    if let Some(path) = std::env::args_os().nth(1).map(PathBuf::from) {
        return write_whole(&path, |out| out.write_all(page.as_bytes()));
    }
    print!("{page}");
    Ok(())
}
