//! What the monitor knows of the board.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use breakaway_core::link::{Event, FaultRecord, Info, Message, Mode, Reply, Settings, Status};

use crate::device::scale::Scale;
use crate::device::stream::Stream;
use crate::device::text;

/// Length of the curves, s.
pub const WINDOW_S: f64 = 5.0;
/// Points closer than this are not told apart on the screen, s. A port that is shared brings every tick.
const LEAST_SPACING_S: f64 = 0.99e-3;
/// Events that are kept.
const EVENTS: usize = 50;
/// Time over which rates are averaged.
const RATE_OVER: Duration = Duration::from_millis(900);

/// Whether the board is there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Connection {
    /// Yes.
    Up,
    /// No, and why.
    Lost(String),
}

/// A point of the curves.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Time, s.
    pub t: f64,
    /// Position, position units.
    pub x: f64,
    /// Drive, drive units.
    pub u: f64,
    /// Reference, position units.
    pub r: f64,
}

/// What the monitor knows of the board.
#[derive(Debug)]
pub struct State {
    /// Name of the port.
    pub port: String,
    /// Board, firmware and build, for the title.
    pub title: String,
    /// Whether the board is there.
    pub connection: Connection,
    /// What its integers are.
    pub scale: Scale,
    /// Its settings, for the limits.
    pub settings: Settings,
    /// Mode of the newest sample or status.
    pub mode: Mode,
    /// Newest status.
    pub status: Option<Status>,
    /// The latched fault.
    pub fault: Option<FaultRecord>,
    /// Samples of the last [`WINDOW_S`] seconds.
    pub points: VecDeque<Point>,
    /// The samples' gaps and counts.
    pub stream: Stream,
    /// Samples and bytes per second.
    pub rates: (f64, f64),
    /// Frames received damaged.
    pub damaged: u64,
    /// Events, the newest last.
    pub events: VecDeque<String>,
    /// The curves stand still.
    pub frozen: bool,
    /// When the state was made: the zero of its clock.
    pub started: Instant,
    /// Time, samples and bytes at the last average.
    counted: (Duration, u64, u64),
}

impl State {
    /// A state that has heard nothing yet.
    pub fn new(port: &str, info: &Info, scale: Scale, settings: Settings) -> Self {
        Self {
            port: port.to_owned(),
            title: format!("{}  firmware {} ({})", info.board, info.firmware, info.build),
            connection: Connection::Up,
            scale,
            settings,
            mode: Mode::Idle,
            status: None,
            fault: None,
            points: VecDeque::new(),
            stream: Stream::default(),
            rates: (0.0, 0.0),
            damaged: 0,
            events: VecDeque::new(),
            frozen: false,
            started: Instant::now(),
            counted: (Duration::ZERO, 0, 0),
        }
    }

    /// Goes on with a board that is back: new clock and scale, old events.
    pub fn reconnected(&mut self, mut new: Self) {
        new.events = std::mem::take(&mut self.events);
        new.note("connected again".to_owned());
        *self = new;
    }

    /// Adds a line to the events.
    pub fn note(&mut self, text: String) {
        self.events.push_back(text);
        while self.events.len() > EVENTS {
            self.events.pop_front();
        }
    }

    /// Takes a message of the board.
    pub fn take(&mut self, message: &Message) {
        match message {
            Message::Samples(batch) => {
                let mut rows = Vec::new();
                if self.stream.take(batch, &mut rows).is_err() {
                    // The board was reset: its clock begins anew.
                    self.stream = Stream::default();
                    self.counted.1 = 0;
                    self.points.clear();
                }
                for row in rows {
                    self.mode = row.mode;
                    let t = self.scale.time(row.tick);
                    let apart = self.points.back().is_none_or(|last| t - last.t >= LEAST_SPACING_S);
                    if !self.frozen && apart {
                        self.points.push_back(Point {
                            t,
                            x: self.scale.position(row.count),
                            u: self.scale.drive(row.drive_code.into()),
                            r: self.scale.position(row.reference),
                        });
                    }
                }
                let newest = self.points.back().map_or(0.0, |point| point.t);
                while self.points.front().is_some_and(|point| point.t < newest - WINDOW_S) {
                    self.points.pop_front();
                }
            }
            Message::Event(event) => {
                match event {
                    Event::FaultRaised(record) => {
                        self.fault = Some(*record);
                        self.mode = Mode::Fault;
                    }
                    Event::Started => self.status = None,
                    Event::ExperimentEnded(_) | Event::ModelMismatch(_) => {}
                }
                self.note(text::event(event, &self.scale, &self.settings));
                if matches!(event, Event::ModelMismatch(_)) {
                    let port = &self.port;
                    self.note(format!("stop it (s); breakaway run suite --port {port}; breakaway discover"));
                }
            }
            Message::Reply { reply: Reply::Status(status), .. } => {
                self.mode = status.mode;
                if status.mode != Mode::Fault {
                    self.fault = None;
                }
                self.status = Some(*status);
            }
            Message::Reply { .. } => {}
        }
    }

    /// Takes what the port has counted until `now`.
    pub fn traffic(&mut self, now: Duration, bytes: u64, damaged: u64) {
        self.damaged = damaged;
        let (then, samples_then, bytes_then) = self.counted;
        let Some(passed) = now.checked_sub(then).filter(|passed| *passed >= RATE_OVER) else { return };
        let samples = self.stream.totals.samples;
        let per_s = |count: u64, before: u64| count.saturating_sub(before) as f64 / passed.as_secs_f64();
        self.rates = (per_s(samples, samples_then), per_s(bytes, bytes_then));
        self.counted = (now, samples, bytes);
    }

    /// Velocity over the last twentieth of a second, position units/s.
    pub fn velocity(&self) -> Option<f64> {
        let last = self.points.back()?;
        let first = self.points.iter().rev().take_while(|point| point.t >= last.t - 0.05).last()?;
        (last.t > first.t).then(|| (last.x - first.x) / (last.t - first.t))
    }
}
