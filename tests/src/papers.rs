//! The papers' own formulas, literally, as a reference only: they contain the errors that the errata list.
//!
//! Use [`breakaway_core::estimate::modulating`] or [`breakaway_core::estimate::describing_function`] instead.

use breakaway_core::scalar::Real;

/// One relay experiment as the papers use it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelayExperiment<R> {
    /// Amplitude of the relay on the error, drive units.
    pub h1: R,
    /// Amplitude of the relay on the error's integral, drive units.
    pub h2: R,
    /// Amplitude of the limit cycle's fundamental, position units.
    pub a: R,
    /// Its angular frequency, rad/s.
    pub omega: R,
}

/// What the papers' formulas give: `Gp = Kp/(s(Tp·s + 1))` and the friction; no errors are known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperEstimate<R> {
    /// Gain, position units per second and drive unit.
    pub kp: R,
    /// Time constant, s.
    pub tp: R,
    /// Coulomb friction, drive units.
    pub f1: R,
    /// Viscous friction, drive units per (position unit/s).
    pub f2: R,
}

/// Paper eq. 17, as printed. Errata 18–21: the frequency is missing in f1 and f2, Kp and Tp neglect the friction
/// relay, experiment 1 is used twice (which forces f2 = −4f1/(πa1)), and it divides by a2 − a1.
pub fn equation_17<R: Real>(first: RelayExperiment<R>, second: RelayExperiment<R>) -> PaperEstimate<R> {
    let (h11, h21, a1, omega1) = (first.h1, first.h2, first.a, first.omega);
    let (h12, h22, a2, omega2) = (second.h1, second.h2, second.a, second.omega);
    let pi = R::from_f64(core::f64::consts::PI);
    let four = R::from_f64(4.0);
    let tp = h11 / (h21 * omega1);
    let root = (R::ONE + omega1 * omega1 * tp * tp).sqrt();
    let kp = pi * a1 / (four * (h11 * h11 + h21 * h21).sqrt()) * omega1 * root;
    let f1 = (-h11 * a2 / (tp * omega1) + h12 * a1 / (tp * omega2) + h21 * a2 - h22 * a1) / (a2 - a1);
    let f2 = -four / (pi * a1) * (h11 / (tp * omega1) + f1 - h21);
    PaperEstimate { kp, tp, f1, f2 }
}

/// The memo's MATLAB listing (memo section 3.2), as printed, for three experiments. Erratum 14: f2 lacks ω.
pub fn memo_listing<R: Real>(experiments: [RelayExperiment<R>; 3]) -> PaperEstimate<R> {
    let [first, second, third] = experiments;
    let (h21, a1, w1) = (first.h2, first.a, first.omega);
    let (h22, a2, w2) = (second.h2, second.a, second.omega);
    let (h23, a3, w3) = (third.h2, third.a, third.omega);
    let pi = R::from_f64(core::f64::consts::PI);
    let four = R::from_f64(4.0);
    let f1 = (a2 * (w2 - w1) * (a3 * w3 * h21 - a1 * w1 * h23) - a3 * (w3 - w1) * (a2 * w2 * h21 - a1 * w1 * h22))
        / (a3 * (w3 - w1) * (a1 * w1 - a2 * w2) - a2 * (w2 - w1) * (a1 * w1 - a3 * w3));
    let f2 = four * ((a1 * w1 - a2 * w2) * f1 - a1 * w1 * h22 + a2 * w2 * h21) / ((pi * a1 * a2) * (w2 - w1));
    let kp = -pi * a1 * w1 / (four * (f1 - h21) + pi * a1 * f2);
    let tp = four * first.h1 * kp / (pi * a1 * w1 * w1);
    PaperEstimate { kp, tp, f1, f2 }
}
