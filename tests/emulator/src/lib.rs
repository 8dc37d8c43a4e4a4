//! The NUCLEO-G474RE as its image sees it: the core by Unicorn, and a model of each peripheral that the image uses. Test-only.
//!
//! The models are strict. A peripheral without its clock, a reserved bit, a wrong order: the run ends with the register, the rule
//! and the program counter. The plant is driven by TIM1's compare registers and is read by TIM2.

pub mod accident;
pub mod analog;
pub mod bench;
pub mod bridge;
pub mod bus;
pub mod core;
pub mod cost;
pub mod flash;
pub mod gpio;
pub mod link;
pub mod machine;
pub mod rcc;
pub mod registers;
pub mod store;
#[cfg(unix)]
pub mod terminal;
pub mod timers;
pub mod unicorn;
pub mod watchdog;
pub mod winding;
