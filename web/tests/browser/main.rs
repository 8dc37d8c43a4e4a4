//! The page of `cargo xtask web` in a headless Chromium, with a real recording. Its numbers and its words are those of the
//! command, and it asks no other machine for anything.

/// Ends a test where there is no page, no Chromium or no recording, and says that it was not run; in CI it fails.
macro_rules! needs {
    ($what:expr) => {
        match $what {
            Some(found) => found,
            None => return,
        }
    };
}

mod chromium;
mod data;
mod errors;
mod page;
mod results;
mod server;
mod size;
