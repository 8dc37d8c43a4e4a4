//! Modelica: the equations of the axis as a model of its own, with one parameter a line.
//!
//! Bristles carry the friction also where the model has Coulomb's law, because every tool solves an equation without
//! events. Their presliding of 1e-4 rad (or m) is shorter than most encoders tell.

use std::fmt::Write as _;

use breakaway_core::plant::effect::Element;

use super::axis::{Axis, Decided, Part, base_rows};
use super::fate::{Row, Written, kept, losses, lost, near};
use super::number;
use crate::file::EXPORT_MARK;

/// How far bristles bend before they slip, where the model has none, rad or m.
const PRESLIDING: f64 = 1e-4;

/// The equations as they grow.
struct Equations {
    declared: Vec<String>,
    /// Terms of the force, and of the friction level.
    force: Vec<String>,
    level: Vec<String>,
    lines: Vec<String>,
    /// The drive as it reaches the motor.
    drive: String,
    bristles: Option<[f64; 2]>,
    inertia: String,
    second: Option<String>,
}

impl Equations {
    /// Declares a parameter of a part, with the part's number in its name.
    fn declare(&mut self, part: &Part, index: usize, symbol: &str, value: f64) -> String {
        let name = format!("{symbol}{index}");
        self.declared.push(format!("  parameter Real {name} = {}; // {}: {}", number(value), part.name, part.said));
        name
    }
}

fn decide(part: &Part, index: usize, all: &mut Equations) -> Decided {
    match part.element {
        Element::Constant { force } => {
            let f = all.declare(part, index, "force", force);
            all.force.push(f);
        }
        Element::Drag { by_speed, by_square } => {
            let (a, b) =
                (all.declare(part, index, "by_speed", by_speed), all.declare(part, index, "by_square", by_square));
            all.force.push(format!("(-abs(v)*({a} + {b}*v))"));
        }
        Element::Ripple { wave_number, first, second } => {
            let (k, a, p) = (
                all.declare(part, index, "wave", wave_number),
                all.declare(part, index, "amplitude", first[0]),
                all.declare(part, index, "phase", first[1]),
            );
            all.force.push(format!("{a}*sin({k}*x + {p})"));
            if second[0] != 0.0 {
                let (a, p) = (
                    all.declare(part, index, "second", second[0]),
                    all.declare(part, index, "second_phase", second[1]),
                );
                all.force.push(format!("{a}*sin(2*{k}*x + {p})"));
            }
        }
        Element::Spring { stiffness, rest } => {
            let (k, r) = (all.declare(part, index, "stiffness", stiffness), all.declare(part, index, "rest", rest));
            all.force.push(format!("(-{k}*(x - {r}))"));
        }
        Element::Stop { stiffness, begins } => {
            let (k, b) = (all.declare(part, index, "stiffness", stiffness), all.declare(part, index, "begins", begins));
            all.force.push(format!("(if {k}*(x - {b}) > 0 then -abs({k})*(x - {b}) else 0)"));
        }
        Element::Shaking { amplitude, angular_frequency, phase } => {
            let (a, w, p) = (
                all.declare(part, index, "amplitude", amplitude),
                all.declare(part, index, "omega", angular_frequency),
                all.declare(part, index, "phase", phase),
            );
            all.force.push(format!("{a}*sin({w}*time + {p})"));
        }
        Element::LevelBySpeed { rise, speed, exponent } => {
            let (s, vs, p) = (
                all.declare(part, index, "rise", rise),
                all.declare(part, index, "speed", speed),
                all.declare(part, index, "exponent", exponent),
            );
            all.level.push(format!("{s}*exp(-(abs(v)/{vs})^{p})"));
        }
        Element::LevelByDrive { ratio } => {
            let k = all.declare(part, index, "ratio", ratio);
            all.level.push(format!("{k}*abs(force_per_drive*drive)"));
        }
        Element::LevelByPosition { amplitude, wave_number, phase } => {
            let (a, k, p) = (
                all.declare(part, index, "amplitude", amplitude),
                all.declare(part, index, "wave", wave_number),
                all.declare(part, index, "phase", phase),
            );
            all.level.push(format!("{a}*sin({k}*x + {p})"));
        }
        Element::LevelInTime { rise, time_constant_s } => {
            let (s, t) = (all.declare(part, index, "rise", rise), all.declare(part, index, "decay", time_constant_s));
            all.level.push(format!("{s}*exp(-time/{t})"));
        }
        Element::Bristles { stiffness, damping, rise, speed } => {
            all.bristles = Some([stiffness, damping]);
            let (s, vs) = (all.declare(part, index, "rise", rise), all.declare(part, index, "speed", speed));
            all.level.push(format!("{s}*exp(-(v/{vs})^2)"));
        }
        Element::InertiaStep { share, at_s } => {
            let (r, t) = (all.declare(part, index, "share", share), all.declare(part, index, "at", at_s));
            all.inertia = format!("{}*(if time >= {t} then 1 + {r} else 1)", all.inertia);
        }
        Element::SprungLoad { share, angular_frequency, damping_ratio } => {
            let (m, w, z) = (
                all.declare(part, index, "share", share),
                all.declare(part, index, "omega", angular_frequency),
                all.declare(part, index, "zeta", damping_ratio),
            );
            all.inertia = format!("{}*(1 - {m})", all.inertia);
            all.declared.push("  Real y(start = 0) \"load\"; Real w(start = 0) \"load\";".to_owned());
            all.lines.push("  der(y) = w;".to_owned());
            all.lines.push(format!("  der(w) = {w}^2*(x - y) + 2*{z}*{w}*(v - w);"));
            all.second = Some(format!("(-{m}*inertia*der(w))"));
        }
        Element::DriveDelay { delay_s } => {
            let t = all.declare(part, index, "delay", delay_s);
            all.drive = format!("delay({}, {t})", all.drive);
        }
        Element::DriveGainDrift { rate } => {
            let k = all.declare(part, index, "rate", rate);
            all.drive = format!("({})*(1 - {k}*time)", all.drive);
        }
        Element::DriveLimit { largest } => {
            let m = all.declare(part, index, "largest", largest);
            all.drive = format!("max(-{m}, min({m}, {}))", all.drive);
        }
        Element::DriveDeadZone { half_width } => {
            let d = all.declare(part, index, "half_width", half_width);
            let u = all.drive.clone();
            all.drive = format!("(max({u} - {d}, 0) + min({u} + {d}, 0))");
        }
        Element::DriveDeadTime { loss, edge, back_emf } => {
            let (d, e, k) = (
                all.declare(part, index, "loss", loss),
                all.declare(part, index, "edge", edge),
                all.declare(part, index, "back_emf", back_emf),
            );
            let u = all.drive.clone();
            all.drive = format!("({u} - {d}*max(-1, min(1, ({u} - {k}*v)/{e})))");
        }
        Element::DriveLag { time_constant_s } => {
            let t = all.declare(part, index, "lag", time_constant_s);
            all.declared.push("  Real lagged(start = 0);".to_owned());
            all.lines.push(format!("  {t}*der(lagged) = {} - lagged;", all.drive));
            "lagged".clone_into(&mut all.drive);
        }
        Element::ReadingRipple { amplitude, wave_number, phase } => {
            let (a, k, p) = (
                all.declare(part, index, "amplitude", amplitude),
                all.declare(part, index, "wave", wave_number),
                all.declare(part, index, "phase", phase),
            );
            all.declared.push("  output Real reading;".to_owned());
            all.lines.push(format!("  reading = x + {a}*sin({k}*x + {p});"));
        }
        Element::LevelAtRest { rise } => {
            let s = all.declare(part, index, "rise", rise);
            // The speed at which bristles of this presliding let go is below every other of the model.
            all.level.push(format!("{s}*exp(-(v/let_go)^2)"));
            return near("the level falls to that of sliding at the speed of a bristle that lets go");
        }
        Element::LooseLoad { .. } => return lost("impacts need events; the load is rigid with the motor"),
        Element::Other => return lost("no equation is known for it"),
    }
    kept("an equation")
}

pub(super) fn write(axis: &Axis) -> Written {
    let mut all = Equations {
        declared: Vec::new(),
        force: Vec::new(),
        level: vec!["coulomb".to_owned()],
        lines: Vec::new(),
        drive: "u".to_owned(),
        bristles: None,
        inertia: "inertia".to_owned(),
        second: None,
    };
    // Drive-path parts act in the order of the catalogue, whatever theirs in the model.
    let mut order: Vec<usize> = (0..axis.parts.len()).collect();
    order.sort_by_key(|index| axis.parts[*index].along_the_drive);
    let mut decided: Vec<(usize, Row)> = order
        .into_iter()
        .map(|index| (index, axis.parts[index].row(decide(&axis.parts[index], index + 1, &mut all))))
        .collect();
    decided.sort_by_key(|(index, _)| *index);
    let own = all.bristles.is_some();
    let level = axis.base.coulomb.max(1e-9);
    let stiffness = level / PRESLIDING;
    let [sigma0, sigma1] = all.bristles.unwrap_or([stiffness, (stiffness * axis.base.inertia).sqrt()]);
    let friction = if own { kept("an equation") } else { near("bristles with a presliding of 1e-4 rad or m") };
    let mut rows = base_rows([kept("an equation"), kept("an equation"), friction]);
    rows.extend(decided.into_iter().map(|(_, row)| row));
    let text = document(axis, &all, [sigma0, sigma1], &rows);
    Written { text, rows, remarks: Vec::new() }
}

fn document(axis: &Axis, all: &Equations, [sigma0, sigma1]: [f64; 2], rows: &[Row]) -> String {
    let mut out = format!("// {EXPORT_MARK}{}\n", env!("CARGO_PKG_VERSION"));
    let mut line = |text: &str| {
        // Writing to a String cannot fail.
        let _ = writeln!(out, "{text}");
    };
    for said in axis.summary().iter().chain(&losses(rows)) {
        line(&format!("// {said}"));
    }
    line(&format!("model {} \"an axis and its friction\"", axis.name));
    line(&format!("  input Real u \"drive in {}\";", axis.drive_unit));
    let (length, force) = if axis.scale.linear { ("m", "N") } else { ("rad", "N.m") };
    line(&format!("  output Real x(start = 0, unit = \"{length}\") \"position of the load\";"));
    line(&format!(
        "  Real v(start = 0, unit = \"{length}/s\");\n  Real z(start = 0, unit = \"{length}\") \"bristles\";"
    ));
    line(&format!("  Real drive;\n  Real friction(unit = \"{force}\");\n  Real level(unit = \"{force}\");"));
    let base = [
        ("inertia", axis.base.inertia, &axis.said[0]),
        ("viscous", axis.base.viscous, &axis.said[1]),
        ("coulomb", axis.base.coulomb, &axis.said[2]),
    ];
    for (name, value, said) in base {
        line(&format!("  parameter Real {name} = {}; // {said}", number(value)));
    }
    line(&format!("  parameter Real force_per_drive = {};", number(axis.scale.force)));
    line(&format!("  parameter Real sigma0 = {}; // stiffness of the bristles", number(sigma0)));
    line(&format!("  parameter Real sigma1 = {}; // damping of the bristles", number(sigma1)));
    if all.level.iter().any(|term| term.contains("let_go")) {
        line("  parameter Real let_go = coulomb/sqrt(sigma0*inertia);");
    }
    for declared in &all.declared {
        line(declared);
    }
    line("equation");
    line(&format!("  drive = {};", all.drive));
    line("  der(x) = v;");
    let mut terms = vec!["force_per_drive*drive - viscous*v - friction".to_owned()];
    terms.extend(all.force.iter().cloned());
    terms.extend(all.second.clone());
    line(&format!("  {}*der(v) = {};", all.inertia, terms.join(" + ")));
    line(&format!("  level = max({}, 1e-9);", all.level.join(" + ")));
    line("  der(z) = v - sigma0*abs(v)*z/level;");
    line("  friction = sigma0*z + sigma1*der(z);");
    for equation in &all.lines {
        line(equation);
    }
    line(&format!("end {};", axis.name));
    out
}
