//! Experiments on the board: from an experiment's file to the board's commands, and its samples to a recording.

mod commands;
mod feed;
mod follow;
mod record;
mod tracking;
mod waveform;

use std::io;
use std::time::{Duration, Instant};

use breakaway_core::link::{Command, Ended, Ending, Event, Info, Message, Mode, Reply, Settings};

pub use commands::commands;
pub use follow::{FollowRun, FollowTotals};
use record::Record;
pub use tracking::{Followed, TrackRun, adaptive, pid};

use super::scale::{Scale, amperes};
use super::{Client, DeviceError, text};
use crate::interrupt::FinishFirst;
use crate::recording::Recording;
use crate::simulate::axis::Run;
use crate::simulate::experiment::{self, Excitation, Experiment};

/// Longest silence of a board that is running an experiment.
const SILENCE: Duration = Duration::from_secs(3);
/// How long samples may lag behind the event that ended the experiment.
const LAG: Duration = Duration::from_secs(1);

/// What came of an experiment on the board.
#[derive(Debug)]
pub struct Outcome {
    /// What was recorded; also when it ended early.
    pub run: Run,
    /// The experiment as it was run: the board's tick, step and hysteresis.
    pub experiment: Experiment,
    /// How the board says it ended; `None` if the end was not seen.
    pub ended: Option<Ended>,
    /// Samples missing between the first and the last of the experiment.
    pub missing: u64,
    /// Why it is not complete.
    pub error: Option<DeviceError>,
}

/// A board on which experiments are run.
pub struct Runner {
    client: Client,
    info: Info,
    /// What its integers are.
    pub scale: Scale,
    /// Its settings.
    pub settings: Settings,
}

impl Runner {
    /// Connects to an idle board.
    ///
    /// # Errors
    /// Whatever connecting reports; a latched fault; a board that is doing something else.
    pub fn connect(port: &str, baud: u32) -> Result<Self, DeviceError> {
        let (mut client, info) = Client::connect_alone(port, baud)?;
        let scale = Scale::new(&info)?;
        let Reply::Settings(settings) = client.request(Command::GetSettings)? else {
            return Err(DeviceError::Nonsense { command: "settings get" });
        };
        Ok(Self { client, info, scale, settings })
    }

    /// Who the board is.
    pub fn info(&self) -> &Info {
        &self.info
    }

    /// Shares the port ([`Client::offer`]).
    ///
    /// # Errors
    /// As there.
    pub fn offer(&mut self) -> io::Result<()> {
        self.client.offer()
    }

    /// Runs an experiment to its end.
    ///
    /// # Errors
    /// Nothing was recorded: the experiment does not fit the board, or the board does not start it. What goes wrong
    /// later is in [`Outcome::error`], beside what was recorded until then.
    pub fn run(&mut self, experiment: &Experiment, interrupt: &FinishFirst) -> Result<Outcome, DeviceError> {
        experiment.check()?;
        let commands = commands(experiment, &self.scale)?;
        let (record, error) = self.record(commands, interrupt)?;
        Ok(self.outcome(experiment, &record, error))
    }

    /// Carries out the commands, the last of which starts a run, and records it to its end, or until what went wrong.
    ///
    /// # Errors
    /// Nothing was recorded.
    fn record(
        &mut self,
        commands: Vec<Command>,
        interrupt: &FinishFirst,
    ) -> Result<(Record, Option<DeviceError>), DeviceError> {
        match self.client.status()?.mode {
            Mode::Idle => {}
            Mode::Fault => return Err(self.latched()),
            mode => return Err(DeviceError::NotIdle(mode.name())),
        }
        self.client.done(Command::StreamOn { decimation: 1 })?;
        let mut record = Record::default();
        let error = self.until_ended(commands, &mut record, interrupt).err();
        if error.as_ref().is_some_and(|error| !matches!(error, DeviceError::Unplugged { .. })) {
            // The board is told to stop on every way out; what went wrong before is what is reported.
            let _ = self.client.done(Command::Stop);
        }
        if !matches!(error, Some(DeviceError::Unplugged { .. })) {
            let _ = self.client.done(Command::StreamOff);
        }
        if record.rows.is_empty()
            && let Some(error) = error
        {
            return Err(error);
        }
        Ok((record, error))
    }

    /// The fault that is latched, as an error.
    fn latched(&mut self) -> DeviceError {
        match self.client.request(Command::GetFault) {
            Ok(Reply::Fault(Some(record))) => DeviceError::Fault(text::fault(&record)),
            Ok(_) => DeviceError::Nonsense { command: "fault" },
            Err(error) => error,
        }
    }

    fn until_ended(
        &mut self,
        commands: Vec<Command>,
        record: &mut Record,
        interrupt: &FinishFirst,
    ) -> Result<(), DeviceError> {
        for command in commands {
            self.client.done(command)?;
        }
        let (mut heard, mut ended_at) = (Instant::now(), None);
        loop {
            if interrupt.requested() {
                return Err(DeviceError::Interrupted);
            }
            let message = self.client.receive(Duration::from_millis(20))?;
            if message.is_some() {
                heard = Instant::now();
            } else if heard.elapsed() > SILENCE {
                let seconds = SILENCE.as_secs_f64();
                return Err(DeviceError::Silent { port: self.client.port().to_owned(), command: "status", seconds });
            }
            match message {
                Some(Message::Samples(batch)) => {
                    let port = self.client.port();
                    record.take(&batch).map_err(|()| DeviceError::Restarted { port: port.to_owned() })?;
                }
                Some(Message::Event(Event::ExperimentEnded(ended))) => {
                    record.ended = Some(ended);
                    ended_at = Some(Instant::now());
                }
                Some(Message::Event(Event::FaultRaised(fault))) => record.fault = Some(text::fault(&fault)),
                Some(Message::Event(Event::ModelMismatch(mismatch))) => record.mismatches.push(mismatch),
                Some(Message::Event(Event::Started)) => {
                    return Err(DeviceError::Restarted { port: self.client.port().to_owned() });
                }
                _ => {}
            }
            let Some(since) = ended_at else { continue };
            if record.past_the_end || since.elapsed() > LAG {
                return match (record.fault.take(), record.ended.map(|ended| ended.ending)) {
                    (Some(fault), _) => Err(DeviceError::Fault(fault)),
                    (None, Some(Ending::Fault(cause))) => Err(DeviceError::Fault(text::cause_name(cause).to_owned())),
                    (None, Some(Ending::Stopped)) => Err(DeviceError::Ended("the experiment was stopped".to_owned())),
                    _ => Ok(()),
                };
            }
        }
    }

    fn outcome(&self, experiment: &Experiment, record: &Record, error: Option<DeviceError>) -> Outcome {
        let (recording, missing) = self.recording(&experiment.name, record, error.as_ref());
        let start = recording.x.first().copied().unwrap_or(0.0);
        let tripped = match record.ended.map(|ended| ended.ending) {
            Some(Ending::Limit { .. }) => Some(recording.x.last().copied().unwrap_or(0.0) - start),
            _ => None,
        };
        Outcome {
            run: Run { recording, true_x: Vec::new(), start, tripped },
            experiment: self.as_run(experiment),
            ended: record.ended,
            missing,
            error,
        }
    }

    /// The samples as a recording, and how many are missing in it.
    fn recording(&self, name: &str, record: &Record, error: Option<&DeviceError>) -> (Recording, u64) {
        let scale = &self.scale;
        let mut recording = Recording {
            name: name.to_owned(),
            encoder_step: Some(scale.step),
            units: scale.units.clone(),
            ..Recording::default()
        };
        for row in &record.rows {
            if row.missing > 0 && !recording.t.is_empty() {
                recording.gaps.push(recording.t.len());
            }
            recording.t.push(scale.time(row.tick));
            recording.u.push(scale.drive(row.drive_code.into()));
            recording.x.push(scale.position(row.count));
            recording.current.extend(row.current_ma.map(amperes));
        }
        // A row without its current: there is none of the recording.
        if recording.current.len() != recording.t.len() {
            recording.current.clear();
        }
        recording.meta.insert("experiment".into(), name.to_owned());
        for line in super::capture::provenance(&self.info) {
            if let Some((key, value)) = line.split_once(": ") {
                recording.meta.insert(key.into(), value.into());
            }
        }
        let ended = match (error, record.ended) {
            (Some(error), _) => error.to_string(),
            (None, Some(ended)) => text::ending(ended.ending, scale, &self.settings),
            (None, None) => "unknown".to_owned(),
        };
        recording.meta.insert("ended".into(), ended);
        // What is missing before the first sample is not of the experiment.
        let missing: u64 = record.rows.iter().skip(1).map(|row| row.missing).sum();
        if missing > 0 {
            recording.meta.insert("samples missing".into(), missing.to_string());
        }
        (recording, missing)
    }

    /// The experiment with what the board made of it.
    fn as_run(&self, experiment: &Experiment) -> Experiment {
        let mut run = experiment.clone();
        run.tick_s = self.scale.tick_s();
        run.sensor = experiment::Sensor { encoder_step: self.scale.step, noise: 0.0, delay_ticks: 0 };
        if let Excitation::Relay { hysteresis, .. } = &mut run.excitation {
            *hysteresis.get_or_insert(0.0) =
                hysteresis.unwrap_or(f64::from(self.settings.hysteresis_counts) * self.scale.step);
        }
        run
    }
}

#[cfg(test)]
mod tests;
