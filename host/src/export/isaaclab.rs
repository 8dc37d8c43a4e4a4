//! Isaac Lab: the configuration of an actuator, in Python. The friction arguments are those of Isaac Lab 2.3 on PhysX.

use std::fmt::Write as _;

use breakaway_core::plant::effect::Element;

use super::axis::{Axis, Decided, Part, base_kept};
use super::fate::{Row, Written, kept, losses, lost, near};
use super::number;
use crate::file::EXPORT_MARK;

fn decide(part: &Part) -> Decided {
    match part.element {
        Element::DriveLimit { .. } => kept("effort_limit, as the force of the largest drive"),
        Element::DriveDelay { .. } => near("min_delay and max_delay, in whole time steps"),
        Element::LevelAtRest { .. } => kept("friction, the level at rest, above dynamic_friction"),
        Element::LevelBySpeed { .. } => {
            near("friction and dynamic_friction: the level falls at once when motion begins")
        }
        Element::Bristles { .. } => near("friction and dynamic_friction, without presliding"),
        Element::SprungLoad { .. } | Element::LooseLoad { .. } => near("the load is rigid with the motor"),
        _ => lost("an actuator has armature, friction, a limit and a delay and nothing else"),
    }
}

pub(super) fn write(axis: &Axis) -> Written {
    let mut rows: Vec<Row> = base_kept(["armature", "viscous_friction", "dynamic_friction"]);
    rows.extend(axis.parts.iter().map(|part| part.row(decide(part))));
    let rise: f64 = axis
        .parts
        .iter()
        .map(|part| match part.element {
            Element::LevelAtRest { rise } | Element::LevelBySpeed { rise, .. } | Element::Bristles { rise, .. } => rise,
            _ => 0.0,
        })
        .sum();
    let delay = axis.parts.iter().find_map(|part| match part.element {
        Element::DriveDelay { delay_s } => Some((delay_s / axis.timestep_s).round() as u64),
        _ => None,
    });
    let mut out = format!("# {EXPORT_MARK}{}\n", env!("CARGO_PKG_VERSION"));
    let mut line = |text: &str| {
        // Writing to a String cannot fail.
        let _ = writeln!(out, "{text}");
    };
    for said in axis.summary().iter().chain(&losses(&rows)) {
        line(&format!("# {said}"));
    }
    let class = if delay.is_some() { "DelayedPDActuatorCfg" } else { "IdealPDActuatorCfg" };
    line(&format!("from isaaclab.actuators import {class}\n"));
    line("# Multiply a drive by this to get the effort target, at the load.");
    line(&format!("EFFORT_PER_DRIVE = {}  # {} per {}", number(axis.scale.force), axis.force_unit(), axis.drive_unit));
    line("");
    line(&format!("{}_CFG = {class}(", axis.name.to_ascii_uppercase()));
    line("    joint_names_expr=[\"axis\"],");
    line("    stiffness=0.0,  # driven by effort targets");
    line("    damping=0.0,");
    let mut argument = |name: &str, value: String, said: &str| line(&format!("    {name}={value},  # {said}"));
    argument("armature", number(axis.base.inertia), &axis.said[0]);
    argument("viscous_friction", number(axis.base.viscous), &axis.said[1]);
    argument("dynamic_friction", number(axis.base.coulomb), &axis.said[2]);
    let at_rest = if rise == 0.0 { "the same at rest".to_owned() } else { "with the rise towards rest".to_owned() };
    argument("friction", number(axis.base.coulomb + rise), &at_rest);
    if let Some(effort) = axis.largest_force() {
        argument("effort_limit", number(effort), "the force of the largest drive");
    }
    if let Some(steps) = delay {
        argument("min_delay", steps.to_string(), &format!("time steps of {} s", number(axis.timestep_s)));
        argument("max_delay", steps.to_string(), "the same");
    }
    line(")");
    Written { text: out, rows, remarks: Vec::new() }
}
