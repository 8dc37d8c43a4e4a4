//! What is applied to the axis: the dual relay and the trajectories.

pub mod relay;
