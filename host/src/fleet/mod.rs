//! A fleet: one folder of recordings per machine, one discovery each, one table over all.
//!
//! A machine's result holds what it was made of: hashes of its inputs, version and options. A run that was cut off, or
//! that has new machines, therefore works only on what is missing.

pub mod hash;
pub mod machine;
pub mod page;
pub mod result;
pub mod row;
pub mod table;
pub mod work;
