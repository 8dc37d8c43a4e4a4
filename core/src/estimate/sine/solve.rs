//! From block phasors to the sine: weighted least squares with closed-form sums.
//!
//! About its own centre, a block of L samples sees `y = P·cos ωm + Q·sin ωm + d`. Its sums are `C = Σy·cos wm`,
//! `S = Σy·sin wm` and `Y = Σy`, with w the oscillator's frequency. Their noise has the covariance σ²G, with
//! `G = [[C2, 0, D(w)], [0, S2, 0], [D(w), 0, L]]` and `C2, S2 = (L ± D(2w))/2`. D(α) is the Dirichlet sum Σcos αm.
//! The Cholesky factor of G whitens them into three rows of unit noise for each block:
//!
//! - `Y/√L               = (D(ω)·P + L·d)/√L`
//! - `(C − Y·D(w)/L)/√V  = (Kc − D(w)D(ω)/L)·P/√V`,  V = C2 − D(w)²/L; the offset has dropped out
//! - `S/√S2              = Ks·Q/√S2`,  with `Kc, Ks = (D(ω−w) ± D(ω+w))/2`
//!
//! They are linear in (p, q, d) by `P = q·cos ωtc + p·sin ωtc` and `Q = p·cos ωtc − q·sin ωtc`, with tc the block's
//! centre.
//!
//! Angles are integers in fractions of a turn, and the frequency is the oscillator's plus a difference. So f32 loses
//! nothing over a long record, whose angles it could not hold. Frequencies are given as half the angle per sample, in
//! units of 2⁻⁶⁴ turn, because a block's centre may lie between two samples.

use super::columns::SineModel;
use super::normal::{Normal, dot};
use super::refine::{Border, Point, Resolution, refine};
use super::result::{Scales, SineFit};
use super::{MIN_CYCLES_FREE, SineError};
use crate::estimate::angle::{RADIANS, sin_cos_of_turns};
use crate::scalar::nco::Nco;
use crate::scalar::{ExactSum, SolverReal};
use core::f64::consts::{PI, TAU};

/// Linear parameters: p, q, d.
const N: usize = 3;

/// What the solution needs to know beside the blocks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Record<R> {
    pub nco: Nco,
    pub sample_period_s: R,
    pub samples: u64,
    /// Σ (y − reference)².
    pub power: R,
    pub reference: R,
    /// B.
    pub capacity: usize,
    /// Whether neighbours have been paired: blocks may be longer than a quarter period.
    pub doubled: bool,
}

/// One block, its phasor turned to its own centre.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Block<R> {
    /// Twice the centre, in samples from the record's first.
    twice_centre: u64,
    length: u64,
    cos: R,
    sin: R,
    sum: R,
}

impl<R: SolverReal> Block<R> {
    /// A block of `length` samples from sample `start` on, with its sums Σy·cos φ, Σy·sin φ, Σy.
    pub(super) fn new(nco: Nco, start: u64, length: u64, [cos, sin, sum]: [R; 3]) -> Self {
        let twice_centre = 2_u64.wrapping_mul(start).wrapping_add(length).wrapping_sub(1);
        let (s, c) = sin_cos_of_turns::<R>(half_angle(nco).wrapping_mul(twice_centre));
        Self { twice_centre, length, cos: cos * c + sin * s, sin: sin * c - cos * s, sum }
    }
}

/// Half the oscillator's angle per sample, in units of 2⁻⁶⁴ turn.
fn half_angle(nco: Nco) -> u64 {
    u64::from(nco.word()) << 31
}

/// An integer number of samples.
fn count<R: SolverReal>(samples: u64) -> R {
    R::from_i64(samples as i64)
}

/// `D(α) = Σ cos αm = sin(αL/2)/sin(α/2)` over L samples centred on 0, and dD/dα; |α| < 2π. `half` is α/2 in units of
/// 2⁻⁶⁴ turn.
fn dirichlet<R: SolverReal>(half: u64, samples: u64) -> (R, R) {
    let (alpha, length) = (R::from_i64(half as i64).scale(2.0 * RADIANS), count::<R>(samples));
    let x = alpha * length;
    if x.abs() < R::SMALL_ANGLE {
        // Power series in α; the next terms are 2e-15 of D, and 2e-10 of a slope that is itself next to 0 (f32: 1e-7 and
        // 2e-5).
        let m2 = length * (length * length - R::ONE).scale(1.0 / 12.0);
        let m4 = m2 * ((length * length).scale(3.0) - R::from_f64(7.0)).scale(1.0 / 20.0);
        let a2 = alpha * alpha;
        return (length - a2 * (m2.scale(0.5) - a2 * m4.scale(1.0 / 24.0)), -alpha * (m2 - a2 * m4.scale(1.0 / 6.0)));
    }
    let (sin_l, cos_l) = sin_cos_of_turns::<R>(half.wrapping_mul(samples));
    let (sin, cos) = sin_cos_of_turns::<R>(half);
    let sum = sin_l / sin;
    (sum, (length * cos_l - sum * cos).scale(0.5) / sin)
}

/// What depends on a block's length alone.
#[derive(Clone, Copy, Debug)]
struct Geometry<R> {
    samples: u64,
    /// D(w)/L.
    mean_cos: R,
    /// 1/√L, 1/√V, 1/√S2.
    weight_sum: R,
    weight_cos: R,
    weight_sin: R,
    /// L/√L.
    offset: R,
}

impl<R: SolverReal> Geometry<R> {
    fn new(w: u64, samples: u64) -> Self {
        let length = count::<R>(samples);
        let (single, _) = dirichlet::<R>(w, samples);
        let (double, _) = dirichlet::<R>(2 * w, samples);
        let mean_cos = single / length;
        let v = (length + double).scale(0.5) - single * mean_cos;
        let s2 = (length - double).scale(0.5);
        let [weight_sum, weight_cos, weight_sin] = [length, v, s2].map(|power| R::ONE / power.sqrt());
        Self { samples, mean_cos, weight_sum, weight_cos, weight_sin, offset: length * weight_sum }
    }
    /// The whitened sums of a block.
    fn whiten(&self, block: &Block<R>) -> [R; 3] {
        [
            block.sum * self.weight_sum,
            (block.cos - block.sum * self.mean_cos) * self.weight_cos,
            block.sin * self.weight_sin,
        ]
    }
}

/// Response of the whitened sums of blocks of one length to a sine at ω, with the derivative by ω.
#[derive(Clone, Copy, Debug)]
struct Response<R> {
    sum: (R, R),
    cos: (R, R),
    sin: (R, R),
}

impl<R: SolverReal> Response<R> {
    fn new(geometry: &Geometry<R>, w: u64, omega: u64) -> Self {
        let [difference, total, own] =
            [omega.wrapping_sub(w), omega + w, omega].map(|half| dirichlet::<R>(half, geometry.samples));
        let mean = geometry.mean_cos;
        let cos = |d: R, t: R, o: R| ((d + t).scale(0.5) - mean * o) * geometry.weight_cos;
        let sin = |d: R, t: R| (d - t).scale(0.5) * geometry.weight_sin;
        Self {
            sum: (own.0 * geometry.weight_sum, own.1 * geometry.weight_sum),
            cos: (cos(difference.0, total.0, own.0), cos(difference.1, total.1, own.1)),
            sin: (sin(difference.0, total.0), sin(difference.1, total.1)),
        }
    }
}

/// Called with a row, its derivative by ω and the whitened value.
type Visitor<'a, R> = dyn FnMut(&[R; N], &[R; N], R) + 'a;

/// The weighted least-squares problem.
struct Problem<'a, R> {
    blocks: &'a [Block<R>],
    w: u64,
    /// Twice the record's centre, in samples.
    twice_centre: u64,
    /// All blocks but the last, and the last.
    geometry: [Geometry<R>; 2],
    last: u64,
}

impl<R: SolverReal> Problem<'_, R> {
    /// The frequency that differs from the oscillator's by `delta` rad/sample.
    fn omega(&self, delta: R) -> u64 {
        self.w.wrapping_add_signed(R::turns(delta.scale(0.5)))
    }

    /// The geometry of a block, and which of the two it is.
    fn geometry(&self, block: &Block<R>) -> (&Geometry<R>, bool) {
        let [regular, last] = &self.geometry;
        if block.length == self.last { (last, true) } else { (regular, false) }
    }

    /// Calls `visit` with (row, d row/dω, whitened value) for the three rows of each block.
    ///
    /// One copy for all who visit: in place it would be four times as much code on a microcontroller.
    #[inline(never)]
    fn rows(&self, delta: R, visit: &mut Visitor<'_, R>) {
        let omega = self.omega(delta);
        let [regular, shorter] = self.geometry.each_ref().map(|geometry| Response::new(geometry, self.w, omega));
        for block in self.blocks {
            let (geometry, last) = self.geometry(block);
            let response = if last { &shorter } else { &regular };
            let twice = block.twice_centre.wrapping_sub(self.twice_centre);
            let t = R::from_i64(twice as i64).scale(0.5);
            let (s, c) = sin_cos_of_turns::<R>(omega.wrapping_mul(twice));
            let [sum, cos, sin] = geometry.whiten(block);
            // P = p·s + q·c and dP/dω = t·Q; Q = p·c − q·s and dQ/dω = −t·P.
            let p_row = |(k, dk): (R, R), offset: R| {
                ([k * s, k * c, offset], [dk * s + k * t * c, dk * c - k * t * s, R::ZERO])
            };
            let (row, slope) = p_row(response.sum, geometry.offset);
            visit(&row, &slope, sum);
            let (row, slope) = p_row(response.cos, R::ZERO);
            visit(&row, &slope, cos);
            let (k, dk) = response.sin;
            visit(&[k * c, -k * s, R::ZERO], &[dk * c - k * t * s, -dk * s - k * t * c, R::ZERO], sin);
        }
    }

    #[inline(never)]
    fn normal(&self, delta: R) -> Normal<R, N> {
        let mut normal = Normal::EMPTY;
        self.rows(delta, &mut |row, _, y| normal.add(row, y));
        normal
    }

    fn explained(&self, delta: R) -> R {
        self.normal(delta).solve().map_or(R::ZERO, |(_, _, explained)| explained)
    }

    fn evaluate(&self, delta: R) -> Option<Point<R, N>> {
        let mut border = Border::new(&self.normal(delta))?;
        self.rows(delta, &mut |row, slope, y| {
            let along = dot(slope, border.theta());
            border.add(row, along, y);
        });
        Some(border.point())
    }

    /// Σ of squares of the blocks' whitened sums, and of the model over them: what they can see of it.
    fn seen(&self, delta: R, theta: &[R; N]) -> (R::Sum, R::Sum) {
        let mut sums = (R::Sum::default(), R::Sum::default());
        self.rows(delta, &mut |row, _, y| {
            let model = dot(row, theta);
            sums = (sums.0.plus(R::Sum::product(y, y)), sums.1.plus(R::Sum::product(model, model)));
        });
        sums
    }
}

/// Σ over all samples of the squared model, about the record's centre, at half the angle per sample `half`.
fn model_power<R: SolverReal>(&[p, q, d]: &[R; N], half: u64, samples: u64) -> R {
    let length = count::<R>(samples);
    let (single, _) = dirichlet::<R>(half, samples);
    let (double, _) = dirichlet::<R>(half.wrapping_mul(2), samples);
    (p * p * (length - double) + q * q * (length + double)).scale(0.5) + d * (d * length + q.scale(2.0) * single)
}

/// Solves the blocks of a record; scales them in place.
pub(super) fn fit<R: SolverReal>(record: &Record<R>, blocks: &mut [Block<R>]) -> Result<SineFit<R>, SineError> {
    let samples = count::<R>(record.samples);
    let finite = blocks.iter().all(|b| b.cos.is_finite() && b.sin.is_finite() && b.sum.is_finite());
    if !(finite && record.power.is_finite() && record.reference.is_finite()) {
        return Err(SineError::NotFinite);
    }
    let scale = (record.power / samples).sqrt();
    if scale <= R::ZERO {
        return Err(SineError::ZeroSignal);
    }
    for block in blocks.iter_mut() {
        block.cos = block.cos / scale;
        block.sin = block.sin / scale;
        block.sum = block.sum / scale;
    }
    let (Some(first), Some(last)) = (blocks.first(), blocks.last()) else {
        return Err(SineError::ZeroSignal);
    };
    let w = half_angle(record.nco);
    let problem = Problem {
        blocks,
        w,
        twice_centre: record.samples.wrapping_sub(1),
        geometry: [Geometry::new(w, first.length), Geometry::new(w, last.length)],
        last: last.length,
    };
    let w_rad = R::from_i64(w as i64).scale(2.0 * RADIANS);
    let blocks = count::<R>(blocks.len() as u64);
    let freedom = (blocks.scale(3.0) - R::from_f64(4.0)).max(R::ONE);
    let cell = search(&problem, w_rad, samples, blocks)?;
    let to_rad_s = |delta: R| ((w_rad + delta) / record.sample_period_s).to_f64();
    let resolution = Resolution::of(w_rad);
    let found = refine(cell.0, cell.2, cell.1, resolution, freedom, |delta| problem.evaluate(delta));
    let Some((delta, point)) = found else {
        return Err(SineError::SearchEdge { omega_rad_s: to_rad_s(cell.1) });
    };
    let omega = w_rad + delta;
    let cycles = (omega * samples).scale(1.0 / TAU);
    // Noise may take one cycle a little below one; the limit itself is generous.
    if cycles < R::from_f64(MIN_CYCLES_FREE) {
        return Err(SineError::TooFewCycles { cycles: cycles.to_f64(), needed: MIN_CYCLES_FREE });
    }
    let (whitened, seen) = problem.seen(delta, &point.theta);
    let model = model_power(&point.theta, problem.omega(delta), record.samples);
    // Differences of nearly equal powers.
    let less = |power: R, sum: R::Sum| R::Sum::product(power, R::ONE).plus(sum.times(-R::ONE));
    let hidden_model = less(model, seen).rounded();
    let within = R::Sum::product(record.power / (scale * scale), R::ONE);
    let within = within.plus(whitened.times(-R::ONE)).plus(R::Sum::product(hidden_model, -R::ONE));
    let noise = Noise {
        within: within.rounded().max(R::ZERO),
        within_freedom: (samples - blocks.scale(3.0)).max(R::ZERO),
        between: point.rss,
        between_freedom: freedom,
        hidden_model: hidden_model.max(R::ZERO),
    };
    if record.doubled && is_alias(&point, noise.within / noise.within_freedom.max(R::ONE)) {
        return Err(SineError::OutOfReach);
    }
    if cycles.scale(8.0) * delta.abs() > R::from_i64(record.capacity as i64) * w_rad {
        return Err(SineError::Recentre { omega_rad_s: to_rad_s(delta) });
    }
    SineFit::assemble(
        SineModel::default(),
        omega,
        &point,
        noise.variance() * (samples - R::from_f64(4.0)),
        &Scales {
            signal: scale,
            reference: record.reference,
            time_s: record.sample_period_s,
            half: (samples - R::ONE).scale(0.5),
            samples: usize::try_from(record.samples).unwrap_or(usize::MAX),
            free: true,
        },
    )
}

/// Two independent sources of the noise variance.
struct Noise<R> {
    /// Power that the blocks' sums do not see, less the model's own part of it.
    within: R,
    within_freedom: R,
    /// Residual of the blocks' sums.
    between: R,
    between_freedom: R,
    /// Power of the model that the blocks' sums do not see.
    hidden_model: R,
}

impl<R: SolverReal> Noise<R> {
    /// Their mean by inverse variance. The sums do not give the product of noise and hidden model. So with a hidden
    /// power H the variance of `within` is 2σ⁴n + 4σ²H instead of 2σ⁴n. At 60 dB and ω0 off by 3 % it would be worth
    /// nothing, and the blocks' residual alone is left.
    ///
    /// Harmonics may make `within` thousands of times `between`. The result then depends on the weight, `between`/H. In
    /// f32, H errs by 1e-7 of the record's power. A measured case has 4.75e-3 for 4.51e-3 of 2918, with standard errors
    /// 0.8 % off. The rows of `between` are differences, too. It errs by 0.7 % where the residual is 3e-5 of the signal
    /// (5.03e-6 for 4.99e-6 of 5617).
    fn variance(&self) -> R {
        let between = self.between / self.between_freedom;
        let n = self.within_freedom;
        if n < R::ONE {
            return between;
        }
        let hidden = self.hidden_model.scale(2.0);
        let weight = if hidden <= R::ZERO { n } else { n * (n * between / (n * between + hidden)) };
        (weight * self.within / n + self.between) / (weight + self.between_freedom)
    }
}

/// Whether the found sine is an alias. A sine that dephases by more than 3/4 of a cycle per block appears at another
/// frequency, with less than a tenth of its power. The rest varies within the blocks.
fn is_alias<R: SolverReal>(point: &Point<R, N>, inside: R) -> bool {
    let [p, q, _] = point.theta;
    (p * p + q * q).scale(5.0) < inside
}

/// Grid of 1/(4T) over 0.5..2 times the oscillator's frequency, as far as a block dephases by half a cycle; differences
/// from the oscillator's frequency.
fn search<R: SolverReal>(problem: &Problem<'_, R>, w: R, samples: R, blocks: R) -> Result<(R, R, R), SineError> {
    let turn = R::from_f64(TAU) / samples;
    let reach = (blocks * turn).scale(0.5);
    let shortest = turn.scale(0.5 * MIN_CYCLES_FREE) - w;
    let low = w.scale(-0.5).max(-reach).max(shortest);
    let high = w.min(reach).min(R::from_f64(0.95 * PI) - w);
    if (w + high) * samples < R::from_f64(MIN_CYCLES_FREE * TAU) {
        let cycles = ((w + high) * samples).scale(1.0 / TAU).to_f64();
        return Err(SineError::TooFewCycles { cycles, needed: MIN_CYCLES_FREE });
    }
    let cells = ((high - low) / turn.scale(0.25) + R::from_f64(0.5)).nearest().max(2);
    let step = (high - low) / R::from_i64(cells);
    let mut best = (low, R::ZERO);
    for k in 0..=cells {
        let delta = low + step * R::from_i64(k);
        let explained = problem.explained(delta);
        if explained > best.1 {
            best = (delta, explained);
        }
    }
    let delta = best.0;
    Ok(((delta - step).max(low), delta, (delta + step).min(high)))
}

#[cfg(test)]
mod tests;
