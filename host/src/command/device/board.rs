//! What `breakaway device` asks of a board, and how the answers are printed.

use std::fmt::Write as _;

use breakaway_core::link::{Command, FaultRecord, Identified, Reply, Settings};

use super::check;
use super::documents::{self, Done, Fault, Info, Status};
use crate::command::UsageError;
use crate::command::output::Output;
use crate::device::scale::Scale;
use crate::device::{Client, DeviceError, model, settings, text};
use crate::file::Target;
use crate::model::Model;

/// A board, and where its answers are printed.
pub struct Board {
    /// The connection.
    pub client: Client,
    /// Who it is.
    pub info: breakaway_core::link::Info,
    /// What its integers are.
    pub scale: Scale,
    /// Text or JSON.
    pub output: Output,
}

impl Board {
    pub fn done(&mut self, command: Command, text: &'static str) -> anyhow::Result<()> {
        self.client.done(command)?;
        self.output.print(&Done { done: text }, |done| done.done.to_owned())
    }

    pub fn info(&self) -> anyhow::Result<()> {
        let Self { info, scale, .. } = self;
        let document = Info::new(info, scale);
        self.output.print(&document, |_| {
            let breakaway_core::link::Info { board, firmware, build, protocol_version, tick_hz, counts_per_revolution, .. } = info;
            format!(
                "board       {board}\nfirmware    {firmware} ({build}), link version {protocol_version}\ntick        \
                 {tick_hz} Hz\nposition    {step:e} {x} per count, {counts_per_revolution} counts per revolution\ndrive       \
                 {full} {u} at full scale{current}",
                step = scale.step,
                x = scale.units.x,
                full = scale.drive_max(),
                u = scale.units.u,
                current = match info.current_range_ma {
                    0 => "\ncurrent     not measured".to_owned(),
                    range => format!("\ncurrent     measured to {range} mA either way"),
                },
            )
        })
    }

    pub fn status(&mut self) -> anyhow::Result<()> {
        let status = self.client.status()?;
        let document = Status::new(&status, &self.scale);
        let Status { position, drive, .. } = document;
        let units = &self.scale.units;
        self.output.print(&document, |_| {
            format!(
                "mode        {}\nposition    {position:.6} {}\ndrive       {drive:.4} {}\ntick        {}\nstream      {}\n\
                 dropped     {} samples\ndamaged     {} frames\nlate        {} ticks\nunsaved     {}\nzero        {}",
                status.mode.name(),
                units.x,
                units.u,
                status.tick,
                if status.decimation == 0 { "off".to_owned() } else { format!("every {}. sample", status.decimation) },
                status.dropped,
                status.bad_frames,
                status.overruns,
                if status.unsaved { "settings or model changed since they were saved" } else { "nothing" },
                if status.zero_needed { "needed: the travel limits count from one" } else { "not needed" },
            )
        })
    }

    pub(super) fn read_settings(&mut self) -> Result<Settings, DeviceError> {
        match self.client.request(Command::GetSettings)? {
            Reply::Settings(settings) => Ok(settings),
            _ => Err(DeviceError::Nonsense { command: "settings get" }),
        }
    }

    pub fn settings_get(&mut self, names: &[String]) -> anyhow::Result<()> {
        let list = settings::list(&self.read_settings()?);
        for name in names {
            if !list.iter().any(|(known, _)| known == name) {
                let near = crate::nearest::nearest(name, list.iter().map(|(known, _)| known.as_str()));
                let hint = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
                return Err(UsageError(format!("there is no setting `{name}`{hint}")).into());
            }
        }
        let chosen: Vec<_> = list.into_iter().filter(|(name, _)| names.is_empty() || names.contains(name)).collect();
        let document = documents::Settings(chosen.iter().cloned().collect());
        self.output.print(&document, |_| {
            chosen.iter().fold(String::new(), |mut text, (name, value)| {
                let value = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
                let _ = writeln!(text, "{name} = {value}");
                text
            })
        })
    }

    pub fn settings_set(&mut self, assignments: &[String], save: bool) -> anyhow::Result<()> {
        let mut settings = self.read_settings()?;
        check(&mut settings, assignments)?;
        settings.validate().map_err(|field| {
            UsageError(format!("{} is out of range: it must be {}; no setting was changed", field.name(), field.need()))
        })?;
        self.client.done(Command::SetSettings(settings))?;
        if save {
            self.client.done(Command::Save)?;
            return self.output.print(&Done { done: "set and saved" }, |done| done.done.to_owned());
        }
        self.output.print(&Done { done: "set; `save` keeps it across resets" }, |done| done.done.to_owned())
    }

    pub fn fault(&mut self) -> anyhow::Result<()> {
        let Reply::Fault(record) = self.client.request(Command::GetFault)? else {
            return Err(DeviceError::Nonsense { command: "fault" }.into());
        };
        self.output.print(&Fault::new(record.as_ref(), &self.scale), |_| match record {
            None => "no fault".to_owned(),
            Some(record) => {
                let FaultRecord { mode, tick, count, drive_code, .. } = record;
                format!(
                    "{}: {}\nat tick {tick} ({:.4} s) in mode {}, position {:.6} {}, drive {:.4} {}",
                    text::cause_name(record.cause),
                    text::fault(&record),
                    self.scale.time(tick.into()),
                    mode.name(),
                    self.scale.position(count),
                    self.scale.units.x,
                    self.scale.drive(drive_code.into()),
                    self.scale.units.u,
                )
            }
        })
    }

    pub fn model_load(&mut self, model: &Model, save: bool) -> anyhow::Result<()> {
        let wire = model::to_wire(model, &self.scale)?;
        self.client.done(Command::LoadModel(wire))?;
        if save {
            self.client.done(Command::Save)?;
            return self.output.print(&Done { done: "loaded and saved" }, |done| done.done.to_owned());
        }
        self.output.print(&Done { done: "loaded; `save` keeps it across resets" }, |done| done.done.to_owned())
    }

    pub fn model_get(&mut self, file: Option<&Target>) -> anyhow::Result<()> {
        let wire = match self.client.request(Command::GetModel)? {
            Reply::Model(Some(wire)) => wire,
            Reply::Model(None) => return Err(anyhow::anyhow!("no model is loaded on the board")),
            _ => return Err(DeviceError::Nonsense { command: "model get" }.into()),
        };
        let model = model::from_wire(&wire, &self.info, &self.scale)?;
        if let Some(file) = file {
            file.write_text(&model.to_toml())?;
        }
        self.output.print(&documents::Model::from(&model), |_| match file {
            Some(file) => format!("written to {file}"),
            None => model.to_toml(),
        })
    }

    pub fn identify(&mut self) -> anyhow::Result<()> {
        let Reply::Identified(found) = self.client.request(Command::Identify)? else {
            return Err(DeviceError::Nonsense { command: "identify" }.into());
        };
        let units = &self.scale.units;
        let rows = [("b", found.b, units.of_b()), ("c", found.c, units.of_c()), ("f1", found.f1, units.of_f1())];
        if let Some(advice) = found.verdict.advice() {
            return Err(anyhow::anyhow!("the board cannot identify from what it has: {advice}"));
        }
        let document = documents::Identified::new(&found, &self.scale);
        let Identified { windows, residual, sine, .. } = found;
        self.output.print(&document, |_| {
            let mut text = String::from("identified on the board\n");
            for (name, estimate, unit) in rows {
                let _ = writeln!(text, "  {name:<4}{:>12.6} ± {:<10.2e} {unit}", estimate.value, estimate.se);
            }
            let _ = writeln!(text, "  from {windows} windows, residual {residual:.2e} {}", units.u);
            if let Some(sine) = sine {
                let _ = writeln!(
                    text,
                    "  last cycle: amplitude {:.6} ± {:.1e} {x}, ω {:.5} ± {:.1e} rad/s, {:.1} periods",
                    sine.amplitude.value,
                    sine.amplitude.se,
                    sine.omega.value,
                    sine.omega.se,
                    sine.cycles,
                    x = units.x
                );
            }
            text
        })
    }
}
