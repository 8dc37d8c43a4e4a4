//! URDF: `<dynamics damping friction>` of a joint, and the inertia of the link that it moves.

use std::fmt::Write as _;

use breakaway_core::plant::effect::Element;

use super::axis::{Axis, Decided, Part, base_kept};
use super::fate::{Row, Written, kept, losses, lost, near};
use super::{number, xml_comment};
use crate::file::EXPORT_MARK;

/// Limit of what the recordings do not know (travel, speed, effort), as URDF demands one.
const UNKNOWN: &str = "1e6";

fn decide(part: &Part) -> Decided {
    match part.element {
        Element::DriveLimit { .. } => kept("limit effort, as the force of the largest drive"),
        Element::SprungLoad { .. } | Element::LooseLoad { .. } => near("the load is rigid with the motor"),
        Element::LevelAtRest { .. } | Element::LevelBySpeed { .. } | Element::Bristles { .. } => {
            lost("friction is one number; it is that of fast sliding")
        }
        _ => lost("a joint has damping and friction and nothing else"),
    }
}

pub(super) fn write(axis: &Axis) -> Written {
    let mut rows: Vec<Row> = base_kept(["inertia of the link", "dynamics damping", "dynamics friction"]);
    rows.extend(axis.parts.iter().map(|part| part.row(decide(part))));
    let mut out = String::from("<?xml version=\"1.0\"?>\n");
    let mut line = |text: &str| {
        // Writing to a String cannot fail.
        let _ = writeln!(out, "{text}");
    };
    let comment = |text: &str| xml_comment("  ", text);
    line(&comment(&format!("{EXPORT_MARK}{}", env!("CARGO_PKG_VERSION"))));
    line(&format!("<robot name=\"{}\">", axis.name));
    for said in axis.summary().iter().chain(&losses(&rows)) {
        line(&comment(said));
    }
    let inertia = number(axis.base.inertia);
    line("  <link name=\"base\"/>\n  <link name=\"load\">\n    <inertial>");
    line(&comment(&axis.said[0]));
    line(&format!("      <mass value=\"{inertia}\"/>"));
    line(&format!(
        "      <inertia ixx=\"{inertia}\" iyy=\"{inertia}\" izz=\"{inertia}\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/>"
    ));
    line("    </inertial>\n  </link>");
    let (kind, direction) = axis.joint();
    line(&format!("  <joint name=\"axis\" type=\"{kind}\">"));
    line("    <parent link=\"base\"/>\n    <child link=\"load\"/>");
    line(&format!("    <axis xyz=\"{direction}\"/>"));
    line(&comment(&format!("damping: {}", axis.said[1])));
    line(&comment(&format!("friction: {}", axis.said[2])));
    let (damping, friction) = (number(axis.base.viscous), number(axis.base.coulomb));
    line(&format!("    <dynamics damping=\"{damping}\" friction=\"{friction}\"/>"));
    let effort = axis.largest_force().map_or(UNKNOWN.to_owned(), number);
    line(&comment("limits: 1e6 where the recordings do not know one"));
    line(&format!("    <limit lower=\"-{UNKNOWN}\" upper=\"{UNKNOWN}\" effort=\"{effort}\" velocity=\"{UNKNOWN}\"/>"));
    line("  </joint>\n</robot>");
    Written { text: out, rows, remarks: Vec::new() }
}
