//! What crosses crates, in one program: each further one would link the host anew. `discover` and the virtual board, which
//! take the longest to run, are programs of their own.

mod acceptance;
mod control;
mod docs;
mod errata;
mod fuzz;
mod models;
mod pages;
mod recordings;
