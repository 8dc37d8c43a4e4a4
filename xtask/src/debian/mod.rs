//! Debian's packages, unpacked under the target folder: nothing is installed or removed, and nobody need be root.

mod apt;
pub mod python;
pub mod rust;
mod script;
mod tree;

pub use tree::Tree;
