//! Margins of the sampled loop: exact discretisation of the plant, the PID as it is coded with its observer and filter, the delay.

use core::f64::consts::{PI, TAU};

use super::tuning::Gains;

/// How far the loop is from instability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margins {
    /// Factor by which the loop gain may rise.
    pub gain: f64,
    /// Factor by which the loop gain may fall, ≤ 1; 0 if it may vanish. A double integrator with integral action
    /// oscillates if the gain is too low.
    pub gain_reduction: f64,
    /// Phase margin at the highest crossover, degrees.
    pub phase_deg: f64,
    /// Additional delay that the loop survives, s.
    pub delay_s: f64,
    /// The highest crossover, rad/s.
    pub crossover_rad_s: f64,
}

#[derive(Clone, Copy)]
struct Complex {
    re: f64,
    im: f64,
}

impl Complex {
    const fn new(re: f64, im: f64) -> Self {
        Self { re, im }
    }
    fn unit(angle: f64) -> Self {
        Self::new(libm::cos(angle), libm::sin(angle))
    }
    fn plus(self, other: Self) -> Self {
        Self::new(self.re + other.re, self.im + other.im)
    }
    fn times(self, other: Self) -> Self {
        Self::new(self.re * other.re - self.im * other.im, self.re * other.im + self.im * other.re)
    }
    fn over(self, other: Self) -> Self {
        let square = other.re * other.re + other.im * other.im;
        let product = self.times(Self::new(other.re, -other.im));
        Self::new(product.re / square, product.im / square)
    }
    fn scaled(self, factor: f64) -> Self {
        Self::new(self.re * factor, self.im * factor)
    }
    fn magnitude(self) -> f64 {
        libm::hypot(self.re, self.im)
    }
}

/// The loop as a function of the angle ω·Ts.
struct Loop {
    /// e^(−c·Ts/b), ∫ of it over the tick, and the responses of velocity and position to a held unit drive.
    decay: f64,
    travel: f64,
    to_v: f64,
    to_x: f64,
    kp: f64,
    ki: f64,
    kd: f64,
    /// The observer's pole.
    pole: f64,
    /// Share of the new rate in the filtered one.
    alpha: f64,
    delay: f64,
}

/// (1 − e^(−z))/z and (1 − that)/z.
fn phi(z: f64) -> (f64, f64) {
    if z < 1e-3 {
        (1.0 - z * (0.5 - z / 6.0), 0.5 - z * (1.0 / 6.0 - z / 24.0))
    } else {
        let first = -libm::expm1(-z) / z;
        (first, (1.0 - first) / z)
    }
}

impl Loop {
    fn new(gains: &Gains, b: f64, c: f64, tick_s: f64, delay_ticks: u32) -> Self {
        let z = c / b * tick_s;
        let (phi1, phi2) = phi(z);
        let k = gains.b * gains.kv;
        let (pole, alpha) = gains.poles(tick_s);
        Self {
            decay: libm::exp(-z),
            travel: tick_s * phi1,
            to_v: tick_s * phi1 / b,
            to_x: tick_s * tick_s * phi2 / b,
            kp: k * gains.lambda2,
            ki: k * gains.lambda1 * tick_s,
            kd: k / tick_s,
            pole,
            alpha,
            delay: f64::from(delay_ticks),
        }
    }

    fn at(&self, angle: f64) -> Complex {
        let one = Complex::new(1.0, 0.0);
        let z = Complex::unit(angle);
        let back = Complex::unit(-angle);
        let minus = |value: Complex, number: f64| value.plus(Complex::new(-number, 0.0));
        // Plant: x = (to_x·(z − decay) + travel·to_v)/((z − 1)·(z − decay)).
        let slow = minus(z, self.decay);
        let numerator = slow.scaled(self.to_x).plus(Complex::new(self.travel * self.to_v, 0.0));
        let plant = numerator.over(minus(z, 1.0).times(slow));
        let integral = one.over(one.plus(back.scaled(-1.0))).scaled(self.ki);
        // One of the observer's two poles, as a filter.
        let pole = one.scaled(1.0 - self.pole).over(one.plus(back.scaled(-self.pole)));
        let observed = one.plus(back.scaled(-1.0)).times(pole).times(pole);
        let filtered = observed.scaled(self.alpha).over(one.plus(back.scaled(self.alpha - 1.0)));
        let rate = filtered.scaled(self.kd);
        let controller = Complex::new(self.kp, 0.0).plus(integral).plus(rate);
        plant.times(controller).times(Complex::unit(-angle * self.delay))
    }
}

/// Margins of `gains` on the plant (b, c); `None` if the loop never crosses unit gain below half the tick rate.
///
/// `b` may differ from the gains' own: then the margins are those of the gains on another plant.
pub fn margins(gains: &Gains, b: f64, c: f64, tick_s: f64, delay_ticks: u32) -> Option<Margins> {
    const POINTS: usize = 600;
    let sampled = Loop::new(gains, b, c, tick_s, delay_ticks);
    let lowest = 1e-3 * (gains.lambda2.min(gains.kv) * tick_s).clamp(1e-9, 1.0);
    let ratio = libm::pow(PI * 0.999_999 / lowest, 1.0 / POINTS as f64);
    let mut angle = lowest;
    let mut last = sampled.at(angle);
    // The phase, unwrapped from below: three integrations begin at −270°, or two at −180°.
    let mut phase = libm::atan2(last.im, last.re);
    if phase > 0.0 {
        phase -= TAU;
    }
    let (mut gain, mut reduction) = (f64::INFINITY, 0.0_f64);
    let mut crossing = None;
    for _ in 0..POINTS {
        let next_angle = angle * ratio;
        let next = sampled.at(next_angle);
        let mut step = libm::atan2(next.im, next.re) - libm::atan2(last.im, last.re);
        step -= TAU * libm::round(step / TAU);
        let (from, to) = (last.magnitude(), next.magnitude());
        let next_phase = phase + step;
        // Real and negative: where the phase passes an odd multiple of −180°.
        for turn in [-1.0, -3.0, -5.0] {
            let line = turn * PI;
            if (phase - line) * (next_phase - line) < 0.0 {
                let share = (line - phase) / step;
                let size = from * libm::pow(to / from, share);
                if size < 1.0 {
                    gain = gain.min(1.0 / size);
                } else {
                    reduction = reduction.max(1.0 / size);
                }
            }
        }
        if from >= 1.0 && to < 1.0 {
            let share = libm::log(from) / libm::log(from / to);
            crossing = Some((angle * libm::pow(ratio, share), phase + share * step));
        }
        (angle, last, phase) = (next_angle, next, next_phase);
    }
    let (angle, phase) = crossing?;
    let margin = phase + PI;
    Some(Margins {
        gain,
        gain_reduction: reduction,
        phase_deg: margin.to_degrees(),
        delay_s: margin / angle * tick_s,
        crossover_rad_s: angle / tick_s,
    })
}
