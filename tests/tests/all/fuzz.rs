//! The inputs of fuzz/corpus (seeds, and what was found once) and damaged copies of them: no promise is broken, and both
//! answers are frequent. `cargo xtask fuzz` searches for longer, guided by coverage.

use std::panic::catch_unwind;

use breakaway_tests::fuzz::damage::damaged;
use breakaway_tests::fuzz::{Target, corpus, target};

fn judge(target: Target, what: &str, bytes: &[u8]) -> bool {
    catch_unwind(|| target.take(bytes))
        .unwrap_or_else(|_| panic!("{}: {what}: {:?}", target.name, String::from_utf8_lossy(bytes)))
}

fn holds(name: &str) {
    let target = target(name);
    let corpus = corpus(name);
    for (file, bytes) in &corpus {
        let accepted = judge(target, file, bytes);
        // A seed that is refused is of an older format: examples/fuzz_seeds.rs writes those of the link and the flash.
        // A board without flash, model and records refuses to save, to identify and to feed forward. One that follows
        // nothing refuses set-points.
        let refused =
            ["save", "identify", "start_track", "set_points"].map(|name| format!("command/seed-request-{name}"));
        let may_be_refused = !file.contains("seed-") || refused.iter().any(|name| file.contains(name));
        assert!(accepted || may_be_refused, "{file} is refused");
    }
    let seeds: Vec<Vec<u8>> = corpus.into_iter().map(|(_, bytes)| bytes).collect();
    let copies = (0..target.copies).map(|n| (n, damaged(&seeds, n, target.most_bytes)));
    let good = copies.filter(|(n, bytes)| judge(target, &format!("copy {n}"), bytes)).count() as u64;
    let bad = target.copies - good;
    assert!(20 * good > target.copies && 20 * bad > target.copies, "{good} of {} accepted", target.copies);
}

#[test]
fn recordings() {
    holds("recording");
}

#[test]
fn logs() {
    holds("log");
}

#[test]
fn frames_of_can() {
    holds("can");
}

#[test]
fn models() {
    holds("model");
}

#[test]
fn controllers() {
    holds("controller");
}

#[test]
fn experiments() {
    holds("experiment");
}

#[test]
fn frames() {
    holds("frame");
}

#[test]
fn commands() {
    holds("command");
}

#[test]
fn flash_images() {
    holds("flash");
}
