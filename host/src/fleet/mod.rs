//! A fleet: one folder of recordings per machine, one discovery each, one table over all.
//!
//! What a machine's discovery was made of (hashes of its inputs, version, options) is kept in its result, so that a run
//! that was cut off, or that has new machines, works only on what is not there yet.

pub mod hash;
pub mod machine;
pub mod page;
pub mod result;
pub mod row;
pub mod table;
pub mod work;
