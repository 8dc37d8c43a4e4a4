//! Set-points from lines of text: [`Lines`] reads them, [`Schedule`] makes the board's set-points of them, [`read`] does
//! the first in a thread of its own.

mod lines;
mod schedule;
mod source;

pub use lines::{LineError, Lines, Point};
pub use schedule::Schedule;
pub use source::{Source, read};
