//! `breakaway tune`.

use std::fmt::Write as _;
use std::path::PathBuf;

use anyhow::Context;
use breakaway_core::control::{Compensator, Estimates};
use breakaway_core::plant::Kind;
use schemars::JsonSchema;
use serde::Serialize;

use super::output::Output;
use super::recording_args::{not_negative, positive};
use crate::control::design::{DEFAULT_ADAPTATION_RATE, Design, Request};
use crate::file::{FileKind, Target};
use crate::model::Model;
use crate::recording::Units;

/// Tune a controller from a model: PID gains, compensator, start values of the adaptive law, margins
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:
  breakaway tune model.toml --bandwidth 10 -o controller.toml

The PID is u = b·kv·(lambda1·∫e + lambda2·e + ė). Gains past what tick and delay allow are refused with the largest that
is allowed. The compensator (the model's force along the reference) is written switched off: set `on = true` in the file.

JSON: gains (b, kv, lambda1, lambda2, filter_s, observer_rad_s, and as proportional, integral, derivative), margins (gain,
gain_reduction, phase_deg, delay_s, crossover_rad_s), count (drive of one encoder count, largest, bandwidth_hz up to which
it is within that; absent without an encoder), bandwidth_hz, largest_bandwidth_hz, tick_s, delay_ticks, compensator
(on, lead_s, compensates, leaves_out), adaptive (start, gains, sigma, delta, b_min), units.")]
pub struct Args {
    /// The model
    #[arg(value_name = "M.toml")]
    pub model: PathBuf,
    /// Write the controller to this file; `-` is standard output
    #[arg(short, long, value_name = "C.toml")]
    pub output: Option<Target>,
    /// What is asked for.
    #[command(flatten)]
    pub request: TuneArgs,
}

/// What a controller is asked for; flatten it into a command's arguments.
#[derive(clap::Args, Clone, Debug)]
#[command(next_help_heading = "Tuning")]
pub struct TuneArgs {
    /// Control tick, s
    #[arg(long, value_name = "S", default_value_t = 0.001, value_parser = positive)]
    pub tick: f64,
    /// Open-loop crossover [default: a quarter of the largest]
    #[arg(long, value_name = "HZ", value_parser = positive)]
    pub bandwidth: Option<f64>,
    /// Ticks from reading a position to applying the drive computed from it
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(0..=100))]
    pub delay: u32,
    /// Largest drive, drive units [default: none]
    #[arg(long, value_name = "U", value_parser = positive)]
    pub drive_limit: Option<f64>,
    /// Encoder step, position units
    #[arg(long, value_name = "X", default_value_t = 0.001, value_parser = not_negative)]
    pub encoder_step: f64,
    /// Largest speed of the references, position units/s [default: f1/c, at most f1/b in a second]
    #[arg(long, value_name = "V", value_parser = positive)]
    pub speed: Option<f64>,
    /// Largest acceleration of the references, position units/s² [default: f1/b]
    #[arg(long, value_name = "A", value_parser = positive)]
    pub acceleration: Option<f64>,
    /// How fast the adaptive law adapts, rad/s
    #[arg(long, value_name = "RAD/S", default_value_t = DEFAULT_ADAPTATION_RATE, value_parser = positive)]
    pub adaptation_rate: f64,
}

impl TuneArgs {
    /// The same as the design takes it.
    pub fn request(&self) -> Request {
        Request {
            tick_s: self.tick,
            delay_ticks: self.delay,
            bandwidth_hz: self.bandwidth,
            drive_limit: self.drive_limit.unwrap_or(f64::INFINITY),
            encoder_step: self.encoder_step,
            speed: self.speed,
            acceleration: self.acceleration,
            adaptation_rate: self.adaptation_rate,
        }
    }
}

#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::command) struct Document {
    gains: GainsRow,
    margins: Option<MarginsRow>,
    count: Option<CountRow>,
    bandwidth_hz: f64,
    largest_bandwidth_hz: f64,
    tick_s: f64,
    delay_ticks: u32,
    compensator: CompensatorRow,
    adaptive: AdaptiveRow,
    units: Units,
}

#[derive(Debug, Serialize, JsonSchema)]
struct GainsRow {
    b: f64,
    kv: f64,
    lambda1: f64,
    lambda2: f64,
    filter_s: f64,
    observer_rad_s: f64,
    proportional: f64,
    integral: f64,
    derivative: f64,
}

#[derive(Debug, Serialize, JsonSchema)]
struct MarginsRow {
    gain: f64,
    gain_reduction: f64,
    phase_deg: f64,
    delay_s: f64,
    crossover_rad_s: f64,
}

/// What one count of the encoder makes of the drive.
#[derive(Debug, Serialize, JsonSchema)]
struct CountRow {
    drive: f64,
    largest: f64,
    bandwidth_hz: f64,
}

#[derive(Debug, Serialize, JsonSchema)]
struct CompensatorRow {
    on: bool,
    lead_s: f64,
    compensates: Vec<String>,
    leaves_out: Vec<&'static str>,
}

#[derive(Debug, Serialize, JsonSchema)]
struct Four {
    b: f64,
    c: f64,
    f1: f64,
    f: f64,
}

impl From<Estimates<f64>> for Four {
    fn from(e: Estimates<f64>) -> Self {
        Self { b: e.b, c: e.c, f1: e.f1, f: e.f }
    }
}

#[derive(Debug, Serialize, JsonSchema)]
struct AdaptiveRow {
    start: Four,
    gains: Four,
    sigma: f64,
    delta: f64,
    b_min: f64,
}

impl Args {
    /// Tunes, writes the controller, prints.
    ///
    /// # Errors
    /// A model that cannot be read or tuned for; a file that cannot be written.
    pub fn run(self, output: Output) -> anyhow::Result<()> {
        let targets: Vec<_> = self.output.iter().map(|target| (target, FileKind::Controller)).collect();
        let output = output.claim(&targets, &[&self.model])?;
        let model = Model::read(&self.model)?;
        let request = self.request.request();
        let design = Design::new(&model, &request).with_context(|| self.model.display().to_string())?;
        if let Some(target) = &self.output {
            target.write_text(&design.to_toml())?;
        }
        output.print(&document(&design, &request)?, |document| table(document, &design.model.units))
    }
}

fn document(design: &Design, request: &Request) -> anyhow::Result<Document> {
    let gains = design.gains;
    let k = gains.b * gains.kv;
    let effects = design.model.plant_effects()?;
    let left_out: Vec<&'static str> = Compensator::<f64>::leaves_out(&effects).map(Kind::name).collect();
    let compensates = ["b", "c", "f1"]
        .map(str::to_owned)
        .into_iter()
        .chain(effects.iter().map(|e| e.kind.name().to_owned()).filter(|name| !left_out.contains(&name.as_str())));
    let a = &design.adaptation;
    let margins = design.margins();
    Ok(Document {
        gains: GainsRow {
            b: gains.b,
            kv: gains.kv,
            lambda1: gains.lambda1,
            lambda2: gains.lambda2,
            filter_s: gains.filter_s,
            observer_rad_s: gains.observer_rad_s,
            proportional: k * gains.lambda2,
            integral: k * gains.lambda1,
            derivative: k,
        },
        bandwidth_hz: margins.map_or(f64::NAN, |m| m.crossover_rad_s / std::f64::consts::TAU),
        margins: margins.map(|m| MarginsRow {
            gain: m.gain,
            gain_reduction: m.gain_reduction,
            phase_deg: m.phase_deg,
            delay_s: m.delay_s,
            crossover_rad_s: m.crossover_rad_s,
        }),
        count: (request.encoder_step > 0.0).then(|| CountRow {
            drive: gains.drive_of_count(request.encoder_step, design.tick_s),
            largest: request.resolution(&design.model.base).drive,
            bandwidth_hz: request.encoder_bandwidth_hz(&design.model.base),
        }),
        largest_bandwidth_hz: design.largest_bandwidth_hz(),
        tick_s: design.tick_s,
        delay_ticks: design.delay_ticks,
        compensator: CompensatorRow {
            on: design.compensate,
            lead_s: design.lead_s,
            compensates: compensates.collect(),
            leaves_out: left_out,
        },
        adaptive: AdaptiveRow {
            start: design.start.into(),
            gains: a.gains.into(),
            sigma: a.sigma,
            delta: a.delta,
            b_min: a.b_min,
        },
        units: design.model.units.clone(),
    })
}

/// To hundredths, downwards: what is printed is borne.
fn floor(hz: f64) -> f64 {
    (hz * 100.0).floor() / 100.0
}

fn table(document: &Document, units: &Units) -> String {
    let mut text = String::new();
    let (u, x) = (&units.u, &units.x);
    // Writing to a String cannot fail.
    let g = &document.gains;
    let _ = writeln!(text, "PID, u = b·kv·(lambda1·∫e + lambda2·e + ė):");
    let _ = writeln!(
        text,
        "  kv {:.4} /s   lambda1 {:.4} /s²   lambda2 {:.4} /s   {}",
        g.kv,
        g.lambda1,
        g.lambda2,
        if g.observer_rad_s > 0.0 {
            format!("observer of ė {:.1} rad/s", g.observer_rad_s)
        } else {
            format!("filter of ė {:.3e} s", g.filter_s)
        }
    );
    let _ = writeln!(
        text,
        "  proportional {:.5} {u}/{x}   integral {:.5} {u}/({x}·s)   derivative {:.6} {u}·s/{x}",
        g.proportional, g.integral, g.derivative
    );
    if let Some(m) = &document.margins {
        let _ = writeln!(
            text,
            "margins at a tick of {} s with {} of delay: crossover {:.2} Hz (largest bandwidth {:.2} Hz), phase {:.1}°, gain × {:.2}{}, delay {:.2e} s",
            document.tick_s,
            document.delay_ticks,
            document.bandwidth_hz,
            document.largest_bandwidth_hz,
            m.phase_deg,
            m.gain,
            if m.gain_reduction > 0.0 { format!(" to × {:.2}", m.gain_reduction) } else { String::new() },
            m.delay_s
        );
    }
    if let Some(count) = &document.count {
        let _ = write!(
            text,
            "one encoder count makes {:.3} {u} of drive, of {:.3} {u} at most",
            count.drive, count.largest
        );
        // The default is the largest itself, to a rounding.
        let _ = if count.drive > count.largest * (1.0 + 1e-6) {
            writeln!(
                text,
                ": too much, the drive will be noise; ask for at most --bandwidth {:.2}",
                floor(count.bandwidth_hz)
            )
        } else {
            writeln!(text, " (up to a bandwidth of {:.2} Hz)", count.bandwidth_hz)
        };
    }
    let c = &document.compensator;
    let _ = writeln!(
        text,
        "compensator ({}): {}, {:.2e} s ahead",
        if c.on { "on" } else { "off" },
        c.compensates.join(", "),
        c.lead_s
    );
    for name in &c.leaves_out {
        let _ = writeln!(text, "note: {name} cannot be compensated");
    }
    let a = &document.adaptive;
    let _ = writeln!(
        text,
        "adaptive law: starts at b {:.5e}, c {:.5e}, f1 {:.5e}; gains b {:.2e}, c {:.2e}, f1 {:.2e}, f {:.2e}; delta {:.3e} {x}/s",
        a.start.b, a.start.c, a.start.f1, a.gains.b, a.gains.c, a.gains.f1, a.gains.f, a.delta
    );
    text
}
