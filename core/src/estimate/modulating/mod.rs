//! The recommended streaming estimator of (b, c, f1): modulating functions (docs/theory.md, section 4, item 4).
//!
//! The equation of motion is multiplied by a test function φ that vanishes with its slope at both ends of a window.
//! Integration by parts then leaves no derivative of the position:
//!
//! `b·∫φẍ + c·∫φẋ + f1·∫φ·sgn v + load·∫φ = ∫φu`
//!
//! φ is a Hann window of `L` seconds times `e^(−jω0t)`, ω0 a whole multiple `m` of 2π/L. Windows overlap by half. The
//! real and the imaginary part are one equation each. Nothing needs to be periodic or settled. For m ≥ 2, `∫φ = 0`: a
//! constant position, a constant load and an offset of the drive drop out. The load, where it is asked for, comes
//! from an additional plain Hann window, m = 0.
//!
//! # What sampling costs
//! The test function actually used is the *piecewise linear* interpolant of φ's samples, which is as good a test
//! function as φ itself. These integrals follow.
//! - `∫φẍ = Σ φ_k (x_{k+1} − 2x_k + x_{k−1})/Ts` holds exactly. The second difference of `x` *is* the integral of
//!   `ẍ` over a triangle, also where `ẍ` jumps.
//! - `∫φu` over a zero-order-held drive is exactly the trapezoid `Σ u_k Ts (φ_k + φ_{k+1})/2`.
//! - `∫φ·sgn v` is exact for given sub-sample edges.
//! - `∫φẋ = −Σ (φ_{k+1} − φ_k)/Ts ∫x` needs `∫x` between samples, which the cubic through four samples gives. Its
//!   relative error is of order `(ωTs)⁴/60`; a jump of `ẍ` adds `Ts³/24` times the jump.
//!
//! All position terms are differences, so that an offset costs no precision in f32. The oscillators' rounding changes
//! φ a little, which has no effect, because every term uses the same φ.
//!
//! # Streaming
//! Two half-overlapping Hann windows add up to one. So the sums with weights E = e^(−jω0t) and H·E over each
//! half-window give both windows: rising half ΣHE, falling half of the other Σ(1−H)E. Memory is O(1): a delay line of
//! 2d + 1 samples for the velocity's sign, four sums, and the normal equations. These are kept in f64 or in two f32
//! ([`SolverReal::Sum`]; they are touched twice per window only).

mod block;
mod edges;
mod forms;
mod solve;

pub use block::{Block, COLUMNS};
pub use solve::{BaseEstimate, Parameter, Refusal, estimate, estimate_base};

use crate::estimate::angle::sin_cos_of_turns;
use crate::says::says;
use crate::scalar::{Real, SolverReal};
use edges::{Edge, Interval, interval};

/// What is wrong with the estimator's configuration; names the parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModulatingError {
    /// `ts` is not finite and positive.
    SamplePeriod,
    /// The window has fewer than 16 samples, or more than 2²⁴.
    Window,
    /// `half_width` is below 2, above an eighth of the window, or too long for the delay line.
    HalfWidth,
    /// A multiple is 1 (it would let a constant through) or above an eighth of the window's samples.
    Multiple,
    /// `rest_band` is not finite and non-negative.
    RestBand,
}

says! { ModulatingError:
    Self::SamplePeriod => "the sampling period must be a finite number above 0",
    Self::Window => "the window must have 16 to 2²⁴ samples",
    Self::HalfWidth => "the half-width must be 2 samples or more, and at most an eighth of the window",
    Self::Multiple => "a multiple must be 2 or more, and at most an eighth of the window's samples",
    Self::RestBand => "the rest band must be a finite number, 0 or more",
}

/// Configuration: `F` window frequencies, a delay line of `LINE` samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Modulating<R, const F: usize = 1, const LINE: usize = 64> {
    ts: R,
    window: u32,
    half_width: usize,
    multiples: [u32; F],
    rest_band: R,
    rotation: [(R, R); F],
    hann_rotation: (R, R),
}

/// Oscillators are set from the exact angle this often, so that they cannot drift.
const REBASE: u32 = 128;

/// Sums with the weights [Re E, Im E, Re HE, Im HE].
type Lanes<R> = [R; 4];

#[derive(Clone, Copy, Debug, PartialEq)]
struct Channel<R> {
    oscillator: (R, R),
    weight: Lanes<R>,
    previous: Lanes<R>,
    /// ẍ, ẋ, sgn v, u, and the two edge corrections.
    sums: [Lanes<R>; 6],
    partial: [[R; 2]; 6],
}

/// The estimator's state; see [`Modulating`].
#[allow(clippy::struct_excessive_bools, reason = "independent facts about the running half-window")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModulatingState<R: SolverReal, const F: usize = 1, const LINE: usize = 64> {
    x: [R; LINE],
    u: [R; LINE],
    head: usize,
    filled: usize,
    /// x at k+2 … k−2.
    near: [R; 5],
    difference: R,
    held: R,
    sign: R,
    position: u32,
    started: bool,
    hann: (R, R),
    channels: [Channel<R>; F],
    have_partial: bool,
    still: u32,
    at_rest: bool,
    rested_before: bool,
    blocks: [Block<R>; F],
}

impl<R: SolverReal, const F: usize, const LINE: usize> Modulating<R, F, LINE> {
    /// Checks and prepares a configuration.
    ///
    /// - `ts`: sample period in seconds.
    /// - `window_samples`: window length L/Ts, rounded up to an even number; for a limit cycle 2·T/Ts.
    /// - `half_width`: half-width d of the central difference whose sign is the velocity's, in samples: 0.01·T/Ts
    ///   with little noise, 0.02·T/Ts otherwise. With a smaller d noise softens the sign (f1 too large: 0.7 % at σ =
    ///   1 % of the amplitude with 0.01, 0.2 % with 0.02). A larger one reaches into the drive's switches (b 0.2 %
    ///   with 0.03). The standard errors do not hold these biases.
    /// - `multiples`: the window frequencies ω0·L/2π; 2 for a limit cycle with L = 2T; 0 for the equation that shows the
    ///   constant load.
    /// - `rest_band`: the largest |x_{k+d} − x_{k−d}| that still counts as rest, in position units (about 4σ + one
    ///   encoder step; 0 without noise). Windows with more than an eighth of their length at rest are left out: there
    ///   friction only answers the drive.
    ///
    /// # Errors
    /// [`ModulatingError`] names the parameter.
    pub fn new(
        ts: R,
        window_samples: u32,
        half_width: usize,
        multiples: [u32; F],
        rest_band: R,
    ) -> Result<Self, ModulatingError> {
        if !(ts.is_finite() && ts > R::ZERO) {
            return Err(ModulatingError::SamplePeriod);
        }
        if !(16..=1 << 24).contains(&window_samples) {
            return Err(ModulatingError::Window);
        }
        let window = window_samples + window_samples % 2;
        if half_width < 2 || half_width > (window / 8) as usize || half_width > LINE.saturating_sub(1) / 2 {
            return Err(ModulatingError::HalfWidth);
        }
        if multiples.iter().any(|&m| m == 1 || m > window / 8) || F == 0 {
            return Err(ModulatingError::Multiple);
        }
        if !(rest_band.is_finite() && rest_band >= R::ZERO) {
            return Err(ModulatingError::RestBand);
        }
        Ok(Self {
            ts,
            window,
            half_width,
            multiples,
            rest_band,
            rotation: multiples.map(|m| conjugate(phasor(m, window))),
            hann_rotation: phasor(1, window),
        })
    }

    /// Window length in samples.
    pub const fn window_samples(&self) -> u32 {
        self.window
    }

    /// A state before the first sample.
    pub fn start(&self) -> ModulatingState<R, F, LINE> {
        ModulatingState {
            x: [R::ZERO; LINE],
            u: [R::ZERO; LINE],
            head: 0,
            filled: 0,
            near: [R::ZERO; 5],
            difference: R::ZERO,
            held: R::ZERO,
            sign: R::ZERO,
            position: 0,
            started: false,
            hann: (R::ONE, R::ZERO),
            channels: [Channel::new(); F],
            have_partial: false,
            still: 0,
            at_rest: false,
            rested_before: false,
            blocks: [Block::default(); F],
        }
    }

    /// Takes one sample: the position `x` at this tick, and the drive `u` applied from this tick to the next.
    ///
    /// The drive must be the one that reached the axis (after saturation and delay): logged one sample late it costs
    /// f1 about 4 %.
    #[inline]
    pub fn push(&self, state: &mut ModulatingState<R, F, LINE>, x: R, u: R) {
        state.write(x, u);
        let span = 2 * self.half_width;
        if state.filled <= self.half_width {
            return;
        }
        let two = R::ONE + R::ONE;
        let near = [
            read(&state.x, state.head, self.half_width - 2),
            state.near[0],
            state.near[1],
            state.near[2],
            state.near[3],
        ];
        let difference = x - read(&state.x, state.head, span);
        let held = read(&state.u, state.head, self.half_width);
        if state.started {
            state.near = near;
            self.turn(state);
            let piece = interval(state.difference, difference);
            state.add_interval(piece);
            if state.position == 0 || state.position == self.window / 2 {
                self.close_half(state);
            }
        } else {
            for (age, entry) in state.near.iter_mut().enumerate() {
                *entry = read(&state.x, state.head, self.half_width - 2 + age);
            }
            state.started = true;
            self.rebase(state);
            state.sign = difference.sgn();
        }
        let [far_ahead, ahead, here, behind, far_behind] = state.near;
        let curvature = ahead - two * here + behind;
        let chord = ahead - behind;
        let slope = chord * R::from_f64(0.5) - (far_ahead - far_behind - two * chord) * R::from_f64(1.0 / 24.0);
        for channel in &mut state.channels {
            let weight = channel.weight;
            add(&mut channel.sums[0], weight, curvature);
            add(&mut channel.sums[1], weight, slope);
        }
        state.difference = difference;
        state.held = held;
        // A NaN is not rest: its window is counted as not finite.
        if difference.abs() <= self.rest_band {
            state.still = state.still.saturating_add(1);
            state.at_rest |= state.still > self.window / 8;
        } else {
            state.still = 0;
        }
    }

    fn turn(&self, state: &mut ModulatingState<R, F, LINE>) {
        for channel in &mut state.channels {
            channel.previous = channel.weight;
        }
        state.position += 1;
        if state.position == self.window {
            state.position = 0;
        }
        if state.position.is_multiple_of(REBASE) || state.position == self.window / 2 {
            self.rebase(state);
            return;
        }
        state.hann = rotate(state.hann, self.hann_rotation);
        let hann = (R::ONE - state.hann.0) * R::from_f64(0.5);
        for (channel, &rotation) in state.channels.iter_mut().zip(&self.rotation) {
            channel.oscillator = rotate(channel.oscillator, rotation);
            channel.set_weight(hann);
        }
    }

    fn rebase(&self, state: &mut ModulatingState<R, F, LINE>) {
        state.hann = phasor(state.position, self.window);
        let hann = (R::ONE - state.hann.0) * R::from_f64(0.5);
        for (channel, &multiple) in state.channels.iter_mut().zip(&self.multiples) {
            let turns = u64::from(multiple) * u64::from(state.position) % u64::from(self.window);
            channel.oscillator = conjugate(phasor(turns as u32, self.window));
            channel.set_weight(hann);
        }
    }

    fn close_half(&self, state: &mut ModulatingState<R, F, LINE>) {
        let falling = state.position == 0;
        let ts = self.ts;
        let tau = ts * R::from_i64(self.half_width as i64);
        let length = ts * R::from_i64(i64::from(self.window));
        let keep = state.have_partial && !state.at_rest && !state.rested_before;
        for ((channel, block), &multiple) in state.channels.iter_mut().zip(&mut state.blocks).zip(&self.multiples) {
            let mut total = [[R::ZERO; 2]; 6];
            for ((sum, partial), total) in channel.sums.iter_mut().zip(&mut channel.partial).zip(&mut total) {
                let rising = [sum[2], sum[3]];
                let rest = [sum[0] - sum[2], sum[1] - sum[3]];
                let (closing, opening) = if falling { (rising, rest) } else { (rest, rising) };
                for ((total, &partial), &closing) in total.iter_mut().zip(partial.iter()).zip(&closing) {
                    *total = partial + closing;
                }
                *partial = opening;
                *sum = [R::ZERO; 4];
            }
            if !state.have_partial {
                continue;
            }
            if !keep {
                block.skip();
                continue;
            }
            let load = if multiple == 0 { length.scale(0.5) } else { R::ZERO };
            let row = |part: usize| {
                let [curvature, slope, sign, drive, first, third] = total.map(|value| value[part]);
                let load = if part == 0 { load } else { R::ZERO };
                [curvature / ts, slope, sign * ts, load, first * tau, third * tau, drive * ts]
            };
            block.add(&[row(0), row(1)], multiple == 0, length);
        }
        state.have_partial = true;
        state.rested_before = state.at_rest;
        state.at_rest = state.still > self.window / 8;
    }
}

impl<R: SolverReal, const F: usize, const LINE: usize> ModulatingState<R, F, LINE> {
    /// The normal equations so far, one block per window frequency; hand those of all experiments to [`estimate`].
    pub const fn blocks(&self) -> &[Block<R>; F] {
        &self.blocks
    }

    #[inline]
    fn write(&mut self, x: R, u: R) {
        // Before the record the axis is taken to rest at its first position. The sign's difference is one-sided for
        // the first d samples, where the window is nearly 0, and no sample is lost.
        if self.filled == 0 {
            self.x = [x; LINE];
        }
        self.head += 1;
        if self.head >= LINE {
            self.head = 0;
        }
        if let (Some(here), Some(drive)) = (self.x.get_mut(self.head), self.u.get_mut(self.head)) {
            *here = x;
            *drive = u;
        }
        if self.filled <= LINE {
            self.filled += 1;
        }
    }

    #[inline]
    fn add_interval(&mut self, piece: Interval<R>) {
        let half = R::from_f64(0.5);
        let held = self.held * half;
        for channel in &mut self.channels {
            let (before, after) = (channel.previous, channel.weight);
            for (sum, (before, after)) in channel.sums[2].iter_mut().zip(before.into_iter().zip(after)) {
                *sum += before * piece.weight_before + after * piece.weight_after;
            }
            for (sum, (before, after)) in channel.sums[3].iter_mut().zip(before.into_iter().zip(after)) {
                *sum += (before + after) * held;
            }
        }
        if piece.first != self.sign {
            self.add_edge(piece.first - self.sign, R::ZERO);
        }
        if let Some(Edge { at, jump }) = piece.edge {
            self.add_edge(jump, at);
        }
        self.sign = piece.last;
    }

    /// Correction of an edge for the acceleration's jump at a reversal. The central difference of half-width τ sees
    /// it late by δ = τ(r−1)/(r+1), r = √((h+f1)/(h−f1)) (docs/theory.md, section 4), which is τ·tan(½·asin(f1/h)) =
    /// τ(f1/2h + f1³/8h³ + …). f1 is not known yet, so the two powers are columns of their own.
    #[cold]
    fn add_edge(&mut self, jump: R, at: R) {
        // Only where the drive reverses the motion; elsewhere (noise at rest) nothing is known about the accelerations.
        if self.held * jump <= R::ZERO {
            return;
        }
        let inverse = R::ONE / self.held.abs();
        let first = jump * inverse * R::from_f64(0.5);
        let third = first * inverse * inverse * R::from_f64(0.25);
        for channel in &mut self.channels {
            let (before, after) = (channel.previous, channel.weight);
            for (amount, sum) in [first, third].into_iter().zip(channel.sums.iter_mut().skip(4)) {
                add(sum, before, amount * (R::ONE - at));
                add(sum, after, amount * at);
            }
        }
    }
}

impl<R: Real> Channel<R> {
    const fn new() -> Self {
        Self {
            oscillator: (R::ONE, R::ZERO),
            weight: [R::ZERO; 4],
            previous: [R::ZERO; 4],
            sums: [[R::ZERO; 4]; 6],
            partial: [[R::ZERO; 2]; 6],
        }
    }

    #[inline]
    fn set_weight(&mut self, hann: R) {
        let (re, im) = self.oscillator;
        self.weight = [re, im, hann * re, hann * im];
    }
}

#[inline]
fn add<R: Real>(sum: &mut Lanes<R>, weight: Lanes<R>, value: R) {
    for (sum, weight) in sum.iter_mut().zip(weight) {
        *sum += weight * value;
    }
}

#[inline]
fn read<R: Real, const LINE: usize>(line: &[R; LINE], head: usize, age: usize) -> R {
    let index = if head >= age { head - age } else { head + LINE - age };
    line.get(index).copied().unwrap_or(R::ZERO)
}

#[inline]
fn rotate<R: Real>(a: (R, R), b: (R, R)) -> (R, R) {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

/// e^(j2π·turns/of), `turns` ≤ `of`.
fn phasor<R: SolverReal>(turns: u32, of: u32) -> (R, R) {
    // To 2⁻³⁹ turn: a window has at most 2²⁴ samples.
    let step = u64::MAX / u64::from(of.max(1));
    let (sin, cos) = sin_cos_of_turns(step.wrapping_mul(u64::from(turns)));
    (cos, sin)
}

fn conjugate<R: Real>((re, im): (R, R)) -> (R, R) {
    (re, -im)
}
