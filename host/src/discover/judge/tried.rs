//! A term, or a pair of terms, that was tried beside a model.

use super::evidence::{Evidence, Rejection};
use super::settings::Settings;
use super::term::{Name, Term};

/// Terms, or pairs of them, that were tried beside a model.
#[derive(Clone, Debug)]
pub struct Tried {
    /// The new terms: one, or two.
    pub terms: Vec<Term>,
    /// What speaks for each of them beside all others.
    pub evidence: Vec<Evidence>,
    /// The smaller gain of the two sides over the model without any of them, nats.
    pub gain: f64,
    /// Sum of the squares that it leaves in every block, on side U and on side A.
    pub blocks: [Vec<f64>; 2],
    /// Wave numbers that are whole in a turn. They are counted, as the teeth of a rotor are, and not fitted.
    pub counted_waves: usize,
}

impl Tried {
    /// Why it cannot be named; `None` if every term holds.
    pub fn rejection(&self) -> Option<Rejection> {
        self.evidence.iter().find_map(|e| e.rejection)
    }
    /// Whether a term is a second body.
    pub(super) fn has_body(&self) -> bool {
        self.terms.iter().any(|term| term.body.is_some())
    }
    /// Amplitudes and parameters.
    pub(super) fn size(&self) -> usize {
        self.terms.iter().map(|t| t.size).sum()
    }
    /// How much better it is than another, in standard deviations over blocks (Vuong's test). The side that tells less
    /// counts.
    pub fn better_than(&self, other: &Self) -> f64 {
        let of_side = |side: usize| {
            let gains: Vec<f64> =
                other.blocks[side].iter().zip(&self.blocks[side]).map(|(theirs, own)| theirs - own).collect();
            let n = gains.len().max(2) as f64;
            let mean = gains.iter().sum::<f64>() / n;
            let variance = gains.iter().map(|g| (g - mean).powi(2)).sum::<f64>() / (n - 1.0);
            mean / (variance / n).sqrt().max(f64::MIN_POSITIVE)
        };
        of_side(0).min(of_side(1))
    }
    /// The names.
    pub fn names(&self) -> Vec<Name> {
        self.terms.iter().map(|t| t.name).collect()
    }
}

/// The best of every name. One zero for all recordings is preferred to one for each, unless the latter does better with
/// the z of a name.
pub(super) fn best_of_each(mut all: Vec<Tried>, settings: &Settings) -> Vec<Tried> {
    all.sort_by(|x, y| rank(y).total_cmp(&rank(x)));
    let mut best: Vec<Tried> = Vec::new();
    for one in all {
        let Some(own) = best.iter_mut().find(|t| t.names() == one.names()) else {
            best.push(one);
            continue;
        };
        let zeros = |tried: &Tried| tried.terms.iter().filter(|t| t.own_zeros).count();
        let as_well = own.rejection() == one.rejection() && own.better_than(&one) < settings.z;
        if as_well && zeros(&one) < zeros(own) {
            *own = one;
        }
    }
    best
}

/// Parts of a nat in which gains are compared. The rounding of numbers, which differs from one machine to another, must
/// not choose among equals.
const PARTS: f64 = 1e9;

/// Order of what was tried: consistent ones first, then by the smaller gain.
pub(super) fn rank(tried: &Tried) -> f64 {
    if tried.gain.is_finite() {
        (tried.gain * PARTS).round() / PARTS + if tried.rejection().is_none() { 10.0 } else { 0.0 }
    } else {
        f64::NEG_INFINITY
    }
}
