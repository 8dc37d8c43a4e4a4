//! The NUCLEO-G474RE's image, unmodified, on models of its registers that forgive nothing (docs/board-nucleo-g474re.md).

/// Ends a test where there is no Unicorn, and says that it was not run; in CI it fails.
macro_rules! needs_unicorn {
    () => {
        if let Err(error) = breakaway_emulator::unicorn::available() {
            assert!(std::env::var_os("CI").is_none(), "{error}");
            eprintln!("NOT RUN: {error}");
            return;
        }
    };
}

mod boot;
mod cost;
mod current;
mod faults;
mod flash;
mod identify;
mod machine;
#[cfg(unix)]
mod port;
mod resets;
mod rules;
