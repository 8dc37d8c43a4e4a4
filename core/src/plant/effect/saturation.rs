//! The drive is limited to ±u_max.

use super::{ActsIn, Definition, Element, Held, Instant, Law, Memory, Parameter, Role, Scale, Search};
use crate::plant::base::Base;
use crate::scalar::Real;

/// Saturation of the drive: `u_a = clip(u, ±u_max)`.
#[derive(Clone, Copy, Debug)]
pub struct Saturation;

impl Law for Saturation {
    const DEFINITION: Definition = Definition {
        name: "saturation",
        title: "Saturation of the drive",
        law: "u_a = clip(u, ±u_max)",
        acts_in: ActsIn::Drive,
        parameters: &[
            Parameter::new(Role::Threshold, "u_max", "limit", 1e-9, 1e9)
                .search(Search::Grid(Scale::Drive, &[0.98, 0.95, 0.9, 0.8, 0.7, 0.6, 0.5])),
        ],
        shown_by: "large drive",
        confused_with: &["quadratic_drag"],
        compensation: None,
        ..Definition::PLAIN
    };

    const ALONG_THE_DRIVE: u8 = 2;

    fn drive<R: Real>(p: &[R], at: &Instant<R>, _past: Held<'_>, _memory: &mut Memory<R>, _h: f64) -> R {
        at.u.min(p[0]).max(-p[0])
    }

    fn element(p: &[f64], _base: &Base<f64>) -> Element {
        Element::DriveLimit { largest: p[0] }
    }
}
