//! The core from outside, in one program: each further one would be linked and lose time. The link has its own, which Miri runs.

mod effects;
mod modulating;
mod relay;
mod sine;
mod sine_errors;
mod sine_laws;
mod sine_search;
mod support;
