//! The file: bodies, joints and actuators, with a comment for each part.

use std::fmt::Write as _;

use breakaway_core::plant::effect::Element;

use super::super::axis::{Axis, Part};
use super::super::fate::{Row, losses};
use super::super::{number, xml_comment};
use super::{Friction, Parts, Second};
use crate::export::Winding;
use crate::file::EXPORT_MARK;

/// Share of the inertia that MuJoCo is given as a body, because it takes no body without. The joint's armature has the rest.
const BODY_SHARE: f64 = 1e-6;

/// The whole file.
pub(super) fn document(axis: &Axis, parts: &Parts, winding: Option<(Winding, f64)>, rows: &[Row]) -> String {
    let mut out = String::new();
    let mut line = |text: &str| {
        // Writing to a String cannot fail.
        let _ = writeln!(out, "{text}");
    };
    line(&format!("<mujoco model=\"{}\">", axis.name));
    line(&xml_comment("  ", &format!("{EXPORT_MARK}{}, for MuJoCo 3.7 or later", env!("CARGO_PKG_VERSION"))));
    for said in axis.summary().iter().chain(&losses(rows)) {
        line(&xml_comment("  ", said));
    }
    line("  <compiler angle=\"radian\" autolimits=\"true\"/>");
    line(&xml_comment("  ", "Euler takes the joint's damping implicitly, and bristles as they are"));
    let step = number(axis.timestep_s);
    line(&format!("  <option timestep=\"{step}\" integrator=\"Euler\" gravity=\"0 0 0\"/>"));
    line("  <worldbody>\n    <body name=\"motor\">");
    let share = axis.second_share();
    let (first, second) = (axis.base.inertia * (1.0 - share), axis.base.inertia * share);
    line(&inertial("      ", first * BODY_SHARE));
    line(&xml_comment("      ", &format!("armature: {}", axis.said[0])));
    let back_emf = winding.map_or(0.0, |(_, back_emf)| back_emf);
    let less = if winding.is_some() { ", less the back-EMF of the dcmotor" } else { "" };
    line(&xml_comment("      ", &format!("damping: {}{less}", axis.said[1])));
    let mut joint = format!(
        "      <joint name=\"axis\" {} armature=\"{}\" damping=\"{} {} 0\"",
        kind(axis),
        number(first * (1.0 - BODY_SHARE)),
        number(axis.base.viscous - back_emf),
        number(parts.quadratic)
    );
    if matches!(parts.friction, Friction::Loss) && axis.base.coulomb > 0.0 {
        line(&xml_comment("      ", &format!("frictionloss: {}; as stiff as the time step allows", axis.said[2])));
        let stiff =
            format!("solreffriction=\"{} 1\" solimpfriction=\"0.9999 0.9999 0.001\"", number(2.0 * axis.timestep_s));
        let _ = write!(joint, " frictionloss=\"{}\" {stiff}", number(axis.base.coulomb));
    }
    if let Some([stiffness, rest]) = parts.spring {
        let _ = write!(joint, " stiffness=\"{}\" springref=\"{}\"", number(stiffness), number(rest));
    }
    for part in axis.parts.iter().filter(|part| part.is_of_the_joint()) {
        line(&xml_comment("      ", &format!("{}: {}", part.name, part.said)));
    }
    line(&format!("{joint}/>"));
    if let Some(body) = &parts.second {
        line("      <body name=\"load\">");
        line(&inertial("        ", second));
        line(&match body {
            Second::Sprung { stiffness, damping } => format!(
                "        <joint name=\"coupling\" {} stiffness=\"{}\" damping=\"{}\"/>",
                kind(axis),
                number(*stiffness),
                number(*damping)
            ),
            Second::Loose { gap } => format!(
                "        <joint name=\"gap\" {} range=\"{} {}\" solreflimit=\"{} 1\"/>",
                kind(axis),
                number(-0.5 * gap),
                number(0.5 * gap),
                number(2.0 * axis.timestep_s)
            ),
        });
        line("      </body>");
    }
    line("    </body>\n  </worldbody>\n  <actuator>");
    actuators(axis, parts, winding, &mut line);
    line("  </actuator>\n</mujoco>");
    out
}

fn actuators(axis: &Axis, parts: &Parts, winding: Option<(Winding, f64)>, line: &mut impl FnMut(&str)) {
    let mut attributes = String::new();
    if let Some(limit) = parts.limit {
        let _ = write!(attributes, " ctrlrange=\"{} {}\"", number(-limit), number(limit));
    }
    if let Some(delay) = parts.delay_s.filter(|delay| *delay > 0.0) {
        let samples = (delay / axis.timestep_s).ceil() as u64 + 1;
        let _ = write!(attributes, " delay=\"{}\" nsample=\"{samples}\"", number(delay));
    }
    line(&xml_comment("    ", &format!("The drive, in {}", axis.drive_unit)));
    for part in axis.parts.iter().filter(|part| part.is_of_the_drive()) {
        line(&xml_comment("    ", &format!("{}: {}", part.name, part.said)));
    }
    line(&drive(axis, parts, winding, &attributes));
    let passive = "joint=\"axis\" input=\"none\" motorconst=\"0\" resistance=\"1\"";
    if let Friction::Bristles(numbers) = parts.friction {
        line(&xml_comment("    ", &format!("{}, carried by bristles", axis.said[2])));
        for part in axis.parts.iter().filter(|part| part.is_friction()) {
            line(&xml_comment("    ", &format!("{}: {}", part.name, part.said)));
        }
        let numbers = numbers.map(number).join(" ");
        line(&format!("    <dcmotor name=\"friction\" {passive} lugre=\"{numbers}\"/>"));
    }
    for (index, (numbers, said)) in parts.ripples.iter().enumerate() {
        line(&xml_comment("    ", said));
        let numbers = numbers.map(number).join(" ");
        line(&format!("    <dcmotor name=\"ripple_{}\" {passive} cogging=\"{numbers}\"/>", index + 1));
    }
}

/// The actuator of the drive, with the attributes that every actuator has.
fn drive(axis: &Axis, parts: &Parts, winding: Option<(Winding, f64)>, attributes: &str) -> String {
    let lag = parts.lag_s.map(number);
    if let Some((Winding { constant, resistance }, _)) = winding {
        let lag = lag.map_or_else(String::new, |lag| format!(" inductance=\"0 {lag}\""));
        let [gear, resistance, constant] = [axis.scale.gear, resistance, constant].map(number);
        return format!(
            "    <dcmotor name=\"drive\" joint=\"axis\" gear=\"{gear}\" resistance=\"{resistance}\" \
             motorconst=\"{constant}\"{lag}{attributes}/>"
        );
    }
    let lag = lag.map_or_else(String::new, |lag| format!(" dyntype=\"filterexact\" dynprm=\"{lag}\""));
    let force = number(axis.scale.force);
    format!("    <general name=\"drive\" joint=\"axis\" gainprm=\"{force}\"{lag}{attributes}/>")
}

/// Type and direction of a joint.
const fn kind(axis: &Axis) -> &'static str {
    if axis.scale.linear { "type=\"slide\" axis=\"1 0 0\"" } else { "type=\"hinge\" axis=\"0 0 1\"" }
}

/// A body's inertia: of a linear axis its mass, else its moment. The other one is as large, and does not count.
fn inertial(indent: &str, inertia: f64) -> String {
    let inertia = number(inertia);
    format!("{indent}<inertial pos=\"0 0 0\" mass=\"{inertia}\" diaginertia=\"{inertia} {inertia} {inertia}\"/>")
}

impl Part {
    /// Whether it stands in the attributes of the joint, or as a second joint.
    const fn is_of_the_joint(&self) -> bool {
        matches!(
            self.element,
            Element::Spring { .. }
                | Element::Drag { by_speed: 0.0, .. }
                | Element::SprungLoad { .. }
                | Element::LooseLoad { .. }
        )
    }

    /// Whether it stands in the attributes of the actuator.
    const fn is_of_the_drive(&self) -> bool {
        matches!(self.element, Element::DriveDelay { .. } | Element::DriveLag { .. } | Element::DriveLimit { .. })
    }

    /// Whether it is carried by bristles.
    const fn is_friction(&self) -> bool {
        matches!(self.element, Element::Bristles { .. } | Element::LevelBySpeed { .. } | Element::LevelAtRest { .. })
    }
}
