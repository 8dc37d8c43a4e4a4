//! `cargo xtask setup`: what `cargo xtask test` would fetch on its way, fetched now.

use std::process::Command;
use std::time::Duration;

use anyhow::{Context, Result, ensure};

use crate::chromium;
use crate::cross;
use crate::emulator;
use crate::export;
use crate::python;
use crate::qemu;
use crate::rp2350;
use crate::run::{cargo, run_within, succeeds};
use crate::words;

/// A part that the tests need: its name, and how it is fetched.
type Part = (&'static str, fn() -> Result<()>);

/// Fetches everything.
pub fn all() -> Result<()> {
    components()?;
    let parts: [Part; 9] = [
        ("typos and check-jsonschema", words::programs),
        ("QEMU", || qemu::program().map(drop)),
        ("Unicorn", emulator::library),
        ("the emulator of the Pico 2", || rp2350::emulator().map(drop)),
        ("MuJoCo", || export::python().map(drop)),
        ("what builds and tests the wheel", || python::environments().map(drop)),
        ("the target of the page for the browser", cross::install_wasm),
        ("Chromium", || chromium::program().map(drop)),
        ("the microcontrollers' targets", || cross::install().map(drop)),
    ];
    fetched(&parts)?;
    println!("ready: everything that the tests need is here");
    Ok(())
}

/// Fetches all parts. One that cannot be had does not keep the others away.
fn fetched(parts: &[Part]) -> Result<()> {
    let mut missing = Vec::new();
    for (name, fetch) in parts {
        if let Err(error) = fetch() {
            eprintln!("{name}: {error:#}");
            missing.push(*name);
        }
    }
    ensure!(missing.is_empty(), "not ready: {} could not be had; the other parts are here", missing.join(", "));
    Ok(())
}

/// rustfmt and clippy, which rustup's minimal profile leaves out.
pub fn components() -> Result<()> {
    for component in ["fmt", "clippy"] {
        if !succeeds(&mut cargo([component, "--version"])) {
            let mut add = Command::new("rustup");
            add.args(["component", "add", "rustfmt", "clippy"]);
            return run_within(&mut add, Duration::from_secs(180))
                .context("rustfmt or clippy is missing; install both by `rustup component add rustfmt clippy`");
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use anyhow::bail;

    use super::fetched;

    static FETCHED: AtomicUsize = AtomicUsize::new(0);

    /// The second of three parts cannot be had. The third is fetched, and the message names the second.
    #[test]
    fn one_part_does_not_keep_the_others_away() {
        let here = || {
            FETCHED.fetch_add(1, Ordering::Relaxed);
            Ok(())
        };
        let error = fetched(&[("a", here), ("b", || bail!("no Python")), ("c", here)]).unwrap_err();
        assert_eq!(FETCHED.load(Ordering::Relaxed), 2);
        assert_eq!(error.to_string(), "not ready: b could not be had; the other parts are here");
    }
}
