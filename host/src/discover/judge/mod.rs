//! The two-sided force judge. It names the missing effect from the measured forces, before anything is simulated.

pub(in crate::discover) mod bar;
mod compliance;
mod coordinate_search;
pub mod dataset;
pub mod direction;
pub mod evidence;
pub mod finding;
mod friction_observer;
pub mod gain;
pub mod library;
mod observation;
mod one_wave;
pub mod outcome;
pub mod reading_age;
pub mod regression;
pub mod remainder;
mod review;
pub mod ruling;
pub mod search;
pub mod settings;
pub mod sides;
pub mod start;
pub mod term;
pub mod tried;
pub mod wave_numbers;
pub mod weak_form;
pub mod zeros;
