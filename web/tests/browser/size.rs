//! How much a browser has to load.

use std::fs;
use std::io::Write as _;

use flate2::Compression;
use flate2::write::GzEncoder;

use super::page::folder;

/// What the page may weigh as a server packs it, bytes. At 10 Mbit/s it is there in 2.4 s.
const MOST_PACKED: usize = 3_000_000;

#[test]
fn the_page_loads_less_than_3_mb() {
    let folder = needs!(folder());
    let mut packed = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let mut gzip = GzEncoder::new(Vec::new(), Compression::default());
        gzip.write_all(&fs::read(entry.unwrap().path()).unwrap()).unwrap();
        packed += gzip.finish().unwrap().len();
    }
    println!("{packed} bytes packed by gzip");
    assert!(packed < MOST_PACKED, "{packed} bytes");
}
