//! The force that an effect explains, folded onto one of its periods over position, with the fitted law.

use std::f64::consts::TAU;

use breakaway_core::plant::effect::{ActsIn, Instant, Over, Search};
use breakaway_core::plant::{Base, Effect, Kind};

use crate::discover::outcome::Discovery;
use crate::fit::MeasuredMotion;
use crate::recording::Recording;

/// Fewest and most bins of a period: 30° and 15° of the wave each. The mean over a bin keeps 98.9 % and more of the wave.
const FEWEST_BINS: usize = 12;
const MOST_BINS: usize = 24;
/// Windows of a bin, on average, before there are more bins than the fewest.
const WINDOWS_OF_BIN: usize = 6;
/// Intervals of the law's curve: 3.75° of the wave each.
const LAW_POINTS: usize = 96;
/// Half-width of a window at the typical speed, rad of the wave. The average over a window then keeps 97 % of the wave.
const HALF_WAVE_RAD: f64 = 0.7;
/// The same up to which a window is used; the average keeps 92 %.
const MOST_WAVE_RAD: f64 = 1.2;
/// Longest and shortest half-width, s and samples: the motion hardly changes within, and the second derivative exists.
const LONGEST_S: f64 = 0.1;
const FEWEST_SAMPLES: usize = 4;
/// Share of the typical speed below which the sign of the velocity is not trusted.
const SLOW: f64 = 0.2;
/// Windows of a bin that is shown; fewer have no standard error to speak of.
const FEWEST_WINDOWS: usize = 3;

/// An effect over one of its periods. Forces are in drive units, positions in position units.
#[derive(Clone, Debug, PartialEq)]
pub struct Fold {
    /// The effect.
    pub kind: Kind,
    /// The coordinate over which it repeats, as [`WhereRow::coordinate`](crate::discover::outcome::WhereRow) has it.
    pub coordinate: &'static str,
    /// Its period.
    pub period: f64,
    /// Position within the period, mean and standard error of the force that the other parts of the model leave.
    pub points: Vec<[f64; 3]>,
    /// Position within the period, force by the fitted law.
    pub law: Vec<[f64; 2]>,
}

/// Every named effect that repeats over position, folded from `recordings`, those that were fitted.
pub fn folds(recordings: &[Recording], found: &Discovery) -> Vec<Fold> {
    let known = found.model.effects.len().saturating_sub(found.effects.len());
    let named = (known..found.model.effects.len())
        .filter_map(|j| Some((j, repeats_over(found.model.effects[j].kind)?)))
        .collect::<Vec<_>>();
    if named.is_empty() {
        return Vec::new();
    }
    let tracks: Vec<MeasuredMotion> = recordings.iter().map(MeasuredMotion::new).collect();
    named.into_iter().filter_map(|(j, (i, over))| fold(&tracks, found, j, i, over)).collect()
}

/// Index of the wave number, and over what the effect repeats; `None` for one that does not repeat over position.
fn repeats_over(kind: Kind) -> Option<(usize, Over)> {
    let parameters = kind.definition().parameters.iter().enumerate();
    let mut waves = parameters.filter_map(|(i, parameter)| match parameter.search {
        Search::Spectrum(over @ (Over::Position | Over::PositionAndDirection)) => Some((i, over)),
        _ => None,
    });
    waves.next().filter(|_| kind.acts_in() == ActsIn::Force)
}

/// The force of an effect at an instant, on the side of the drive.
fn force(effect: &Effect<f64>, base: &Base<f64>, at: &Instant<f64>) -> f64 {
    effect.force(at) - effect.level(base, at) * at.v.signum()
}

fn fold(tracks: &[MeasuredMotion], found: &Discovery, j: usize, i: usize, over: Over) -> Option<Fold> {
    let (base, effects) = (found.model.base, &found.model.effects);
    let own = &effects[j];
    let wave = own.p[i].abs();
    let period = TAU / wave;
    if !period.is_finite() {
        return None;
    }
    let sign = |v: f64| if over == Over::PositionAndDirection { v.signum() } else { 1.0 };
    let windows: Vec<Window> = tracks.iter().flat_map(|track| windows(track, wave)).collect();
    let n_bins = (windows.len() / WINDOWS_OF_BIN).clamp(FEWEST_BINS, MOST_BINS);
    let mut bins = vec![Vec::new(); n_bins];
    for Window { at, acceleration } in &windows {
        let others = effects.iter().enumerate().filter(|(other, _)| *other != j);
        let others: f64 = others.map(|(_, effect)| force(effect, &base, at)).sum();
        let needed = base.b * acceleration + base.c * at.v + base.f1 * at.v.signum() - at.u;
        let phase = at.x.rem_euclid(period) / period;
        bins[((phase * n_bins as f64) as usize).min(n_bins - 1)].push(sign(at.v) * (needed - others));
    }
    let points: Vec<[f64; 3]> = bins
        .iter()
        .enumerate()
        .filter(|(_, forces)| forces.len() >= FEWEST_WINDOWS)
        .map(|(bin, forces)| {
            let n = forces.len() as f64;
            let mean = forces.iter().sum::<f64>() / n;
            let variance = forces.iter().map(|force| (force - mean).powi(2)).sum::<f64>() / (n - 1.0);
            [(bin as f64 + 0.5) / n_bins as f64 * period, mean, (variance / n).sqrt()]
        })
        .collect();
    let law = (0..=LAW_POINTS).map(|k| {
        let x = k as f64 / LAW_POINTS as f64 * period;
        [x, force(own, &base, &Instant { t: 0.0, x, v: 1.0, u: 0.0, over_s: 0.0 })]
    });
    let coordinate = if over == Over::Position { "position" } else { "position × direction" };
    (points.len() > n_bins / 2).then(|| Fold { kind: own.kind, coordinate, period, points, law: law.collect() })
}

/// Averages over a window.
struct Window {
    at: Instant<f64>,
    acceleration: f64,
}

/// Windows in motion without a reversal. The wave turns by at most [`MOST_WAVE_RAD`] in each.
fn windows(track: &MeasuredMotion, wave: f64) -> Vec<Window> {
    let half_s = (HALF_WAVE_RAD / (wave * track.typical_speed)).min(LONGEST_S);
    let half = ((half_s / track.ts).round() as usize).max(FEWEST_SAMPLES);
    let mut found = Vec::new();
    for piece in track.pieces.windows(2) {
        for centre in (piece[0] + half..piece[1].saturating_sub(half)).step_by(half) {
            let (first, last) = (centre - half, centre + half);
            let direction = track.vs[centre].signum();
            if track.vs[first..=last].iter().any(|v| v * direction < SLOW * track.typical_speed) {
                continue;
            }
            let window = averaged(track, first, last);
            let long_s = 0.5 * (track.t[last] - track.t[first]);
            if wave * window.at.v.abs() * long_s <= MOST_WAVE_RAD {
                found.push(window);
            }
        }
    }
    found
}

/// Averages over the samples from `first` to `last`, weighted by (1 − s²)³ at the samples, s from −1 to 1, and by
/// straight lines between them. The weight's second derivative is then a sum of impulses at the samples. The average
/// of the acceleration is a sum over measured positions without any error of quadrature.
fn averaged(track: &MeasuredMotion, first: usize, last: usize) -> Window {
    let middle_s = 0.5 * (track.t[first] + track.t[last]);
    let long_s = 0.5 * (track.t[last] - track.t[first]);
    let at = |k: usize| (1.0 - ((track.t[k] - middle_s) / long_s).powi(2)).max(0.0).powi(3);
    let origin = track.x[first];
    let (mut weight, mut x, mut v, mut a, mut u) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for k in first..last {
        let dt = track.t[k + 1] - track.t[k];
        let (here, next) = (at(k), at(k + 1));
        let [from, to] = [track.x[k] - origin, track.x[k + 1] - origin];
        let mean = 0.5 * (here + next);
        weight += mean * dt;
        x += mean * dt * 0.5 * (from + to);
        v += mean * (to - from);
        // By parts: the velocity's mean over the interval against the weight's slope in it.
        a -= (next - here) / dt * (to - from);
        u += mean * dt * track.u[k];
    }
    let [x, v, a, u] = [origin + x / weight, v / weight, a / weight, u / weight];
    Window {
        at: Instant { t: middle_s, x, v, u, over_s: last.abs_diff(first) as f64 * 0.5 * track.ts },
        acceleration: a,
    }
}
