//! The link: golden vectors of the wire format, round trips, and a decoder that takes anything.

mod decoder;
mod examples;
mod golden;
mod messages;
mod samples;
