//! What is applied to the axis: the dual relay, waveforms and trajectories.

pub mod relay;
pub mod waveform;
