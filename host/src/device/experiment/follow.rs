//! Set-points followed on the board as they come.

use std::time::{Duration, Instant};

use breakaway_core::link::{
    Batch, Bounds, Command, CommandError, ControllerGains, Ended, Ending, Event, Message, Mode, Model, Reply, Track,
    Trajectory,
};

use super::feed::{ASK_AGAIN, Feed};
use super::{LAG, Runner, SILENCE};
use crate::device::set_points::Source;
use crate::device::stream::Stream;
use crate::device::{DeviceError, text};
use crate::interrupt::FinishFirst;

/// How long the board may take to answer set-points, before they are sent again.
const ANSWER: Duration = Duration::from_millis(250);
/// A controller and how set-points are followed.
#[derive(Clone, Debug)]
pub struct FollowRun<'a> {
    /// The model to load before.
    pub model: &'a Model,
    /// Whether it is compensated; otherwise the PID is alone.
    pub compensate: bool,
    /// Who follows.
    pub controller: ControllerGains,
    /// Largest |drive|, drive units.
    pub drive_limit: f64,
    /// Set-points that wait on the board before it moves.
    pub ahead: u8,
    /// How long the last set-point is held where none come, s.
    pub hold_s: f64,
}

/// What came of it.
#[derive(Clone, Copy, Debug, Default)]
pub struct FollowTotals {
    /// Set-points that the board took.
    pub set_points: u64,
    /// Samples of the run.
    pub samples: u64,
    /// Samples that were lost on the way.
    pub missing: u64,
    /// Sum of the squared error, counts².
    pub squares: f64,
    /// Largest |error|, counts.
    pub peak: u32,
    /// Sum of the squared drive, codes².
    pub drive_squares: f64,
    /// How often the set-points ran dry.
    pub dry: u32,
    /// How the board says it ended.
    pub ended: Option<Ended>,
}

impl Runner {
    /// Loads the model, follows the set-points to their end. `seen` gets every message of the board.
    ///
    /// # Errors
    /// A line that is no set-point, or that the board refuses; the board is lost, or ends the run before the last set-point.
    pub fn follow_set_points(
        &mut self,
        run: &FollowRun<'_>,
        source: &Source,
        interrupt: &FinishFirst,
        seen: &mut dyn FnMut(&Message) -> Result<(), DeviceError>,
    ) -> anyhow::Result<FollowTotals> {
        match self.client.status()?.mode {
            Mode::Idle => {}
            Mode::Fault => return Err(self.latched().into()),
            mode => return Err(DeviceError::NotIdle(mode.name()).into()),
        }
        let start = self.start_following(run)?;
        self.client.done(Command::LoadModel(run.model.clone()))?;
        self.client.done(Command::StreamOn { decimation: 1 })?;
        let mut totals = FollowTotals::default();
        let followed =
            self.client.done(start).map_err(Into::into).and_then(|()| self.feed(source, interrupt, seen, &mut totals));
        let lost = followed
            .as_ref()
            .is_err_and(|error: &anyhow::Error| matches!(error.downcast_ref(), Some(DeviceError::Unplugged { .. })));
        if !lost {
            if followed.is_err() {
                // The board is told to stop on every way out; what went wrong before is what is reported.
                let _ = self.client.done(Command::Stop);
            }
            let _ = self.client.done(Command::StreamOff);
        }
        followed.map(|()| totals)
    }

    fn start_following(&self, run: &FollowRun<'_>) -> Result<Command, DeviceError> {
        let drive_max_code = if run.drive_limit < self.drive_limit() {
            self.scale.code("--drive-limit", run.drive_limit)?
        } else {
            self.settings.drive_max_code
        };
        let start = Command::StartTrack(Track {
            trajectory: Trajectory::Follow { ahead: run.ahead, hold_ticks: self.scale.ticks("--hold", run.hold_s)? },
            controller: run.controller,
            feed_forward: run.compensate,
            compensation: run.compensate,
            bounds: Bounds { max_ticks: 0, drive_max_code, travel_counts: 0 },
        });
        start.validate().map_err(|error| DeviceError::Refused { command: text::command_name(&start), error })?;
        Ok(start)
    }

    /// Sends set-points and takes what the board says until the run has ended.
    fn feed(
        &mut self,
        source: &Source,
        interrupt: &FinishFirst,
        seen: &mut dyn FnMut(&Message) -> Result<(), DeviceError>,
        totals: &mut FollowTotals,
    ) -> anyhow::Result<()> {
        let mut feed = Feed::new(source, self.scale.tick_hz);
        let (mut stream, mut heard, mut ended_at, mut fault) = (Stream::default(), Instant::now(), None, None);
        loop {
            if interrupt.requested() {
                return Err(DeviceError::Interrupted.into());
            }
            if ended_at.is_none() {
                feed.read()?;
                if feed.is_due() {
                    self.send_set_points(&mut feed)?;
                    (totals.set_points, totals.dry) = (feed.state.next.into(), feed.state.dry);
                }
            }
            let message = self.client.receive(if feed.done { Duration::from_millis(20) } else { ASK_AGAIN / 2 })?;
            if let Some(message) = &message {
                heard = Instant::now();
                seen(message)?;
            } else if heard.elapsed() > SILENCE {
                let seconds = SILENCE.as_secs_f64();
                let port = self.client.port().to_owned();
                return Err(DeviceError::Silent { port, command: "status", seconds }.into());
            }
            match message {
                Some(Message::Reply { reply: Reply::Following(now), .. }) => feed.heard(now),
                Some(Message::Samples(batch)) => totals.take(&batch, &mut stream),
                Some(Message::Event(Event::ExperimentEnded(ended))) => {
                    totals.ended = Some(ended);
                    ended_at = Some(Instant::now());
                }
                Some(Message::Event(Event::FaultRaised(record))) => fault = Some(text::fault(&record)),
                Some(Message::Event(Event::Started)) => {
                    return Err(DeviceError::Restarted { port: self.client.port().to_owned() }.into());
                }
                _ => {}
            }
            // Another program that stopped the run may have read the event in place of this one.
            if ended_at.is_none() && feed.over_at.is_some_and(|since| since.elapsed() > SILENCE) {
                let lost = "the board takes no more set-points: the run is over, and its last word was lost".to_owned();
                return Err(DeviceError::Ended(lost).into());
            }
            let (Some(since), Some(ended)) = (ended_at, totals.ended) else { continue };
            // The samples up to the end are before it; those after it say that there are no more.
            if stream.totals.samples > totals.samples || since.elapsed() > LAG {
                return self.ended(ended, fault, feed.done).map_err(Into::into);
            }
        }
    }

    /// Sends what there is room for. Where the board refuses, each is sent by itself, to find the line.
    fn send_set_points(&mut self, feed: &mut Feed<'_>) -> anyhow::Result<()> {
        let mut sent = feed.command();
        loop {
            match self.client.request_within(Command::SetPoints(sent.clone()), ANSWER) {
                Ok(Reply::Following(now)) => {
                    feed.taken(&sent, now);
                    return Ok(());
                }
                Ok(_) => return Err(DeviceError::Nonsense { command: "set-points" }.into()),
                // Lost on the way: it is sent again, and what was taken is left out there.
                Err(DeviceError::Silent { .. }) => return Ok(()),
                // The run is over, and its event is on the way.
                Err(DeviceError::Refused { error: CommandError::NotFollowing, .. }) => {
                    feed.state.room = 0;
                    feed.over_at.get_or_insert_with(Instant::now);
                    return Ok(());
                }
                Err(DeviceError::Refused { error: CommandError::Range(_), .. }) if sent.points.len() > 1 => {
                    sent.points.truncate(1);
                    sent.last = false;
                }
                Err(error @ DeviceError::Refused { error: CommandError::Range(_), .. }) => {
                    let line = feed.waiting.front().map_or(0, |(line, _)| *line);
                    let name = &feed.source.name;
                    return Err(anyhow::Error::new(error).context(format!("{name}, line {line}")));
                }
                Err(error) => return Err(error.into()),
            }
        }
    }

    fn ended(&self, ended: Ended, fault: Option<String>, done: bool) -> Result<(), DeviceError> {
        let why = match (fault, ended.ending) {
            (Some(fault), _) => return Err(DeviceError::Fault(fault)),
            (None, Ending::Fault(cause)) => return Err(DeviceError::Fault(text::cause_name(cause).to_owned())),
            (None, Ending::TimeUp) if done => return Ok(()),
            (None, Ending::Stopped) => "the run was stopped".to_owned(),
            (None, ending) => text::ending(ending, &self.scale, &self.settings),
        };
        let after = self.scale.time(ended.ticks.into());
        Err(DeviceError::Ended(format!("the board ended the run after {after:.3} s: {why}")))
    }
}

impl FollowTotals {
    fn take(&mut self, batch: &Batch, stream: &mut Stream) {
        let mut rows = Vec::new();
        // A reset is an event of its own.
        let _ = stream.take(batch, &mut rows);
        for row in rows.iter().filter(|row| row.mode == Mode::Track) {
            let error = row.reference.wrapping_sub(row.count);
            self.missing += if self.samples == 0 { 0 } else { row.missing };
            self.samples += 1;
            self.squares += f64::from(error).powi(2);
            self.peak = self.peak.max(error.unsigned_abs());
            self.drive_squares += f64::from(row.drive_code).powi(2);
        }
        // Samples before the run are not counted as those after it.
        if self.samples == 0 {
            stream.totals.samples = 0;
        }
    }
}
