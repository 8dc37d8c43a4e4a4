//! SDF, the format of Gazebo: the dynamics of a joint with its spring, and a second body behind a joint of its own.

use std::fmt::Write as _;

use breakaway_core::plant::effect::Element;

use super::axis::{Axis, Decided, Part, base_kept};
use super::fate::{Row, Written, kept, losses, lost, near};
use super::{number, xml_comment};
use crate::file::EXPORT_MARK;

fn decide(part: &Part) -> Decided {
    match part.element {
        Element::DriveLimit { .. } => kept("limit effort, as the force of the largest drive"),
        Element::Spring { .. } => kept("dynamics spring_stiffness and spring_reference"),
        Element::SprungLoad { .. } => kept("a second link behind a joint with spring_stiffness and damping"),
        Element::LooseLoad { .. } => near("the load is rigid with the motor"),
        Element::LevelAtRest { .. } | Element::LevelBySpeed { .. } | Element::Bristles { .. } => {
            lost("friction is one number; it is that of fast sliding")
        }
        _ => lost("a joint has damping, friction and a spring and nothing else"),
    }
}

/// A link with an inertia.
fn link(name: &str, inertia: f64) -> String {
    let inertia = number(inertia);
    let moments = ["ixx", "iyy", "izz"].map(|m| format!("<{m}>{inertia}</{m}>")).concat();
    let products = ["ixy", "ixz", "iyz"].map(|m| format!("<{m}>0</{m}>")).concat();
    format!(
        "    <link name=\"{name}\">\n      <inertial>\n        <mass>{inertia}</mass>\n        \
         <inertia>{moments}{products}</inertia>\n      </inertial>\n    </link>"
    )
}

/// A joint's beginning, up to its dynamics.
fn joint(axis: &Axis, name: &str, parent: &str, child: &str) -> String {
    let (kind, direction) = axis.joint();
    format!(
        "    <joint name=\"{name}\" type=\"{kind}\">\n      <parent>{parent}</parent>\n      <child>{child}</child>\n      \
         <axis>\n        <xyz>{direction}</xyz>"
    )
}

pub(super) fn write(axis: &Axis) -> Written {
    let mut rows: Vec<Row> = base_kept(["inertia of the link", "dynamics damping", "dynamics friction"]);
    rows.extend(axis.parts.iter().map(|part| part.row(decide(part))));
    let mut out = String::from("<?xml version=\"1.0\"?>\n");
    let mut line = |text: &str| {
        // Writing to a String cannot fail.
        let _ = writeln!(out, "{text}");
    };
    let comment = |text: &str| xml_comment("    ", text);
    line(&comment(&format!("{EXPORT_MARK}{}", env!("CARGO_PKG_VERSION"))));
    line(&format!("<sdf version=\"1.9\">\n  <model name=\"{}\">", axis.name));
    for said in axis.summary().iter().chain(&losses(&rows)) {
        line(&comment(said));
    }
    let sprung = axis.parts.iter().find_map(|part| match part.element {
        Element::SprungLoad { share, angular_frequency, damping_ratio } => {
            Some((share, angular_frequency, damping_ratio))
        }
        _ => None,
    });
    let share = sprung.map_or(0.0, |(share, ..)| share);
    line(&comment(&axis.said[0]));
    line(&link("motor", axis.base.inertia * (1.0 - share)));
    line(&joint(axis, "axis", "world", "motor"));
    line(&comment(&format!("damping: {}; friction: {}", axis.said[1], axis.said[2])));
    let mut dynamics =
        format!("<damping>{}</damping><friction>{}</friction>", number(axis.base.viscous), number(axis.base.coulomb));
    for part in &axis.parts {
        if let Element::Spring { stiffness, rest } = part.element {
            line(&comment(&format!("{}: {}", part.name, part.said)));
            let _ = write!(
                dynamics,
                "<spring_reference>{}</spring_reference><spring_stiffness>{}</spring_stiffness>",
                number(rest),
                number(stiffness)
            );
        }
    }
    line(&format!("        <dynamics>{dynamics}</dynamics>"));
    if let Some(effort) = axis.largest_force() {
        line(&format!("        <limit><effort>{}</effort></limit>", number(effort)));
    }
    line("      </axis>\n    </joint>");
    if let Some((share, frequency, ratio)) = sprung {
        let inertia = share * axis.base.inertia;
        line(&link("load", inertia));
        line(&joint(axis, "coupling", "motor", "load"));
        line(&format!(
            "        <dynamics><damping>{}</damping><spring_reference>0</spring_reference>\
             <spring_stiffness>{}</spring_stiffness></dynamics>",
            number(2.0 * ratio * frequency * inertia),
            number(frequency * frequency * inertia)
        ));
        line("      </axis>\n    </joint>");
    }
    line("  </model>\n</sdf>");
    Written { text: out, rows, remarks: Vec::new() }
}
