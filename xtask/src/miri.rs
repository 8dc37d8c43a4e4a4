//! `cargo xtask miri`: the core's tests in Miri, which sees undefined behaviour.
//!
//! The core has no `unsafe` of its own; what it stands on (heapless, postcard, cobs) has. The target is 32-bit like the
//! microcontroller's, and one on which libm has no assembly, which Miri does not know.

use anyhow::{Result, ensure};

use crate::run;

const TARGET: &str = "arm-unknown-linux-gnueabi";

/// Left out: arithmetic over up to two million points against libm or a simulation, hours in Miri, on nothing but numbers.
const LONG: [&str; 5] =
    ["control::", "estimate::angle", "estimate::describing_function", "worst_error", "does_not_drift"];

/// Runs the core's unit tests, but the [`LONG`] ones, and those of the link.
pub fn run(filter: Option<&str>) -> Result<()> {
    // By rustup's name: the cargo that runs this program may be another toolchain's.
    let cargo = |args: &[&str]| {
        let mut command = std::process::Command::new("cargo");
        command.arg("+nightly").args(args).current_dir(run::root());
        // Set by the cargo and the rustup that run this program: they would choose its toolchain again.
        for name in ["RUSTUP_TOOLCHAIN", "CARGO", "RUSTC"] {
            command.env_remove(name);
        }
        command
    };
    ensure!(
        run::succeeds(&mut cargo(&["miri", "--version"])),
        "Miri is missing: `rustup toolchain install nightly --component miri --component rust-src` installs it"
    );
    let mut test = cargo(&["miri", "test", "--package", "breakaway-core", "--lib", "--test", "link"]);
    test.args(["--target", TARGET]).args(filter).arg("--");
    for name in LONG {
        test.args(["--skip", name]);
    }
    // The golden vectors are files, and proptest asks where it is; its cases are few, because each takes seconds.
    test.env("MIRIFLAGS", "-Zmiri-disable-isolation");
    test.env("PROPTEST_CASES", "2").env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "1");
    run::run(&mut test)
}
