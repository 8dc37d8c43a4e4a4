//! MJCF, the format of MuJoCo: an axis of one or two bodies, its joint, and its actuators.
//!
//! `dcmotor` (MuJoCo 3.7) has cogging, LuGre friction and the winding's lag; `nsample` and `delay` (3.5) a dead time.
//! Passive parts are a `dcmotor` with `input="none"` and no motor constant, so that they add no control.

mod document;

use std::f64::consts::FRAC_PI_2;

use breakaway_core::plant::effect::Element;

use super::axis::{Axis, Decided, Part, base_rows};
use super::fate::{Row, Written, kept, lost, near};
use super::number;

/// The fastest bristle that a time step resolves, as the angle that it turns in a step, rad. At 0.2 rad bristles in
/// place of a Stribeck curve err by 8 % of the motion at 1 ms, and by 1 % at 0.1 ms. Beyond 0.5 rad stiffer ones are worse.
const BRISTLE_RAD: f64 = 0.2;

/// The friction of the joint.
enum Friction {
    /// Coulomb's law, by the solver.
    Loss,
    /// Bristles: stiffness, damping, sliding level, level at rest, Stribeck velocity.
    Bristles([f64; 5]),
}

/// A second body, behind a joint of its own.
enum Second {
    Sprung { stiffness: f64, damping: f64 },
    Loose { gap: f64 },
}

/// What the parts come to.
struct Parts {
    friction: Friction,
    quadratic: f64,
    spring: Option<[f64; 2]>,
    second: Option<Second>,
    /// Amplitude, wave number, phase, comment.
    ripples: Vec<([f64; 3], String)>,
    delay_s: Option<f64>,
    lag_s: Option<f64>,
    limit: Option<f64>,
}

pub(super) fn write(axis: &Axis) -> Written {
    let mut parts = Parts {
        friction: Friction::Loss,
        quadratic: 0.0,
        spring: None,
        second: None,
        ripples: Vec::new(),
        delay_s: None,
        lag_s: None,
        limit: None,
    };
    let mut remarks = Vec::new();
    let winding = winding(axis, &mut remarks);
    let decided: Vec<Row> =
        axis.parts.iter().map(|part| part.row(decide(axis, part, &mut parts, winding.is_some()))).collect();
    let coulomb = match parts.friction {
        Friction::Loss => kept("joint frictionloss"),
        Friction::Bristles(_) => kept("dcmotor lugre"),
    };
    let viscous = if winding.is_some() { "dcmotor back-EMF, and joint damping for the rest" } else { "joint damping" };
    let mut rows = base_rows([kept("joint armature"), kept(viscous), coulomb]);
    rows.extend(decided);
    let text = document::document(axis, &parts, winding, &rows);
    Written { text, rows, remarks }
}

/// The winding and its back-EMF at the load, N·m·s/rad, if the model's damping has room for it.
fn winding(axis: &Axis, remarks: &mut Vec<String>) -> Option<(super::Winding, f64)> {
    let winding = axis.scale.winding?;
    let at_load = winding.constant * axis.scale.gear;
    let back_emf = at_load * at_load / winding.resistance;
    if back_emf <= axis.base.viscous {
        return Some((winding, back_emf));
    }
    remarks.push(format!(
        "the constants of the motor make a back-EMF of {} {}·s per rad or m, more than the {} of the model; the motor is \
         exported as a source of torque, which moves alike; check the constants",
        number(back_emf),
        axis.force_unit(),
        number(axis.base.viscous)
    ));
    None
}

fn decide(axis: &Axis, part: &Part, parts: &mut Parts, winding: bool) -> Decided {
    let coulomb = axis.base.coulomb;
    let comment = format!("{}: {}", part.name, part.said);
    let mut ripple = |numbers: [f64; 3]| parts.ripples.push((numbers, comment.clone()));
    match part.element {
        Element::Constant { force } => {
            ripple([force, 0.0, FRAC_PI_2]);
            kept("dcmotor cogging of wave number 0, which is a constant force")
        }
        Element::Ripple { wave_number, first, second } => {
            ripple([first[0], wave_number, first[1]]);
            if second[0] != 0.0 {
                ripple([second[0], 2.0 * wave_number, second[1]]);
            }
            kept("dcmotor cogging")
        }
        Element::Drag { by_speed: 0.0, by_square } => {
            parts.quadratic += by_square;
            kept("second coefficient of the joint damping")
        }
        Element::Spring { stiffness, rest } => {
            parts.spring = Some([stiffness, rest]);
            kept("joint stiffness and springref")
        }
        Element::Bristles { stiffness, damping, rise, speed } => {
            parts.friction = Friction::Bristles([stiffness, damping, coulomb, coulomb + rise, speed]);
            kept("dcmotor lugre")
        }
        Element::LevelBySpeed { rise, speed, exponent } => {
            let [stiffness, damping] = resolved(axis);
            parts.friction = Friction::Bristles([stiffness, damping, coulomb, coulomb + rise, speed]);
            let form = if exponent == 2.0 { "" } else { "; its exponent is 2 there" };
            near(format!("dcmotor lugre, whose bristles are as stiff as the time step resolves{form}"))
        }
        Element::LevelAtRest { rise } if matches!(parts.friction, Friction::Loss) => {
            let [stiffness, damping] = resolved(axis);
            // The speed of a bristle that lets go: beyond it the level is that of sliding.
            let speed = (coulomb + rise) / (stiffness * axis.base.inertia).sqrt();
            parts.friction = Friction::Bristles([stiffness, damping, coulomb, coulomb + rise, speed]);
            near("dcmotor lugre: the level falls to that of sliding at the speed of a bristle that lets go")
        }
        Element::SprungLoad { share, angular_frequency, damping_ratio } => {
            let inertia = share * axis.base.inertia;
            let stiffness = inertia * angular_frequency * angular_frequency;
            let damping = 2.0 * damping_ratio * angular_frequency * inertia;
            parts.second = Some(Second::Sprung { stiffness, damping });
            kept("a second body behind a joint with stiffness and damping")
        }
        Element::LooseLoad { gap, .. } => {
            parts.second = Some(Second::Loose { gap });
            near("a second body behind a joint with a range; its stops yield, and have no restitution")
        }
        Element::DriveDelay { delay_s } => {
            parts.delay_s = Some(delay_s);
            kept("actuator delay, in whole time steps")
        }
        Element::DriveLag { time_constant_s } => {
            parts.lag_s = Some(time_constant_s);
            if winding {
                near("dcmotor inductance; there the back-EMF lags as well")
            } else {
                kept("actuator dyntype filterexact")
            }
        }
        Element::DriveLimit { largest } => {
            parts.limit = Some(largest);
            kept("actuator ctrlrange")
        }
        Element::Drag { .. } => lost("joint damping is the same in both directions"),
        Element::DriveDeadZone { .. } | Element::DriveDeadTime { .. } => {
            lost("no actuator has it; apply it to the control before MuJoCo gets it")
        }
        Element::Stop { .. } => lost("a joint's range ends at a constraint; apply the force by qfrc_applied"),
        Element::Shaking { .. } => lost("no force depends on the time; apply it by qfrc_applied"),
        Element::LevelAtRest { .. } => lost("the bristles of another effect carry the friction at rest"),
        Element::LevelByDrive { .. } | Element::LevelByPosition { .. } => lost("frictionloss is one number"),
        Element::LevelInTime { .. } | Element::DriveGainDrift { .. } | Element::InertiaStep { .. } => {
            lost("nothing changes over a session; the file has the end without it")
        }
        Element::ReadingRipple { .. } => lost("sensors have no error of the position; add it to the reading"),
        Element::Other => lost("no element of MuJoCo is known for it"),
    }
}

/// Stiffness and damping (half the critical one) of the stiffest bristles that the time step resolves.
fn resolved(axis: &Axis) -> [f64; 2] {
    let inertia = axis.base.inertia;
    let fastest = BRISTLE_RAD / axis.timestep_s;
    [inertia * fastest * fastest, inertia * fastest]
}
