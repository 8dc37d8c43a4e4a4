//! `breakaway export`.

use std::path::PathBuf;

use serde::Serialize;

use super::output::Output;
use super::recording_args::positive;
use crate::export::{self, DEFAULT_TIMESTEP_S, DriveKind, Exported, Fate, Motor, Request, Row, Side, Sides};
use crate::file::{FileKind, Target};
use crate::model::Model;
use crate::models::{self, CardError};

/// Write a model for MuJoCo, URDF, SDF, Isaac Lab, Modelica or C, with what is lost
#[derive(clap::Args, Debug)]
#[command(after_help = "Examples:
  breakaway export model.toml --to c -o axis.h
  breakaway export model.toml --to mjcf --motor-constant 0.05 --resistance 2 --gear 10 -o axis.xml
  breakaway export model.toml --to urdf --drive-gain 35.15 -o axis.urdf

All targets but c are in SI units at the load. A drive in V needs --motor-constant and --resistance, in A
--motor-constant, as a duty --supply as well. A drive in N·m or N needs nothing. --drive-gain stands for all of them.
A card of the motor library may hold them: --motor emps.

Each effect is kept, approximated or lost; the file says which, at its top and beside its lines.

JSON: version, target, output (null without -o), text (without -o), parts (what, law, fate: kept, approximated or lost,
how), lost (names), si (load and motor: inertia, viscous, coulomb; force_per_drive, gear, linear; null for c), remarks
(kind, text).")]
pub struct Args {
    /// The model
    #[arg(value_name = "M.toml")]
    pub model: PathBuf,
    /// Format: mjcf, urdf, sdf, isaaclab, modelica or c
    #[arg(long, value_name = "TARGET")]
    pub to: export::Target,
    /// Write to this file; `-` is standard output [default: standard output]
    #[arg(short, long, value_name = "F")]
    pub output: Option<Target>,
    /// Name of the axis in the file [default: that of the model's file]
    #[arg(long)]
    pub name: Option<String>,
    /// Time step of the simulator, s: for delays, and for how stiff friction may be
    #[arg(long, value_name = "S", default_value_t = DEFAULT_TIMESTEP_S, value_parser = positive)]
    pub timestep: f64,
    /// Motor and gear.
    #[command(flatten)]
    pub motor: MotorArgs,
}

/// What is known of motor and gear; flatten it into a command's arguments.
#[derive(clap::Args, Clone, Debug, Default)]
#[command(next_help_heading = "Motor and gear")]
pub struct MotorArgs {
    /// Torque constant, N·m/A; of a linear motor N/A
    #[arg(long, value_name = "KT", value_parser = positive)]
    pub motor_constant: Option<f64>,
    /// Resistance of the winding, Ω
    #[arg(long, value_name = "OHM", value_parser = positive)]
    pub resistance: Option<f64>,
    /// Voltage of the supply, V, for a drive that is a duty
    #[arg(long, value_name = "V", value_parser = positive)]
    pub supply: Option<f64>,
    /// A card of the motor library, by name or path, for what is not given here
    #[arg(long, value_name = "CARD")]
    pub motor: Option<String>,
    /// Turns of the motor per turn of the load; of a linear axis rad per m [default: 1]
    #[arg(long, value_name = "N", value_parser = positive)]
    pub gear: Option<f64>,
    /// Force at the load per drive unit, N·m or N, in place of the motor's constants
    #[arg(long, value_name = "F", value_parser = positive)]
    pub drive_gain: Option<f64>,
    /// What the drive is: voltage, current, duty, or effort at the load [default: what its unit says]
    #[arg(long, value_name = "KIND")]
    pub drive: Option<DriveKind>,
    /// Where the position was measured: load or motor [default: load]
    #[arg(long, value_name = "SIDE")]
    pub encoder: Option<Side>,
    /// Position units per turn, if the position is in counts
    #[arg(long, value_name = "N", value_parser = positive)]
    pub counts_per_turn: Option<f64>,
}

impl MotorArgs {
    /// The same as the export takes it, with what the card has.
    ///
    /// # Errors
    /// There is no such card.
    pub fn motor(&self) -> Result<Motor, CardError> {
        let given = Motor {
            drive: self.drive,
            motor_constant: self.motor_constant,
            resistance: self.resistance,
            supply: self.supply,
            gear: self.gear,
            drive_gain: self.drive_gain,
            encoder: self.encoder.unwrap_or_default(),
            counts_per_turn: self.counts_per_turn,
        };
        match &self.motor {
            Some(name) => Ok(models::card(name)?.motor.beside(&given)),
            None => Ok(given),
        }
    }
}

/// The JSON document.
#[derive(Debug, Serialize, schemars::JsonSchema)]
pub struct Document<'a> {
    version: &'static str,
    target: &'static str,
    output: Option<String>,
    text: Option<&'a str>,
    parts: &'a [Row],
    lost: Vec<&'a str>,
    si: Option<Sides>,
    remarks: Vec<Remark<'a>>,
}

#[derive(Debug, Serialize, schemars::JsonSchema)]
struct Remark<'a> {
    kind: &'static str,
    text: &'a str,
}

impl<'a> Document<'a> {
    /// The document of a model that was written to `output`, or that it holds itself.
    pub fn new(exported: &'a Exported, target: export::Target, output: Option<&Target>) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            target: target.name(),
            output: output.map(ToString::to_string),
            text: output.is_none().then_some(exported.text.as_str()),
            parts: &exported.rows,
            lost: exported.rows_of(Fate::Lost).map(|row| row.what.as_str()).collect(),
            si: exported.si,
            remarks: exported.remarks.iter().map(|text| Remark { kind: "motor", text }).collect(),
        }
    }
}

impl Args {
    /// Exports, writes, and says what is lost.
    ///
    /// # Errors
    /// A model that cannot be read; constants that are missing; a file that cannot be written.
    pub fn run(self, output: Output) -> anyhow::Result<()> {
        let standard = self.output.is_none() && !output.json;
        let target = self.output.clone().or(standard.then_some(Target::Standard));
        let targets: Vec<_> = target.iter().map(|target| (target, FileKind::Export)).collect();
        let output = output.claim(&targets, &[&self.model])?;
        let model = Model::read(&self.model)?;
        let stem = self.model.file_stem().map_or_else(|| "axis".to_owned(), |stem| stem.to_string_lossy().into_owned());
        let request = Request {
            target: self.to,
            motor: self.motor.motor()?,
            name: self.name.unwrap_or(stem),
            timestep_s: self.timestep,
        };
        let exported = export::export(&model, &request)?;
        if let Some(target) = &target {
            target.write_text(&exported.text)?;
        }
        let document = Document::new(&exported, self.to, target.as_ref());
        output.print(&document, |document| said(&exported, document.output.as_deref()))
    }
}

/// What became of the parts, for people.
fn said(exported: &Exported, to: Option<&str>) -> String {
    let mut lines: Vec<String> = to.map(|to| format!("written to {to}")).into_iter().collect();
    for (fate, name) in [(Fate::Kept, "kept"), (Fate::Approximated, "approximated"), (Fate::Lost, "LOST")] {
        lines.extend(exported.rows_of(fate).map(|row| format!("  {name:<13}{:<22}{}", row.what, row.how)));
    }
    if let Some(sides) = &exported.si {
        let (inertia, force) = if sides.linear { ("kg", "N") } else { ("kg·m²", "N·m") };
        lines.push(format!(
            "at the load: inertia {:.4e} {inertia}, Coulomb friction {:.4e} {force}; 1 drive unit is {:.4e} {force}",
            sides.load.inertia, sides.load.coulomb, sides.force_per_drive
        ));
    }
    lines.extend(exported.remarks.iter().map(|remark| format!("note: {remark}")));
    lines.join("\n")
}
