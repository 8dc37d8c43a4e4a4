//! Experiments on the board: from an experiment's file to the board's commands, and its samples to a recording.

mod tracking;
mod waveform;

use std::time::{Duration, Instant};

use breakaway_core::excite::waveform::Shape;
use breakaway_core::link::{
    Bounds, Command, ControllerGains, Ended, Ending, ErrorRate, Event, Info, Message, Mismatch, Mode, OpenLoop, Pid,
    Reference, Relay, Reply, Settings, Track, Trajectory,
};

pub use tracking::{Followed, TrackRun, adaptive, pid};

use super::scale::Scale;
use super::stream::{Row, Stream};
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
        let (mut client, info) = Client::connect(port, baud)?;
        let scale = Scale::new(&info)?;
        let Reply::Settings(settings) = client.request(Command::GetSettings)? else {
            return Err(DeviceError::Nonsense { command: "settings get" });
        };
        Ok(Self { client, info, scale, settings })
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

/// The samples of one experiment.
#[derive(Default)]
struct Record {
    stream: Stream,
    rows: Vec<Row>,
    ended: Option<Ended>,
    fault: Option<String>,
    mismatches: Vec<Mismatch>,
    /// A sample from after the end has come: there are no more of the experiment.
    past_the_end: bool,
}

impl Record {
    fn take(&mut self, batch: &breakaway_core::link::Batch) -> Result<(), ()> {
        let mut rows = Vec::new();
        let taken = self.stream.take(batch, &mut rows);
        for row in rows {
            if matches!(row.mode, Mode::Idle | Mode::Fault | Mode::Hold) {
                self.past_the_end |= !self.rows.is_empty();
            } else if !self.past_the_end {
                self.rows.push(row);
            }
        }
        taken.map_err(|_| ())
    }
}

/// The commands that start an experiment on the board.
///
/// # Errors
/// [`DeviceError::Range`] names the field that the board cannot do.
pub fn commands(experiment: &Experiment, scale: &Scale) -> Result<Vec<Command>, DeviceError> {
    let bounds = Bounds {
        max_ticks: scale.ticks("duration_s", experiment.duration_s)?,
        drive_max_code: match experiment.drive_limit {
            limit if limit >= scale.drive_max() => 0,
            limit => scale.code("drive_limit", limit)?,
        },
        travel_counts: match experiment.travel_limit {
            f64::INFINITY => 0,
            limit => scale.counts("travel_limit", limit)?.max(1),
        },
    };
    let centring = |centring: f64| {
        let q16 = (centring * scale.step / scale.drive(1) * 65_536.0).round();
        if q16 <= f64::from(i32::MAX) {
            Ok(q16 as i32)
        } else {
            Err(DeviceError::Range { what: "excitation.centring", value: centring, need: "less".to_owned() })
        }
    };
    let start = match experiment.excitation {
        Excitation::Relay { h1, h2, hysteresis, reference } => {
            let total = scale.drive_max();
            if h1 + h2 > total {
                let need = format!("h1 + h2 is at most {total} {}", scale.units.u);
                return Err(DeviceError::Range { what: "excitation.h1 + h2", value: h1 + h2, need });
            }
            let hysteresis =
                hysteresis.map(|band| scale.counts("excitation.hysteresis", (band / scale.step).ceil() * scale.step));
            let h1_code = scale.code("excitation.h1", h1)?;
            // Both rounded up can be one code more than there is.
            let h2_code = scale.code("excitation.h2", h2)?.min(i16::MAX - h1_code);
            Command::StartRelay(Relay {
                h1_code,
                h2_code,
                hysteresis_counts: hysteresis.transpose()?,
                reference: moving(reference, scale)?,
                until_settled: false,
                append: false,
                bounds,
            })
        }
        Excitation::Multisine { amplitude, from_hz, to_hz, centring: pull } => {
            let (parts, period_s) = waveform::multisine(from_hz, to_hz, experiment.seed)?;
            let start = Command::StartDrive(OpenLoop {
                shape: Shape::Table,
                amplitude_code: scale.code("excitation.amplitude", amplitude)?,
                phase_step: scale.phase_step("1/excitation.from_hz", period_s)?,
                centring_q16: centring(pull)?,
                bounds,
            });
            return Ok(parts.into_iter().map(Command::LoadWaveform).chain([start]).collect());
        }
        Excitation::Sine { amplitude, frequency_hz, centring: pull } => Command::StartDrive(OpenLoop {
            shape: Shape::Sine,
            amplitude_code: scale.code("excitation.amplitude", amplitude)?,
            phase_step: scale.phase_step("1/excitation.frequency_hz", 1.0 / frequency_hz)?,
            centring_q16: centring(pull)?,
            bounds,
        }),
        Excitation::Ramp { amplitude, period_s, centring: pull } => Command::StartDrive(OpenLoop {
            shape: Shape::Ramp,
            amplitude_code: scale.code("excitation.amplitude", amplitude)?,
            phase_step: scale.phase_step("excitation.period_s", 2.0 * period_s)?,
            centring_q16: centring(pull)?,
            bounds,
        }),
        Excitation::Track { kp, kd, reference } => Command::StartTrack(Track {
            trajectory: trajectory(reference),
            controller: ControllerGains::Pid(Pid {
                kp: kp as f32,
                ki: 0.0,
                kd: kd as f32,
                error_rate: ErrorRate { filter_s: filter_s(kp, kd, scale.tick_s()) as f32, observer_rad_s: 0.0 },
            }),
            feed_forward: false,
            compensation: false,
            bounds,
        }),
    };
    start.validate().map_err(|error| DeviceError::Refused { command: text::command_name(&start), error })?;
    Ok(vec![start])
}

fn moving(reference: experiment::Reference, scale: &Scale) -> Result<Reference, DeviceError> {
    let (shape, amplitude, period_s) = match reference {
        experiment::Reference::Start => return Ok(Reference::default()),
        experiment::Reference::Triangle { amplitude, period_s } => (Shape::Triangle, amplitude, period_s),
        experiment::Reference::Sine { amplitude, period_s } => (Shape::Sine, amplitude, period_s),
    };
    Ok(Reference {
        shape,
        amplitude_counts: scale.counts("reference.amplitude", amplitude)? as i32,
        phase_step: scale.phase_step("reference.period_s", period_s)?,
    })
}

fn trajectory(reference: experiment::Reference) -> Trajectory {
    match reference {
        experiment::Reference::Start => Trajectory::Hold,
        experiment::Reference::Triangle { amplitude, period_s } => {
            Trajectory::Triangle { amplitude: amplitude as f32, period_s: period_s as f32 }
        }
        experiment::Reference::Sine { amplitude, period_s } => {
            Trajectory::Sine { amplitude: amplitude as f32, period_s: period_s as f32 }
        }
    }
}

/// Filter of ė for a loop with these gains, s. It is an eighth of 1/ωc, as in `tune`, and the zero kp/kd is at ωc/2.
/// It is at least two ticks, because a count is coarse.
fn filter_s(kp: f64, kd: f64, tick_s: f64) -> f64 {
    let eighth = if kp > 0.0 { kd / (16.0 * kp) } else { 0.0 };
    eighth.max(2.0 * tick_s)
}

#[cfg(test)]
mod tests;
