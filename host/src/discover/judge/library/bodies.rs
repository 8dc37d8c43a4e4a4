//! Columns of second bodies that hang on the measured position.

use breakaway_core::plant::Kind;

use super::super::term::{Column, Name, Sign, Term};
use super::super::weak_form::Field;
use super::Library;

/// Damping ratio above which a second body is no coupling. Less than a tenth of an oscillation is then left after a
/// period. Something that yields does that, and so does the contact of a gap.
pub const MOST_DAMPING: f64 = 0.35;
/// Points of the grid of a second body's angular frequencies.
const BODIES: i32 = 27;
/// Those that are tried. In these windows only the phase tells the two fastest bodies from the motor.
const TRIED: i32 = BODIES - 2;

impl Library<'_> {
    pub(super) fn second_bodies(&self) -> Vec<Term> {
        let mut terms = Vec::new();
        let [low, ratio] = self.frequencies();
        for i in 0..TRIED {
            let omega = low * ratio.powi(i);
            terms.extend([0.02, 0.1, 0.3, 0.7, 2.0].map(|zeta| self.second_body(omega, zeta)));
        }
        terms
    }

    /// The least angular frequency of the grid, rad/s, and its ratio.
    pub(super) fn frequencies(&self) -> [f64; 2] {
        let longest = self.form.dataset.pieces.iter().map(|p| p.x.len() as f64 * p.h_s).fold(0.0, f64::max);
        let (low, high) = (6.0 / longest, 2.5 / self.form.half_width_s);
        [low, (high / low).powf(1.0 / f64::from(BODIES - 1))]
    }

    pub(super) fn second_body(&self, omega: f64, zeta: f64) -> Term {
        let damped = zeta > MOST_DAMPING;
        let name = if damped { Name::Decoy("damped mode") } else { Name::Effect(Kind::FlexibleCoupling) };
        let mut term = Term::force(name, Vec::new()).with(0, omega).with(1, zeta);
        term.u = vec![Column::displacement(self.load(omega, zeta))];
        term.body = Some([omega, zeta]);
        // A false objection costs less than a false name, so a decoy needs no more.
        term.chosen_of = if damped { 1.0 } else { f64::from(TRIED) };
        term.signed(Sign::Positive)
    }

    /// Position of a load that hangs on the measured position by a spring and a damper, by the bilinear transform.
    fn load(&self, omega: f64, zeta: f64) -> Field {
        let each = self.form.dataset.pieces.iter().map(|piece| {
            let k = 2.0 / piece.h_s;
            let (damping, stiffness) = (2.0 * zeta * omega, omega * omega);
            let above = [damping * k + stiffness, 2.0 * stiffness, stiffness - damping * k];
            let below = [k * k + damping * k + stiffness, 2.0 * (stiffness - k * k), k * k - damping * k + stiffness];
            // A division in each step would take half of the time.
            let [above, below] = [above, below].map(|own| own.map(|c| c / below[0]));
            let first = piece.x[0];
            let (mut x1, mut x2, mut y1, mut y2) = (0.0, 0.0, 0.0, 0.0);
            piece
                .x
                .iter()
                .map(|x| {
                    let x = x - first;
                    let y = above[0] * x + above[1] * x1 + above[2] * x2 - below[1] * y1 - below[2] * y2;
                    (x2, x1, y2, y1) = (x1, x, y1, y);
                    y
                })
                .collect()
        });
        each.collect()
    }
}

#[cfg(test)]
mod tests {
    use breakaway_core::plant::Kind;

    use super::super::super::dataset::Dataset;
    use super::super::super::ruling::rule;
    use super::super::super::search::Stage;
    use super::super::super::settings::Settings;
    use super::super::super::sides::Model;
    use super::super::super::weak_form::WeakForm;
    use super::super::super::weights::Weights;
    use crate::recording::Recording;

    /// Inertia of motor and load, viscous and Coulomb friction; the load's angular frequency on a motor that is held, rad/s.
    const MOTOR: f64 = 0.02;
    const LOAD: f64 = 0.01;
    const FRICTION: [f64; 2] = [0.05, 0.1];
    const OMEGA: f64 = 40.0;
    /// Angular frequencies of the drive, rad/s, on both sides of the resonance.
    const SINES: [f64; 6] = [2.1, 13.3, 27.0, 51.0, 67.0, 97.0];

    /// So many rows, `interval_s` apart. `drive` is given the time and the position. `step` moves the axis on by 0.1 ms.
    fn recorded(
        (rows, interval_s): (u32, f64),
        mut drive: impl FnMut(f64, f64) -> f64,
        mut step: impl FnMut(f64, [f64; 2]) -> [f64; 2],
    ) -> Recording {
        let mut axis = [0.0, 0.0];
        let mut recording = Recording::default();
        for k in 0..rows {
            let t = interval_s * f64::from(k);
            let u = drive(t, axis[0]);
            recording.t.push(t);
            recording.u.push(u);
            recording.x.push(axis[0]);
            for _ in 0..(interval_s / 1e-4).round() as u32 {
                axis = step(u, axis);
            }
        }
        recording
    }

    /// A coupling is the best of 25 frequencies, so it needs a z of 4.74 instead of 4, with other parameters too. An end stop and
    /// a motor's gain over position were called couplings at 4.1 to 4.6 (MuJoCo). A damped mode objects from a z of 4 on.
    #[test]
    fn a_coupling_is_the_best_of_many() {
        let settings = Settings::default();
        let sine = |t: f64, _: f64| (3.0 * t).sin();
        let recording = recorded((4000, 2e-3), sine, |u, [x, v]| [x + v * 1e-4, v + (u - v) / MOTOR * 1e-4]);
        let dataset = Dataset::new(&[recording], &settings);
        let form = WeakForm::new(&dataset, 0.03, &settings).unwrap();
        let stage = Stage::new(&form, &settings, Model::default(), &Weights::equal(&form)).unwrap();
        let library = stage.library();
        let z = |zeta: f64| {
            let body = library.second_body(OMEGA, zeta);
            let moved = library.remade(&body, &[1.1 * OMEGA, zeta]).map(|own| settings.least_z(own.chosen_of));
            (settings.least_z(body.chosen_of), moved)
        };
        let (coupling, moved) = z(0.1);
        assert!((coupling - 4.74).abs() < 0.01 && moved == Some(coupling), "{coupling} {moved:?}");
        assert!((z(0.7).0 - settings.z).abs() < 1e-12);
    }

    /// 12 s at 500 Hz under six sines. The inertia of the base is that of both bodies, within 3 %; that of the motor alone
    /// is a third less. The load's share and frequency stand for each other: 7 % and 2 % off, with a stiffness within 4 %.
    #[test]
    fn the_inertia_is_that_of_both_bodies() {
        let sines = |t: f64, _: f64| SINES.iter().map(|omega| 0.4 * (omega * t).sin()).sum();
        let (mut y, mut w) = (0.0, 0.0);
        let recording = recorded((6000, 2e-3), sines, |u, [x, v]| {
            let spring = LOAD * (OMEGA * OMEGA * (x - y) + 2.0 * 0.03 * OMEGA * (v - w));
            let force = u - spring;
            let free = v + (force - FRICTION[1] * v.signum() - FRICTION[0] * v) / MOTOR * 1e-4;
            let v = if free * v < 0.0 && force.abs() <= FRICTION[1] { 0.0 } else { free };
            w += spring / LOAD * 1e-4;
            y += w * 1e-4;
            [x + v * 1e-4, v]
        });
        let ruling = rule(&[recording], None, &Settings::default()).unwrap();
        let coupling = ruling.findings.iter().find(|own| own.effect.kind == Kind::FlexibleCoupling).unwrap();
        let [share, omega] = [coupling.effect.p[0], coupling.effect.p[1]];
        assert!((ruling.base.b / (MOTOR + LOAD) - 1.0).abs() < 0.03, "{:?}", ruling.base);
        assert!(
            (share * (MOTOR + LOAD) / LOAD - 1.0).abs() < 0.1 && (omega / OMEGA - 1.0).abs() < 0.03,
            "{coupling:?}"
        );
        let stiffness = share * ruling.base.b * omega * omega;
        assert!((stiffness / (LOAD * OMEGA * OMEGA) - 1.0).abs() < 0.04, "{stiffness}");
    }

    /// 15 s at 1 kHz under a relay of two levels. The friction takes up nine tenths of the net force until it slips, as that of
    /// MuJoCo does. So it follows the drive at reversals, which a strongly damped mode explains as well as a coupling. The
    /// inertia is .2 % too large.
    #[test]
    fn friction_that_follows_the_drive_is_no_coupling() {
        let (b, c, f1) = (0.003, 0.02, 0.05);
        // MuJoCo's rate for its default time constant of 20 ms, 1/s.
        let rate = 105.0;
        let mut direction = 1.0;
        let relay = |t: f64, x: f64| {
            if x * direction > 0.3 {
                direction = -direction;
            }
            direction * if t % 6.0 < 3.0 { 0.35 } else { 0.6 }
        };
        let recording = recorded((15_000, 1e-3), relay, |u, [x, v]| {
            let net = u - c * v;
            let friction = (0.9 * (net + rate * b * v)).clamp(-f1, f1);
            let v = v + (net - friction) / b * 1e-4;
            [x + v * 1e-4, v]
        });
        let ruling = rule(&[recording], None, &Settings::default()).unwrap();
        assert!(ruling.findings.is_empty(), "{:?}", ruling.findings);
        assert!((ruling.base.b / b - 1.0).abs() < 0.005, "{:?}", ruling.base);
    }
}
