//! Whether gravity would help: tried where the position is an angle, the motion covers enough of it, and the model misses something.

use breakaway_core::plant::{Effect, Kind};
use nalgebra::DMatrix;

use super::equation_error::{both_directions, from_weak};
use super::held_out::{self, Comparison, Fold};
use super::output_error::{FIT_ITERATIONS, FIT_SEGMENT_S, OUTPUT_ERROR, model_of, output_error};
use super::weak::{self, Window};
use crate::fit::{Candidate, Free, MeasuredMotion, Problem, median, session};
use crate::recording::Recording;

/// Travel from which the data tell gravity from a constant load and a spring, rad. Over half of it the cosine falls by
/// 12 %.
const LEAST_TRAVEL_RAD: f64 = 1.0;
/// Share by which gravity must lower the error of prediction to be worth a discovery.
const WORTH: f64 = 0.05;

/// Gravity tried beside the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GravityTrial {
    /// Largest position less the smallest one, rad.
    pub travel_rad: f64,
    /// Held-out prediction without gravity against the one with it.
    pub comparison: Comparison,
}

impl GravityTrial {
    /// Whether gravity lowers the error of held-out prediction, beyond chance and by a share that is worth it.
    pub fn helps(&self) -> bool {
        self.comparison.second_is_better() && self.comparison.ratio() > 1.0 / (1.0 - WORTH)
    }
}

/// Tries gravity beside the base, both by `estimator`. `None` where the position is no angle, covers too little of it, or where too
/// few blocks can be held out.
pub(super) fn tried(recordings: &[Recording], estimator: &str) -> Option<GravityTrial> {
    let mut recordings = recordings.to_vec();
    for recording in &mut recordings {
        recording.radians_per_unit()?;
        recording.in_radians();
    }
    let tracks = session(&recordings);
    let travel_rad = travel(&tracks);
    if travel_rad < LEAST_TRAVEL_RAD {
        return None;
    }
    let windows = weak::windows(&tracks);
    let both = both_directions(&windows);
    let noise = median(tracks.iter().map(|t| t.sigma).collect());
    let problem = output_error(&tracks, &[], noise);
    let blocks = held_out::blocks(&tracks);
    let models = |i| {
        let fold = held_out::fold(&tracks, &blocks, &windows, FIT_SEGMENT_S, i);
        let with = |gravity| fitted(&problem, &fold, both, gravity, estimator);
        Some([with(false)?, with(true)?])
    };
    let comparison = held_out::compare(&problem, &blocks, &[models(0)?, models(1)?])?;
    Some(GravityTrial { travel_rad, comparison })
}

/// Largest position less the smallest one.
fn travel(tracks: &[MeasuredMotion]) -> f64 {
    let all = || tracks.iter().flat_map(|track| track.xs.iter().copied());
    all().fold(f64::MIN, f64::max) - all().fold(f64::MAX, f64::min)
}

/// The base with or without gravity, fitted to one fold.
fn fitted(problem: &Problem<'_>, fold: &Fold, both: bool, gravity: bool, estimator: &str) -> Option<Candidate> {
    let model = by_forces(problem.tracks, &fold.windows, both, gravity)?;
    if estimator != OUTPUT_ERROR {
        return Some(model);
    }
    let problem = Problem { segments: &fold.segments, ..*problem };
    Some(problem.fit(&model, &Free::all(&model.effects), None, FIT_ITERATIONS).ok()?.candidate)
}

/// The same by equation error: m·sin(x + φ) is linear in m·cos φ and m·sin φ.
fn by_forces(tracks: &[MeasuredMotion], windows: &[Window], both: bool, gravity: bool) -> Option<Candidate> {
    let (base, target) = weak::base_columns(windows);
    let own = if both { 4 } else { 3 };
    let columns = DMatrix::from_fn(windows.len(), own + if gravity { 2 } else { 0 }, |i, j| {
        let x = |k: usize| tracks[windows[i].track].xs[k];
        match j.checked_sub(own) {
            None => base[(i, j)],
            Some(0) => windows[i].integral(|k| x(k).sin()),
            Some(_) => windows[i].integral(|k| x(k).cos()),
        }
    });
    let fit = weak::solve(&columns, &target)?;
    let estimate = from_weak(&fit, both);
    if estimate.b.value <= 0.0 {
        return None;
    }
    let mut model = model_of(&estimate);
    if gravity {
        // On the side of the drive, as the catalogue has it.
        let (sine, cosine) = (-fit.coefficients[own], -fit.coefficients[own + 1]);
        model.effects.push(Effect::new(Kind::GravityLoad, &[sine.hypot(cosine), cosine.atan2(sine)]));
    }
    Some(model)
}
