//! A model for other programs: MuJoCo, URDF, SDF, Isaac Lab, Modelica, and C for a controller.
//!
//! What an effect is as a part of a machine is said in its own file ([`Element`](breakaway_core::plant::effect::Element),
//! and for C [`Compensation`](breakaway_core::plant::effect::Compensation)). A file of this room has the syntax of one
//! target, and decides what of each part the target can hold. Nothing here names an effect.

mod axis;
mod c;
mod error;
mod fate;
mod isaaclab;
mod mjcf;
mod modelica;
mod sdf;
mod units;
mod urdf;

use std::fmt;
use std::str::FromStr;

use crate::model::Model;

pub use axis::{Sides, Values};
pub use error::ExportError;
pub use fate::{Fate, Row};
pub use units::{DriveKind, Motor, Scale, Side, Winding};

use axis::Axis;
use fate::Written;

/// Another program's format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Target {
    /// MuJoCo.
    Mjcf,
    /// Robots of ROS.
    Urdf,
    /// Gazebo.
    Sdf,
    /// Isaac Lab.
    IsaacLab,
    /// Modelica.
    Modelica,
    /// A header for a controller.
    C,
}

impl Target {
    /// All of them.
    pub const ALL: [Self; 6] = [Self::Mjcf, Self::Urdf, Self::Sdf, Self::IsaacLab, Self::Modelica, Self::C];

    /// Its name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mjcf => "mjcf",
            Self::Urdf => "urdf",
            Self::Sdf => "sdf",
            Self::IsaacLab => "isaaclab",
            Self::Modelica => "modelica",
            Self::C => "c",
        }
    }
}

impl fmt::Display for Target {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name())
    }
}

impl FromStr for Target {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|target| target.name() == text).ok_or_else(|| {
            let names: Vec<&str> = Self::ALL.iter().map(|target| target.name()).collect();
            format!("expected one of {}", names.join(", "))
        })
    }
}

/// How to export.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// The target.
    pub target: Target,
    /// What is known of motor and gear.
    pub motor: Motor,
    /// Name of the axis; what is no letter or digit becomes `_`.
    pub name: String,
    /// Time step of the simulator, s.
    pub timestep_s: f64,
}

/// Time step of a simulator unless another is given, s: that of most robots in MuJoCo and Isaac Lab or finer.
pub const DEFAULT_TIMESTEP_S: f64 = 0.001;

/// An exported model.
#[derive(Clone, Debug, PartialEq)]
pub struct Exported {
    /// The file.
    pub text: String,
    /// What became of every parameter of the base and every effect, in the model's order.
    pub rows: Vec<Row>,
    /// Inertia and friction in SI, on both sides of the gear; `None` for a target in the drive's own units.
    pub si: Option<Sides>,
    /// What else is to be known.
    pub remarks: Vec<String>,
}

impl Exported {
    /// Rows of one fate.
    pub fn rows_of(&self, fate: Fate) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(move |row| row.fate == fate)
    }
}

/// Exports a model.
///
/// # Errors
/// [`ExportError`] names what the target needs and is not given.
pub fn export(model: &Model, request: &Request) -> Result<Exported, ExportError> {
    let mut model = model.clone();
    if let Some(radians) = model.units.radians(request.motor.counts_per_turn) {
        // Gravity and eccentricity are laws of an angle in rad.
        model.in_radians(radians);
    }
    let name = identifier(&request.name);
    let write: fn(&Axis) -> Written = match request.target {
        Target::C => {
            let Written { text, rows, remarks } = c::write(&model, &name);
            return Ok(Exported { text, rows, si: None, remarks });
        }
        Target::Mjcf => mjcf::write,
        Target::Urdf => urdf::write,
        Target::Sdf => sdf::write,
        Target::IsaacLab => isaaclab::write,
        Target::Modelica => modelica::write,
    };
    let scale = request.motor.scale(&model.units, request.target)?;
    let axis = Axis::new(&model, scale, name, request.timestep_s);
    let Written { text, rows, remarks } = write(&axis);
    Ok(Exported { text, rows, si: Some(axis.sides()), remarks })
}

/// A name that every target takes: ASCII letters, digits and `_`, and a letter first.
fn identifier(name: &str) -> String {
    let clean: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if clean.starts_with(|c: char| c.is_ascii_alphabetic()) { clean } else { format!("axis_{clean}") }
}

/// A comment of an XML file, in which two hyphens may not stand together.
fn xml_comment(indent: &str, text: &str) -> String {
    format!("{indent}<!-- {} -->", text.replace("--", "- -"))
}

/// A number with ten digits at most, in the shortest form.
fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.9e}").parse().unwrap_or(value);
    format!("{rounded:?}")
}

#[cfg(test)]
mod tests;
