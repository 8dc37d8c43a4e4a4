//! Coulomb friction varies along the travel, for example on a bent shaft. Unlike cogging, this force changes its sign
//! with the velocity.

use super::{ActsIn, Compensation, Definition, Element, Instant, Law, Over, Parameter, Role, Search};
use crate::plant::base::Base;
use crate::scalar::Real;

/// Position-dependent friction: `−f1·k·sin(n·x + φ)·sgn v`.
#[derive(Clone, Copy, Debug)]
pub struct PositionFriction;

impl Law for PositionFriction {
    const DEFINITION: Definition = Definition {
        name: "position_friction",
        title: "Position-dependent friction",
        law: "−f1·k·sin(n·x + φ)·sgn v",
        acts_in: ActsIn::Force,
        parameters: &[
            Parameter::new(Role::Ratio, "k", "depth of the modulation", -1.0, 1.0),
            Parameter::new(Role::WaveNumber, "n", "wave number", 1e-9, 1e9)
                .search(Search::Spectrum(Over::PositionAndDirection)),
            Parameter::phase("phi", 0, "phase"),
        ],
        shown_by: "long travel in both directions",
        confused_with: &["cogging"],
        compensation: Some("feed-forward along the reference"),
        phase_per_recording: true,
        ..Definition::PLAIN
    };

    fn level<R: Real>(p: &[R], base: &Base<R>, at: &Instant<R>) -> R {
        base.f1 * p[0] * at.averaged(p[1]) * (p[1] * at.x + p[2]).sin()
    }

    fn compensation<R: Real>(p: &[R], base: &Base<R>) -> Option<Compensation<R>> {
        Some(Compensation::LevelRipple { amplitude: base.f1 * p[0], wave_number: p[1], phase: p[2] })
    }

    fn element(p: &[f64], base: &Base<f64>) -> Element {
        Element::LevelByPosition { amplitude: base.f1 * p[0], wave_number: p[1], phase: p[2] }
    }
}
