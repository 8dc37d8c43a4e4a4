//! The recordings of a discovery: what is fitted, what is only scored, and the noise floor.

use std::sync::Arc;
use std::sync::atomic::AtomicU64;

use crate::fit::{self, MeasuredMotion, Problem, Segment, median, sampled, session};
use crate::recording::Recording;

/// Length of the segments to fit and to score, s (docs/discovery.md, section 8).
pub const FIT_SEGMENT_S: f64 = 0.4;
/// Length of the segments where the motion is so sensitive that no model follows a longer one, s. A rotor that falls
/// into one of many teeth moves so.
pub const SHORT_SEGMENT_S: f64 = 0.1;
/// Windows of the open-loop score, s.
pub const OPEN_LOOP_S: f64 = 1.0;
/// Most segments that are simulated. Longer sessions are thinned evenly.
const MAX_FIT_SEGMENTS: usize = 120;
const MAX_SCORE_SEGMENTS: usize = 80;
/// Measured motion that an effect's memory follows before a segment starts, s.
pub const WARM_UP_S: f64 = 0.3;

/// Prepared recordings.
#[derive(Clone, Debug)]
pub struct Data {
    /// All tracks, on one session clock.
    pub tracks: Arc<[MeasuredMotion]>,
    /// Segments to fit.
    pub fit: Vec<Segment>,
    /// Held-out segments.
    pub score: Vec<Segment>,
    /// Held-out windows of the open-loop score.
    pub open_loop: Vec<Segment>,
    /// Held-out windows over which a model must follow the motion for longer than a segment. They are 2.5 times as long
    /// as a segment: [`OPEN_LOOP_S`] over [`FIT_SEGMENT_S`].
    pub ahead: Vec<Segment>,
    /// Length of the segments, s.
    pub segment_s: f64,
    /// Noise floor of the position: the median of the tracks' standard deviations, position units.
    pub sigma: f64,
    /// Segments there were before sampling.
    pub available: usize,
    /// Longest delay that the sensor's own clock explains, s (see [`Recording::unsure_s`]).
    pub unsure_s: f64,
    /// Mean square below which differences between models do not count, position units squared; 0 where the noise sets
    /// it.
    pub softening: f64,
    /// Samples simulated so far, by everything that was done with these data.
    pub work: Arc<AtomicU64>,
}

impl Data {
    /// Prepares recordings in segments of `segment_s`. Without `holdout` the last third of every recording is held out.
    pub fn new(recordings: &[Recording], holdout: &[Recording], segment_s: f64) -> Self {
        let tracks = session(recordings.iter().chain(holdout));
        let segments = fit::segments(&tracks, segment_s);
        let open = fit::segments(&tracks, OPEN_LOOP_S);
        let held_out = |segment: &Segment| {
            if holdout.is_empty() {
                segment.start * 3 >= tracks[segment.track].t.len() * 2
            } else {
                segment.track >= recordings.len()
            }
        };
        let within = |segment: &Segment| {
            // A segment to fit must not reach into the part that is held out.
            !holdout.is_empty() || (segment.start + segment.len) * 3 <= tracks[segment.track].t.len() * 2
        };
        let of = |all: &[Segment], wanted: &dyn Fn(&Segment) -> bool| -> Vec<Segment> {
            all.iter().copied().filter(|segment| wanted(segment)).collect()
        };
        let available = segments.len();
        let fit = sampled(of(&segments, &|s| !held_out(s) && within(s)), MAX_FIT_SEGMENTS);
        let score = sampled(of(&segments, &held_out), MAX_SCORE_SEGMENTS);
        let open_loop = sampled(of(&open, &held_out), MAX_SCORE_SEGMENTS);
        let ahead = fit::segments(&tracks, OPEN_LOOP_S * segment_s / FIT_SEGMENT_S);
        let ahead = sampled(of(&ahead, &held_out), MAX_SCORE_SEGMENTS);
        let sigma = median(tracks.iter().map(|t| t.sigma).collect()).max(f64::MIN_POSITIVE);
        Self {
            tracks: tracks.into(),
            fit,
            score,
            open_loop,
            ahead,
            segment_s,
            sigma,
            available,
            unsure_s: recordings.iter().map(Recording::unsure_s).fold(0.0, f64::max),
            softening: 0.0,
            work: Arc::default(),
        }
    }

    /// The same data, judged with `softening` in place of the noise where that is larger.
    pub fn softened(&self, softening: f64) -> Self {
        Self { softening, ..self.clone() }
    }

    /// The square root of the mean square below which differences between models do not count.
    pub fn floor(&self) -> f64 {
        self.sigma.max(self.softening.sqrt())
    }

    /// The fitting problem.
    pub fn problem(&self) -> Problem<'_> {
        Problem {
            tracks: &self.tracks,
            segments: &self.fit,
            sigma: self.sigma,
            warm_up_s: WARM_UP_S,
            softening: self.softening,
            coarse: false,
            work: Some(&self.work),
        }
    }

    /// The same over other segments.
    pub fn over<'a>(&'a self, segments: &'a [Segment]) -> Problem<'a> {
        Problem { segments, ..self.problem() }
    }
}
