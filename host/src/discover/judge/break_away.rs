//! The friction at rest. A window of the weak form does not tell it, because an axis at rest stays at rest under any
//! smaller force. The instants at which it breaks away do. The level lies between the force at the last sample that
//! stands and the force at the first that moves.

use breakaway_core::plant::{Effect, Kind};

use super::dataset::Piece;
use super::finding::Finding;
use super::kernels::{Kernels, norm, over};
use super::random_effects::{Estimate, mean};
use super::regression::rms;
use super::search::Judged;
use super::settings::Settings;
use super::sides::Side;
use super::term::Name;
use super::weak_form::WeakForm;

/// Velocity below which an axis stands, in standard deviations of its noise.
const STANDS: f64 = 3.0;
/// Multiple of that velocity at which the axis has departed.
const DEPARTED: f64 = 2.0;
/// Multiple of that velocity which the force above f1 would give an axis that slides. An axis that turns round passes
/// from one to minus one.
const WOULD_REACH: f64 = 4.0;
/// Way between the first and the last sample that stand, in standard deviations of a position's noise. Their difference
/// has √2 of them.
const WAY: f64 = 6.0;
/// Forces over f1 that are tried. Each must give a velocity above [`DEPARTED`] within the samples of which the velocity is
/// made. A larger force needs fewer samples, and shows shorter rests.
const RESOLVED: [f64; 4] = [0.1, 0.2, 0.4, 0.8];
/// Most samples to either side of which a velocity is made.
const MOST_HALF: usize = 200;

/// Mean square distance of a number from the end, and from the middle, of a bracket of 1 in which it is anywhere.
const ABOUT_THE_END: f64 = 1.0 / 3.0;
const ABOUT_THE_MIDDLE: f64 = 1.0 / 12.0;

/// Bounds of the friction at rest, less f1, at one break-away, drive units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bracket {
    /// The least about the last sample that stands.
    pub low: f64,
    /// The largest from there to the first sample that moves.
    pub high: f64,
    /// What loads the gears at that sample: the larger of the drive and of the force against it, drive units.
    pub load: f64,
}

impl Bracket {
    const fn middle(&self) -> f64 {
        0.5 * (self.low + self.high)
    }
    /// Mean square distance of the level from an end or from the middle, by `square`, beside a random force of this rms.
    fn variance(&self, square: f64, random_u: f64) -> f64 {
        square * (self.high - self.low).powi(2) + random_u * random_u
    }
}

/// Stiction, where the axis stands under more than the Coulomb friction f1 beside the judged model. The lower ends of the
/// brackets must be above 0 with the z of a name. They must also be above the share of the drive that counts as known.
/// Friction by load is tied where it holds the axis as well, and gains beside the model where the axis moves. `random_u`
/// is the rms of the random force. `None` where a model with bristles has a friction at rest of its own.
pub(super) fn stiction(form: &WeakForm<'_>, own: &Judged, random_u: f64, settings: &Settings) -> Option<Finding> {
    let side = &own.fitted.u;
    if own.model.terms.iter().any(|term| term.replaces_direction) || !(side.b > 0.0 && side.f1 > 0.0) {
        return None;
    }
    let known_u = settings.predictable * rms(&form.row_u);
    let arrived = own.model.arrived(form);
    // What inertia, c and f1 hold against.
    let mut net = arrived.clone();
    own.model.add_forces(&mut net, side, -1.0);
    let departures = RESOLVED.iter().filter_map(|resolved| {
        let pieces = form.dataset.pieces.iter().zip(arrived.iter().zip(&net));
        let each = pieces
            .filter_map(|(piece, (u, net))| Some(brackets(piece, [u, net], side, &kernel(piece, side, *resolved)?)));
        Departures::new(each.flatten().collect(), random_u.max(known_u))
    });
    let departures = departures.max_by(|a, b| a.low.z().total_cmp(&b.low.z()))?;
    if !(departures.low.z() >= settings.least_z(RESOLVED.len() as f64) && departures.low.mean > known_u) {
        return None;
    }
    let mut finding = Finding::of_z(Effect::new(Kind::Stiction, &[departures.level.mean]), departures.low.z());
    finding.errors[0] = departures.level.error;
    let by_load = Name::Effect(Kind::LoadFriction);
    let moving = own.rounds.last().into_iter().flat_map(|round| &round.tried);
    let mut moving = moving.filter(|tried| tried.names() == [by_load]);
    if departures.rise_with_load() && moving.any(|tried| tried.gain > 0.0) {
        finding.tied.push((Kind::LoadFriction, 0.0));
    }
    Some(finding)
}

/// The departures of a session.
struct Departures {
    brackets: Vec<Bracket>,
    /// Rms of the random force, drive units.
    random_u: f64,
    /// Mean of the lower ends.
    low: Estimate,
    /// Mean of the middles.
    level: Estimate,
}

impl Departures {
    /// `None` where they tell no mean.
    fn new(brackets: Vec<Bracket>, random_u: f64) -> Option<Self> {
        let of = |value: fn(&Bracket) -> f64, square: f64| {
            let values: Vec<f64> = brackets.iter().map(value).collect();
            mean(&values, &brackets.iter().map(|own| own.variance(square, random_u)).collect::<Vec<_>>())
        };
        let (low, level) = (of(|own| own.low, ABOUT_THE_END)?, of(Bracket::middle, ABOUT_THE_MIDDLE)?);
        Some(Self { brackets, random_u, low, level })
    }

    /// Whether a level that is a share of the load leaves no more of the brackets' middles than a constant one.
    fn rise_with_load(&self) -> bool {
        let left = |shape: fn(&Bracket) -> f64| {
            let sum = |value: &dyn Fn(&Bracket) -> f64| {
                self.brackets.iter().map(|own| value(own) / own.variance(ABOUT_THE_MIDDLE, self.random_u)).sum::<f64>()
            };
            let size = sum(&|own| shape(own) * own.middle()) / sum(&|own| shape(own).powi(2));
            sum(&|own| (own.middle() - size * shape(own)).powi(2))
        };
        left(|own| own.load) <= left(|_| 1.0)
    }
}

/// The shortest kernel of the velocity whose noise is small beside what this share of f1 gives within it.
fn kernel(piece: &Piece, side: &Side, resolved: f64) -> Option<Kernels> {
    let kernels = (2..MOST_HALF).map(|half| Kernels::new(half, piece.h_s));
    kernels.into_iter().find(|own| {
        let within_s = 2.0 * own.half as f64 * piece.h_s;
        DEPARTED * slow(piece, own) * side.b < resolved * side.f1 * within_s
    })
}

/// Velocity below which the axis stands.
fn slow(piece: &Piece, kernel: &Kernels) -> f64 {
    STANDS * piece.sigma * norm(&kernel.velocity)
}

/// A bracket for each break-away of a piece, of the drive and the net force at every sample.
fn brackets(piece: &Piece, [u, net]: [&[f64]; 2], side: &Side, kernel: &Kernels) -> Vec<Bracket> {
    let v = over(kernel, &kernel.velocity, &piece.x);
    let slow = slow(piece, kernel);
    let end = piece.x.len().saturating_sub(kernel.half);
    let mut found = Vec::new();
    let mut k = kernel.half;
    while let Some(start) = (k..end).find(|k| v[*k].abs() < slow) {
        let Some(moves) = (start..end).find(|k| v[*k].abs() > DEPARTED * slow) else { break };
        k = moves;
        let Some(last) = (start..moves).rev().find(|k| v[*k].abs() < slow) else { continue };
        let above = |at: usize| v[moves].signum() * net[at] - side.f1;
        let stands = last >= start + 4 * kernel.half && (piece.x[last] - piece.x[start]).abs() <= WAY * piece.sigma;
        if !stands {
            continue;
        }
        // Only samples whose whole velocity is one of rest.
        let sure = start + kernel.half..=last - kernel.half;
        let reached = sure.map(|at| above(at).max(0.0)).sum::<f64>() * piece.h_s / side.b;
        let low = (last - kernel.half..=last).map(above).fold(f64::INFINITY, f64::min);
        let high =
            (last..=moves + kernel.half).filter(|at| *at < net.len()).map(above).fold(f64::NEG_INFINITY, f64::max);
        // A force against the departure shows that the axis slid on, slowly.
        if high > -side.f1 && (low <= 0.0 || reached > WOULD_REACH * slow) {
            found.push(Bracket { low, high, load: u[last].abs().max((u[last] - net[last]).abs()) });
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::ruling::rule;
    use super::*;
    use crate::recording::Recording;

    const B: f64 = 0.02;
    const F1: f64 = 0.3;

    /// 20 s at 1 kHz of an axis that breaks away at `level` and slides at [`F1`]. A sine of .7 V at 3 rad/s drives it
    /// through rest. The position has steps of 1e-4.
    fn axis(level: f64) -> Recording {
        let (mut x, mut v) = (0.0, 0.0_f64);
        let mut recording = Recording::default();
        for k in 0..20_000 {
            let t = 1e-3 * k as f64;
            let u = 0.7 * (3.0 * t).sin();
            recording.t.push(t);
            recording.u.push(u);
            recording.x.push((x / 1e-4_f64).round() * 1e-4);
            for _ in 0..10 {
                let slides = if v == 0.0 { u.signum() } else { v.signum() };
                let free = v + (u - F1 * slides - 0.02 * v) / B * 1e-4;
                let stands = v == 0.0 && u.abs() <= level || v != 0.0 && free * v < 0.0;
                v = if stands { 0.0 } else { free };
                x += v * 1e-4;
            }
        }
        recording
    }

    fn level(recordings: &[Recording]) -> Option<f64> {
        let ruling = rule(recordings, None, &Settings::default()).unwrap();
        let mut at_rest = ruling.seen.iter().filter(|seen| seen.effect.kind == Kind::Stiction);
        at_rest.next().map(|seen| seen.effect.p[0])
    }

    /// An axis that stands up to .45 V and slides at .3 V: the .15 V are told to a tenth. An axis that slides at what it
    /// stands under is told none: it turns round under as much, and stands for no time.
    #[test]
    fn an_axis_that_stands_under_more_than_it_slides_at_has_stiction() {
        let told = level(&[axis(F1 + 0.15)]).unwrap();
        assert!((told - 0.15).abs() < 0.015, "{told}");
        assert_eq!(level(&[axis(F1)]), None);
    }

    /// Levels of .2 of the load rise with it, and equal levels under other loads do not.
    #[test]
    fn a_level_may_rise_with_the_load() {
        let departures = |level: fn(f64) -> f64| {
            let each = [0.5, 1.0, 2.0, 4.0].map(|load| Bracket { low: level(load), high: level(load) + 0.01, load });
            Departures::new(each.to_vec(), 0.01).unwrap()
        };
        assert!(departures(|load| 0.2 * load).rise_with_load() && !departures(|_| 0.2).rise_with_load());
    }
}
