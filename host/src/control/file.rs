//! Controller files: what `breakaway tune` writes and `breakaway track` reads. TOML, with the model inside.

use std::fmt::Write as _;
use std::path::Path;

use breakaway_core::control::{Adaptation, Estimates, Gains};
use serde::{Deserialize, Serialize};

use super::ControlError;
use super::design::Design;
use crate::file::read_as;
use crate::file::write_whole;
use crate::mistaken::Content;
use crate::model::Model;

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    controller: Head,
    pid: Pid,
    compensator: Feed,
    adaptive: Adapting,
    model: toml::Table,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum LawName {
    Pid,
    Adaptive,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Head {
    law: LawName,
    tick_s: f64,
    delay_ticks: u32,
    drive_limit: f64,
    rest_band: f64,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Pid {
    b: f64,
    kv: f64,
    lambda1: f64,
    lambda2: f64,
    filter_s: f64,
    /// Not in files of before the observer.
    #[serde(default)]
    observer_rad_s: f64,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Feed {
    on: bool,
    lead_s: f64,
    rest_speed: f64,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Four {
    b: f64,
    c: f64,
    f1: f64,
    f: f64,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Adapting {
    sigma: f64,
    delta: f64,
    b_min: f64,
    pid_inside: bool,
    speed: f64,
    acceleration: f64,
    start: Four,
    gains: Four,
}

impl From<&Four> for Estimates<f64> {
    fn from(four: &Four) -> Self {
        Self { b: four.b, c: four.c, f1: four.f1, f: four.f }
    }
}

impl Design {
    /// Reads a controller file.
    ///
    /// # Errors
    /// [`ControlError`], with file and line.
    pub fn read(path: &Path) -> Result<Self, ControlError> {
        read_as(path, Content::Controller, Self::parse)
    }

    /// Reads a controller from text; `file` is its name in messages.
    ///
    /// # Errors
    /// [`ControlError`], with file and line.
    pub fn parse(file: &str, text: &str) -> Result<Self, ControlError> {
        let malformed = |reason: String| ControlError::Malformed { file: file.to_owned(), reason };
        let document: Document =
            toml::from_str(text).map_err(|error| malformed(error.to_string().trim_end().to_owned()))?;
        let model = toml::to_string(&document.model).map_err(|error| malformed(error.to_string()))?;
        let model = Model::parse("its [model]", &model).map_err(|error| malformed(error.to_string()))?;
        let Head { law, tick_s, delay_ticks, drive_limit, rest_band } = document.controller;
        let Pid { b, kv, lambda1, lambda2, filter_s, observer_rad_s } = document.pid;
        let Feed { on, lead_s, rest_speed } = document.compensator;
        let a = document.adaptive;
        let design = Self {
            tick_s,
            delay_ticks,
            drive_limit,
            rest_band,
            gains: Gains { b, kv, lambda1, lambda2, filter_s, observer_rad_s },
            lead_s,
            rest_speed,
            compensate: on,
            start: (&a.start).into(),
            adaptation: Adaptation {
                gains: (&a.gains).into(),
                sigma: a.sigma,
                delta: a.delta,
                b_min: a.b_min,
                pid_inside: a.pid_inside,
                speed: a.speed,
                acceleration: a.acceleration,
            },
            adaptive: matches!(law, LawName::Adaptive),
            model,
        };
        design.controller::<f64>().map_err(|error| malformed(error.to_string()))?;
        Ok(design)
    }

    /// Writes the controller, whole or not at all.
    ///
    /// # Errors
    /// What the file system reports; a file already there is then untouched.
    pub fn write(&self, path: &Path) -> std::io::Result<()> {
        write_whole(path, |out| out.write_all(self.to_toml().as_bytes()))
    }

    /// The controller as TOML, with units beside the numbers; numbers have the fewest digits that give the same bits back.
    pub fn to_toml(&self) -> String {
        let mut out = String::new();
        let (u, x) = (&self.model.units.u, &self.model.units.x);
        let mut line = |text: String| {
            // Writing to a String cannot fail.
            let _ = writeln!(out, "{text}");
        };
        line(format!("# Tuned by breakaway {}.", env!("CARGO_PKG_VERSION")));
        if let Some(m) = self.margins() {
            line(format!(
                "# Crossover {:.2} Hz; phase margin {:.1}°, gain margin {:.2} (down {:.2}), delay margin {:.2e} s.",
                m.crossover_rad_s / std::f64::consts::TAU,
                m.phase_deg,
                m.gain,
                m.gain_reduction,
                m.delay_s
            ));
        }
        line("\n[controller]".into());
        line(format!("law = \"{}\"  # pid or adaptive", if self.adaptive { "adaptive" } else { "pid" }));
        line(format!("tick_s = {:?}", self.tick_s));
        line(format!("delay_ticks = {}  # from reading to drive", self.delay_ticks));
        line(format!("drive_limit = {:?}  # {u}", self.drive_limit));
        line(format!("rest_band = {:?}  # {x}: at rest, the integral rests within it", self.rest_band));
        let Gains { b, kv, lambda1, lambda2, filter_s, observer_rad_s } = self.gains;
        line("\n[pid]\n# u = b·kv·(lambda1·∫e + lambda2·e + ė)".into());
        line(format!("b = {b:?}  # {}", self.model.units.of_b()));
        line(format!("kv = {kv:?}  # 1/s\nlambda1 = {lambda1:?}  # 1/s²\nlambda2 = {lambda2:?}  # 1/s"));
        line(format!("filter_s = {filter_s:?}  # of ė\nobserver_rad_s = {observer_rad_s:?}  # of ė; 0 for none"));
        line("\n[compensator]\n# Feed-forward of the model below, along the reference".into());
        line(format!(
            "on = {}\nlead_s = {:?}\nrest_speed = {:?}  # {x}/s",
            self.compensate, self.lead_s, self.rest_speed
        ));
        let Adaptation { gains, sigma, delta, b_min, pid_inside, speed, acceleration } = self.adaptation;
        line("\n[adaptive]".into());
        line(format!("sigma = {sigma:?}  # leak of f\ndelta = {delta:?}  # {x}/s: nothing adapts within it"));
        line(format!("b_min = {b_min:?}\npid_inside = {pid_inside}"));
        line(format!("speed = {speed:?}  # {x}/s, the largest expected\nacceleration = {acceleration:?}  # {x}/s²"));
        for (name, four) in [("start", self.start), ("gains", gains)] {
            let Estimates { b, c, f1, f } = four;
            line(format!("\n[adaptive.{name}]\nb = {b:?}\nc = {c:?}\nf1 = {f1:?}\nf = {f:?}"));
        }
        line(String::new());
        for text in self.model.to_toml().lines() {
            line(match text {
                "[base]" | "[base.se]" | "[units]" => text.replacen('[', "[model.", 1),
                "[[effect]]" => "[[model.effect]]".into(),
                "[effect.se]" => "[model.effect.se]".into(),
                other => other.into(),
            });
        }
        out
    }
}
