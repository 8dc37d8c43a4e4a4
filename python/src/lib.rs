//! The extension module behind the Python package `breakaway`: arrays in, documents and arrays out.
//!
//! What is computed is the library's. Here are the conversions, the thread that works, and the errors. The classes that
//! a user sees are in `python/breakaway`.
#![forbid(unsafe_code)]
#![allow(clippy::needless_pass_by_value, reason = "pyo3 hands arguments over by value")]

mod analysis;
mod arrays;
mod error;
mod model;
mod options;
mod recording;
mod simulation;
mod work;

/// Functions on arrays and texts, for the package alone.
#[pyo3::pymodule]
mod _native {
    #[pymodule_export]
    use super::analysis::{discover, identify, sinefit};
    #[pymodule_export]
    use super::model::{export, make_model, parse_model, read_model, write_text};
    #[pymodule_export]
    use super::recording::{Recording, read};
    #[pymodule_export]
    use super::simulation::{simulate, simulate_drive};

    /// Version of the package and of the command that it is of.
    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "Python's name for it")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
