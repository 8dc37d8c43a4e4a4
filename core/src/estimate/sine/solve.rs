//! From block phasors to the sine: weighted least squares with closed-form sums.
//!
//! About its own centre, a block of L samples sees `y = P·cos ωm + Q·sin ωm + d`, and its sums
//! `C = Σy·cos wm`, `S = Σy·sin wm`, `Y = Σy` (w the oscillator's frequency) have the noise covariance σ²G with
//! `G = [[C2, 0, D(w)], [0, S2, 0], [D(w), 0, L]]`, `C2, S2 = (L ± D(2w))/2`, D the Dirichlet sum Σcos αm.
//! Whitened by the Cholesky factor of G this is three rows of unit noise per block:
//!
//! - `Y/√L               = (D(ω)·P + L·d)/√L`
//! - `(C − Y·D(w)/L)/√V  = (Kc − D(w)D(ω)/L)·P/√V`,  V = C2 − D(w)²/L; the offset has dropped out
//! - `S/√S2              = Ks·Q/√S2`,  with `Kc, Ks = (D(ω−w) ± D(ω+w))/2`
//!
//! linear in (p, q, d) by `P = q·cos ωtc + p·sin ωtc`, `Q = p·cos ωtc − q·sin ωtc`, tc the block's centre.

use super::columns::SineModel;
use super::normal::Normal;
use super::refine::{Border, Point, refine};
use super::result::{Scales, SineFit};
use super::{MIN_CYCLES_FREE, SineError};
use crate::estimate::angle::sin_cos;
use crate::scalar::nco::Nco;
use core::f64::consts::{PI, TAU};

/// Linear parameters: p, q, d.
const N: usize = 3;

/// What the solution needs to know beside the blocks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Record {
    pub nco: Nco,
    pub sample_period_s: f64,
    pub samples: u64,
    /// Σ (y − reference)².
    pub power: f64,
    pub reference: f64,
    /// B.
    pub capacity: usize,
    /// Whether neighbours have been paired: blocks may be longer than a quarter period.
    pub doubled: bool,
}

/// One block, its phasor turned to its own centre.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Block {
    /// Centre, in samples from the record's first.
    centre: f64,
    length: u64,
    cos: f64,
    sin: f64,
    sum: f64,
}

impl Block {
    /// A block of `length` samples from sample `start` on, with its sums Σy·cos φ, Σy·sin φ, Σy.
    pub(super) fn new(nco: Nco, start: u64, length: u64, [cos, sin, sum]: [f64; 3]) -> Self {
        // The phase at the centre, exactly: the centre may lie between two samples, so in half steps modulo 2³³.
        let twice_centre = 2_u64.wrapping_mul(start).wrapping_add(length).wrapping_sub(1);
        let half_steps = u64::from(nco.word()).wrapping_mul(twice_centre) & ((1 << 33) - 1);
        let (s, c) = sin_cos(half_steps as f64 * (TAU / 8_589_934_592.0));
        Self { centre: 0.5 * twice_centre as f64, length, cos: cos * c + sin * s, sin: sin * c - cos * s, sum }
    }
}

/// `D(α) = Σ cos αm = sin(αL/2)/sin(α/2)` over L samples centred on 0, and dD/dα; |α| < 2π.
fn dirichlet(alpha: f64, length: f64) -> (f64, f64) {
    let x = alpha * length;
    if x.abs() < 0.03 {
        // Power series in α; the next terms are 2e-15 of D, and 2e-10 of a slope that is itself next to 0.
        let m2 = length * (length * length - 1.0) / 12.0;
        let m4 = m2 * (3.0 * length * length - 7.0) / 20.0;
        let a2 = alpha * alpha;
        return (length - a2 * (m2 / 2.0 - a2 * m4 / 24.0), -alpha * (m2 - a2 * m4 / 6.0));
    }
    let (sin_l, cos_l) = sin_cos(0.5 * x);
    let (sin, cos) = sin_cos(0.5 * alpha);
    let sum = sin_l / sin;
    (sum, 0.5 * (length * cos_l - sum * cos) / sin)
}

/// What depends on a block's length alone.
#[derive(Clone, Copy, Debug)]
struct Geometry {
    length: f64,
    /// D(w)/L.
    mean_cos: f64,
    /// 1/√L, 1/√V, 1/√S2.
    weight_sum: f64,
    weight_cos: f64,
    weight_sin: f64,
}

impl Geometry {
    fn new(w: f64, length: u64) -> Self {
        let length = length as f64;
        let (single, _) = dirichlet(w, length);
        let (double, _) = dirichlet(2.0 * w, length);
        let mean_cos = single / length;
        let v = 0.5 * (length + double) - single * mean_cos;
        let s2 = 0.5 * (length - double);
        Self {
            length,
            mean_cos,
            weight_sum: 1.0 / libm::sqrt(length),
            weight_cos: 1.0 / libm::sqrt(v),
            weight_sin: 1.0 / libm::sqrt(s2),
        }
    }
    /// The whitened sums of a block.
    fn whiten(&self, block: &Block) -> [f64; 3] {
        [
            block.sum * self.weight_sum,
            (block.cos - block.sum * self.mean_cos) * self.weight_cos,
            block.sin * self.weight_sin,
        ]
    }
}

/// Response of the whitened sums of blocks of one length to a sine at ω, with the derivative by ω.
#[derive(Clone, Copy, Debug)]
struct Response {
    offset: f64,
    sum: (f64, f64),
    cos: (f64, f64),
    sin: (f64, f64),
}

impl Response {
    fn new(geometry: &Geometry, w: f64, omega: f64) -> Self {
        let difference = dirichlet(omega - w, geometry.length);
        let total = dirichlet(omega + w, geometry.length);
        let own = dirichlet(omega, geometry.length);
        let mean = geometry.mean_cos;
        let cos = |d: f64, t: f64, o: f64| (0.5 * (d + t) - mean * o) * geometry.weight_cos;
        let sin = |d: f64, t: f64| 0.5 * (d - t) * geometry.weight_sin;
        Self {
            offset: geometry.length * geometry.weight_sum,
            sum: (own.0 * geometry.weight_sum, own.1 * geometry.weight_sum),
            cos: (cos(difference.0, total.0, own.0), cos(difference.1, total.1, own.1)),
            sin: (sin(difference.0, total.0), sin(difference.1, total.1)),
        }
    }
}

/// Called with a row, its derivative by ω and the whitened value.
type Visitor<'a> = dyn FnMut(&[f64; N], &[f64; N], f64) + 'a;

/// The weighted least-squares problem.
struct Problem<'a> {
    blocks: &'a [Block],
    w: f64,
    /// The record's centre, in samples.
    centre: f64,
    /// All blocks but the last, and the last.
    geometry: [Geometry; 2],
    last: u64,
}

impl Problem<'_> {
    /// Calls `visit` with (row, d row/dω, whitened value) for the three rows of each block.
    ///
    /// One copy for all who visit: in place it would be four times as much code on a microcontroller.
    #[inline(never)]
    fn rows(&self, omega: f64, visit: &mut Visitor<'_>) {
        let [regular, last] = &self.geometry;
        let responses = [Response::new(regular, self.w, omega), Response::new(last, self.w, omega)];
        for block in self.blocks {
            let (geometry, response) =
                if block.length == self.last { (last, &responses[1]) } else { (regular, &responses[0]) };
            let t = block.centre - self.centre;
            let (s, c) = sin_cos(omega * t);
            let [sum, cos, sin] = geometry.whiten(block);
            // P = p·s + q·c and dP/dω = t·Q; Q = p·c − q·s and dQ/dω = −t·P.
            let p_row = |(k, dk): (f64, f64), offset: f64| {
                ([k * s, k * c, offset], [dk * s + k * t * c, dk * c - k * t * s, 0.0])
            };
            let (row, slope) = p_row(response.sum, response.offset);
            visit(&row, &slope, sum);
            let (row, slope) = p_row(response.cos, 0.0);
            visit(&row, &slope, cos);
            let (k, dk) = response.sin;
            visit(&[k * c, -k * s, 0.0], &[dk * c - k * t * s, -dk * s - k * t * c, 0.0], sin);
        }
    }

    #[inline(never)]
    fn normal(&self, omega: f64) -> Normal<N> {
        let mut normal = Normal::EMPTY;
        self.rows(omega, &mut |row, _, y| normal.add(row, y));
        normal
    }

    fn explained(&self, omega: f64) -> f64 {
        self.normal(omega).solve().map_or(0.0, |(_, _, explained)| explained)
    }

    fn evaluate(&self, omega: f64) -> Option<Point<N>> {
        let mut border = Border::new(&self.normal(omega))?;
        self.rows(omega, &mut |row, slope, y| {
            let along = super::normal::dot(slope, border.theta());
            border.add(row, along, y);
        });
        Some(border.point())
    }

    /// Σ of squares of the model over the blocks' whitened sums: what they can see of it.
    fn seen(&self, omega: f64, theta: &[f64; N]) -> f64 {
        self.normal(omega).square(theta)
    }
}

/// Σ over all samples of the squared model, about the record's centre.
fn model_power([p, q, d]: &[f64; N], omega: f64, samples: f64) -> f64 {
    let (single, _) = dirichlet(omega, samples);
    let (double, _) = dirichlet(2.0 * omega, samples);
    0.5 * (p * p * (samples - double) + q * q * (samples + double)) + d * (d * samples + 2.0 * q * single)
}

/// Solves the blocks of a record; scales them in place.
pub(super) fn fit(record: &Record, blocks: &mut [Block]) -> Result<SineFit, SineError> {
    let samples = record.samples as f64;
    let finite = blocks.iter().all(|b| b.cos.is_finite() && b.sin.is_finite() && b.sum.is_finite());
    if !(finite && record.power.is_finite() && record.reference.is_finite()) {
        return Err(SineError::NotFinite);
    }
    let scale = libm::sqrt(record.power / samples);
    if scale <= 0.0 {
        return Err(SineError::ZeroSignal);
    }
    for block in blocks.iter_mut() {
        block.cos /= scale;
        block.sin /= scale;
        block.sum /= scale;
    }
    let (Some(first), Some(last)) = (blocks.first(), blocks.last()) else {
        return Err(SineError::ZeroSignal);
    };
    let w = record.nco.radians_per_sample();
    let problem = Problem {
        blocks,
        w,
        centre: 0.5 * (samples - 1.0),
        geometry: [Geometry::new(w, first.length), Geometry::new(w, last.length)],
        last: last.length,
    };
    let count = blocks.len() as f64;
    let freedom = (3.0 * count - 4.0).max(1.0);
    let cell = search(&problem, samples, count)?;
    let to_rad_s = |omega: f64| omega / record.sample_period_s;
    let Some((omega, point)) = refine(cell.0, cell.2, cell.1, freedom, |omega| problem.evaluate(omega)) else {
        return Err(SineError::SearchEdge { omega_rad_s: to_rad_s(cell.1) });
    };
    let cycles = omega * samples / TAU;
    // Noise may take one cycle a little below one; the limit itself is generous.
    if cycles < MIN_CYCLES_FREE {
        return Err(SineError::TooFewCycles { cycles, needed: MIN_CYCLES_FREE });
    }
    let whitened: f64 = blocks
        .iter()
        .map(|block| {
            let i = usize::from(block.length == problem.last);
            let [a, b, c] = problem.geometry.get(i).map_or([0.0; 3], |g| g.whiten(block));
            a * a + b * b + c * c
        })
        .sum();
    let hidden_model = model_power(&point.theta, omega, samples) - problem.seen(omega, &point.theta);
    let noise = Noise {
        within: (samples - whitened - hidden_model).max(0.0),
        within_freedom: (samples - 3.0 * count).max(0.0),
        between: point.rss,
        between_freedom: freedom,
        hidden_model: hidden_model.max(0.0),
    };
    if record.doubled && is_alias(&point, noise.within / noise.within_freedom.max(1.0)) {
        return Err(SineError::OutOfReach);
    }
    let error = (omega - w).abs() / w;
    if 8.0 * cycles * error > record.capacity as f64 {
        return Err(SineError::Recentre { omega_rad_s: to_rad_s(omega) });
    }
    SineFit::assemble(
        SineModel::default(),
        omega,
        &point,
        noise.variance() * (samples - 4.0),
        &Scales {
            signal: scale,
            reference: record.reference,
            time_s: record.sample_period_s,
            half: problem.centre,
            samples: usize::try_from(record.samples).unwrap_or(usize::MAX),
            free: true,
        },
    )
}

/// Two independent sources of the noise variance.
struct Noise {
    /// Power that the blocks' sums do not see, less the model's own part of it.
    within: f64,
    within_freedom: f64,
    /// Residual of the blocks' sums.
    between: f64,
    between_freedom: f64,
    /// Power of the model that the blocks' sums do not see.
    hidden_model: f64,
}

impl Noise {
    /// Their mean by inverse variance. The product of noise and hidden model is not known from the sums, so with a
    /// hidden power H the variance of `within` is 2σ⁴n + 4σ²H instead of 2σ⁴n: at 60 dB and ω0 off by 3 % it would be
    /// worth nothing, and the blocks' residual alone is left.
    fn variance(&self) -> f64 {
        let between = self.between / self.between_freedom;
        let n = self.within_freedom;
        if n < 1.0 {
            return between;
        }
        let weight =
            if self.hidden_model <= 0.0 { n } else { n * n * between / (n * between + 2.0 * self.hidden_model) };
        (weight * self.within / n + self.between) / (weight + self.between_freedom)
    }
}

/// Whether the sine found is an alias: a frequency that dephases by more than 3/4 of a cycle per block appears at
/// another one with less than a tenth of its power, and the rest varies within the blocks.
fn is_alias(point: &Point<N>, inside: f64) -> bool {
    let [p, q, _] = point.theta;
    0.5 * (p * p + q * q) < 0.1 * inside
}

/// Grid of 1/(4T) over 0.5..2 times the oscillator's frequency, as far as a block dephases by half a cycle.
fn search(problem: &Problem<'_>, samples: f64, count: f64) -> Result<(f64, f64, f64), SineError> {
    let w = problem.w;
    let reach = 0.5 * count * TAU / samples;
    let shortest = 0.5 * MIN_CYCLES_FREE * TAU / samples;
    let low = (0.5 * w).max(w - reach).max(shortest);
    let high = (2.0 * w).min(w + reach).min(0.95 * PI);
    if high * samples < MIN_CYCLES_FREE * TAU {
        return Err(SineError::TooFewCycles { cycles: high * samples / TAU, needed: MIN_CYCLES_FREE });
    }
    let cells = libm::ceil((high - low) / (0.25 * TAU / samples)).max(2.0);
    let step = (high - low) / cells;
    let mut best = (low, 0.0);
    for k in 0..=cells as u32 {
        let omega = low + step * f64::from(k);
        let explained = problem.explained(omega);
        if explained > best.1 {
            best = (omega, explained);
        }
    }
    let omega = best.0;
    Ok(((omega - step).max(low), omega, (omega + step).min(high)))
}
