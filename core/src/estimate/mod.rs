//! What is learnt from a recording: sine fits, limit cycles, and the base model (b, c, f1).

mod angle;
pub mod describing_function;
pub mod limit_cycle;
pub mod linear;
pub mod modulating;
pub mod sine;
