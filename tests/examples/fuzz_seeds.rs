//! Writes the seeds of frames, commands, flash images and controllers into fuzz/corpus: after a change of their formats.
//!
//! `cargo run -p breakaway-tests --example fuzz_seeds`

use std::fs;
use std::path::Path;

use breakaway::control::design::{Design, Request as Asked};
use breakaway::model::Model;
use breakaway_core::link::Request;
use breakaway_tests::fuzz::{corpus, flash};

/// The golden vectors: name and message.
fn golden() -> Vec<(String, Vec<u8>)> {
    let text = include_str!("../../core/src/link/golden.txt");
    let lines = text.lines().filter_map(|line| line.split_once(": "));
    let byte = |hex: &str, i: usize| u8::from_str_radix(hex.get(2 * i..2 * i + 2)?, 16).ok();
    let bytes = |hex: &str| (0..hex.len() / 2).map(|i| byte(hex, i)).collect::<Option<Vec<u8>>>();
    lines.filter_map(|(name, hex)| Some((name.replace(' ', "-"), bytes(hex)?))).collect()
}

fn main() {
    let write = |target: &str, name: &str, bytes: &[u8]| {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus").join(target);
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join(format!("seed-{name}")), bytes).unwrap();
    };
    for (name, bytes) in golden() {
        let request = name.starts_with("request-") && Request::decode(&bytes).is_ok();
        if request {
            // 0.4 s of waiting after it.
            let length = u8::try_from(bytes.len()).unwrap();
            write("command", &name, &[&[100, length], bytes.as_slice()].concat());
        }
        let shown = ["reply-", "event-", "samples", "frame-"].iter().any(|start| name.starts_with(start));
        let plain = name.chars().all(|c| c.is_ascii_alphanumeric() || "-_".contains(c));
        if request || shown && plain {
            write("frame", &name, &bytes);
        }
    }
    for (name, image) in flash::images() {
        write("flash", name, &image);
    }
    let (_, model) = corpus("model").pop().unwrap();
    let model = Model::parse("seed", std::str::from_utf8(&model).unwrap()).unwrap();
    let asked = Asked {
        tick_s: 1e-3,
        delay_ticks: 1,
        bandwidth_hz: None,
        drive_limit: 5.0,
        encoder_step: 1e-3,
        speed: Some(10.0),
        acceleration: Some(100.0),
        adaptation_rate: 1.0,
    };
    let design = Design::new(&model, &asked).unwrap();
    write("controller", "pid", design.to_toml().as_bytes());
    let adaptive = Design { adaptive: true, compensate: true, ..design };
    write("controller", "adaptive", adaptive.to_toml().as_bytes());
}
