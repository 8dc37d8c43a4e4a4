//! The exact limit cycle of the base plant under the continuous dual relay (docs/theory.md, section 2).

use breakaway_core::plant::Base;

use super::exact::{Arc, Exact};

/// A periodic motion, exact up to rounding.
#[derive(Clone, Copy, Debug)]
pub struct ExactCycle {
    /// Period, s.
    pub period_s: f64,
    /// Angular frequency, rad/s.
    pub omega_rad_s: f64,
    /// Amplitude of the fundamental of the position.
    pub fundamental: f64,
    /// Largest deviation from the mean of the extremes.
    pub peak: f64,
    /// Third harmonic over the fundamental.
    pub third: f64,
    /// Cycles simulated until two successive ones agreed.
    pub cycles: usize,
}

/// Why there is no cycle to report.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoCycle {
    /// The existence condition of section 2 fails.
    #[error("no limit cycle: h2 = {h2} does not exceed the Coulomb friction f1 = {f1} (plus |load| = {load})")]
    BelowFriction {
        /// Integral relay amplitude.
        h2: f64,
        /// Coulomb level.
        f1: f64,
        /// |f0|.
        load: f64,
    },
    /// h1 must be positive.
    #[error("no limit cycle: h1 = {0} is not positive")]
    H1(f64),
    /// The motion did not become periodic.
    #[error("no limit cycle: the motion is not periodic after {0} cycles")]
    NotPeriodic(usize),
}

/// Relay states and ∫e; e = −x.
struct Relayed {
    plant: Exact,
    h1: f64,
    h2: f64,
    integral: f64,
    signs: (f64, f64),
    t: f64,
    pieces: Vec<(f64, Arc, f64)>,
    extremes: Vec<f64>,
}

/// Bisection for a monotone f on 0..hi with f(0), f(hi) of opposite signs, to the last bit.
fn root(hi: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (mut lo, mut hi) = (0.0, hi);
    let rising = f(hi) > 0.0;
    for _ in 0..200 {
        let mid = 0.5 * (lo + hi);
        if mid <= lo || mid >= hi {
            break;
        }
        if (f(mid) > 0.0) == rising { hi = mid } else { lo = mid }
    }
    hi
}

impl Relayed {
    /// To the next event; true when the integral relay switches to +1.
    fn step(&mut self) -> bool {
        let u = self.h1 * self.signs.0 + self.h2 * self.signs.1;
        let arc = self.plant.arc(u);
        let (x0, _, _) = arc.at(0.0);
        // e = −x, so the proportional relay switches where x leaves the side it is on; x is monotone on the arc.
        let horizon = if arc.reversal_s.is_finite() { arc.reversal_s } else { 1e3 };
        let crosses = |t: f64| -arc.at(t).0 * self.signs.0;
        let mut t = horizon;
        let mut event = 0;
        if crosses(horizon) < 0.0 && (x0 != 0.0 || crosses(horizon * 1e-3) < 0.0) {
            t = root(horizon, |t| -crosses(t));
            event = 1;
        }
        // While x keeps its sign ∫e is monotone.
        let integral = |t: f64| (self.integral - arc.at(t).2) * self.signs.1;
        if integral(t) < 0.0 {
            t = root(t, |t| -integral(t));
            event = 2;
        }
        self.pieces.push((self.t, arc, t));
        self.integral -= arc.at(t).2;
        self.plant.follow(&arc, t);
        self.t += t;
        match event {
            1 => {
                self.signs.0 = -self.signs.0;
                self.plant.x = 0.0;
                false
            }
            2 => {
                self.signs.1 = -self.signs.1;
                self.integral = 0.0;
                self.signs.1 > 0.0
            }
            _ => {
                self.extremes.push(self.plant.x);
                false
            }
        }
    }
}

/// The limit cycle of `base` under relays h1 and h2 with a constant load f0.
///
/// # Errors
/// [`NoCycle`] says which condition fails; the start-up transient is simulated, never assumed.
pub fn exact_cycle(base: Base<f64>, load: f64, h1: f64, h2: f64) -> Result<ExactCycle, NoCycle> {
    if h1 <= 0.0 {
        return Err(NoCycle::H1(h1));
    }
    if h2 <= base.f1 + load.abs() {
        return Err(NoCycle::BelowFriction { h2, f1: base.f1, load: load.abs() });
    }
    let mut run = Relayed {
        plant: Exact::at_rest(base, load, 0.0),
        h1,
        h2,
        integral: 0.0,
        signs: (1.0, 1.0),
        t: 0.0,
        pieces: Vec::new(),
        extremes: Vec::new(),
    };
    let mut last = 0.0;
    let mut before = (0.0, 0.0);
    for cycle in 0..10_000 {
        run.pieces.clear();
        run.extremes.clear();
        let mut events = 0;
        while !run.step() {
            events += 1;
            if events > 1000 {
                return Err(NoCycle::NotPeriodic(cycle));
            }
        }
        let period = run.t - last;
        last = run.t;
        let max = run.extremes.iter().copied().fold(f64::MIN, f64::max);
        let min = run.extremes.iter().copied().fold(f64::MAX, f64::min);
        let peak = 0.5 * (max - min);
        let same = |a: f64, b: f64| (a - b).abs() <= 1e-12 * a.abs();
        if cycle > 3 && same(period, before.0) && same(peak, before.1) {
            let start = run.t - period;
            let omega = std::f64::consts::TAU / period;
            let harmonic = |n: f64| harmonic(&run.pieces, start, omega * n) * 2.0 / period;
            let fundamental = harmonic(1.0);
            return Ok(ExactCycle {
                period_s: period,
                omega_rad_s: omega,
                fundamental,
                peak,
                third: harmonic(3.0) / fundamental,
                cycles: cycle + 1,
            });
        }
        before = (period, peak);
    }
    Err(NoCycle::NotPeriodic(10_000))
}

/// |∫x·e^(−jωt)| over the pieces, by Gauss–Legendre of order 5 on parts short against 1/ω.
fn harmonic(pieces: &[(f64, Arc, f64)], start: f64, omega: f64) -> f64 {
    const NODES: [(f64, f64); 5] = [
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (0.906_179_845_938_664, 0.236_926_885_056_189_08),
        (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    ];
    let (mut re, mut im) = (0.0, 0.0);
    for (t0, arc, duration) in pieces {
        let parts = (duration * omega / 0.3).ceil().max(1.0);
        let h = duration / parts;
        for i in 0..parts as usize {
            for (node, weight) in NODES {
                let t = h * (i as f64 + 0.5 + 0.5 * node);
                let angle = omega * (t0 - start + t);
                let value = arc.at(t).0 * weight * 0.5 * h;
                re += value * angle.cos();
                im += value * angle.sin();
            }
        }
    }
    re.hypot(im)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Acceptance row 6 (docs/theory.md, section 2): T and peak to 1e-5 relative; a and X3/X1 to the digits printed there.
    #[test]
    fn row_6_limit_cycles() {
        let base = Base::new(0.02685, 0.11, 0.5).unwrap();
        for (h1, h2, period, omega, a, peak, third) in [
            (2.0, 1.5, 0.723195, 8.68809, 1.27742, 1.257527, 0.0399),
            (1.0, 0.7, 0.288730, 21.76145, 0.10192, 0.099416, 0.0354),
            (2.5, 2.0, 0.871073, 7.21315, 2.30762, 2.279813, 0.0424),
            (5.0, 4.0, 1.026362, 6.12180, 6.33725, 6.278961, 0.0459),
            (4.0, 3.5, 1.098373, 5.72045, 5.81644, 5.779208, 0.0468),
        ] {
            let cycle = exact_cycle(base, 0.0, h1, h2).unwrap();
            assert!((cycle.period_s / period - 1.0).abs() < 1e-5, "T {} for {h1}, {h2}", cycle.period_s);
            assert!((cycle.omega_rad_s / omega - 1.0).abs() < 1e-5);
            assert!((cycle.peak / peak - 1.0).abs() < 1e-5, "peak {} for {h1}, {h2}", cycle.peak);
            assert!((cycle.fundamental - a).abs() < 1e-5, "a {} for {h1}, {h2}", cycle.fundamental);
            assert!((cycle.third - third).abs() < 6e-5, "X3/X1 {} for {h1}, {h2}", cycle.third);
        }
    }

    /// Row 14: h2 below f1.
    #[test]
    fn row_14_no_limit_cycle() {
        let base = Base::new(0.02685, 0.11, 0.5).unwrap();
        let refusal = exact_cycle(base, 0.0, 1.0, 0.49).unwrap_err();
        assert_eq!(refusal, NoCycle::BelowFriction { h2: 0.49, f1: 0.5, load: 0.0 });
        assert!(refusal.to_string().starts_with("no limit cycle"));
    }
}
