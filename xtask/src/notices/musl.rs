//! The notice of musl's C library. Rust links it into the program for musl, and no package of ours has it.

use anyhow::{Context, Result};

use super::package::mit;

/// What it is.
pub const TITLE: &str =
    "the C library musl, in the program for x86_64-unknown-linux-musl (MIT, https://www.musl-libc.org)";
/// Its copyright. libm, which was made from its mathematics, states it too.
const COPYRIGHT: &str = "Copyright © 2005-2020 Rich Felker, et al.";
/// Where libm begins to quote what musl says of those mathematics.
const MATHEMATICS: &str = "The musl libc COPYRIGHT file also includes";

/// Its text, of the licence of libm.
///
/// # Errors
/// libm no longer says so, and the notice must be looked at again.
pub fn notice(libm: &str) -> Result<String> {
    let quoted = libm.find(MATHEMATICS).and_then(|at| libm.get(at..)).filter(|_| libm.contains(COPYRIGHT));
    let quoted = quoted.context("the licence of libm no longer quotes that of musl: see xtask/src/notices/musl.rs")?;
    Ok(format!("{}\n\n{quoted}", mit(COPYRIGHT)?.trim_end()))
}
