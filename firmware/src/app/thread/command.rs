//! Commands: checked here, carried out here or by the tick.

use breakaway_core::excite::relay::{DualRelay, RelayError};
use breakaway_core::link::{
    Bounds, Command, CommandError, Field, Info, Mode, PROTOCOL_VERSION, Relay, Reply, Request, SCHEMA, Status, Text,
    Track, Trajectory,
};

use super::{App, Experiment, Planner, Then, Waiting, guards};
use crate::app::channels::Order;
use crate::app::excite::Excitation;
use crate::app::run::RunOrder;
use crate::board::Wire;
use crate::storage::Store;

/// Answered at once, or once the tick has answered.
enum Outcome<'a, P> {
    Now(Reply),
    Ask(Order<'a>, Then),
    Run(RunOrder<P>, Bounds, Then),
}

impl<'a, P: Planner, W: Wire, S: Store> App<'_, 'a, P, W, S> {
    #[inline(never)]
    pub(super) fn obey(&mut self, request: Request) {
        let Request { id, command } = request;
        let outcome = command.validate().and_then(|()| self.decide(command));
        match outcome {
            Ok(Outcome::Now(reply)) => self.outbox.reply(id, reply),
            Ok(Outcome::Ask(order, then)) => {
                let taken = self.channels.orders.enqueue(order).is_ok();
                self.asked(id, then, taken);
            }
            Ok(Outcome::Run(run, bounds, then)) => {
                let taken = self.channels.runs.enqueue((run, bounds)).is_ok();
                self.asked(id, then, taken);
            }
            Err(error) => self.outbox.reply(id, Reply::Error(error)),
        }
    }

    fn asked(&mut self, id: u16, then: Then, taken: bool) {
        if taken {
            self.waiting = Some(Waiting { id, then });
        } else {
            // The tick has not taken the orders before: it stands still.
            self.outbox.reply(id, Reply::Error(CommandError::Busy(self.mode())));
        }
    }

    fn decide(&mut self, command: Command) -> Result<Outcome<'a, P::Plan>, CommandError> {
        Ok(Outcome::Now(match command {
            Command::Hello => Reply::Info(self.info()),
            Command::Status => Reply::Status(self.status()),
            Command::GetSettings => Reply::Settings(self.settings),
            Command::SetSettings(settings) => {
                let guards = guards(&settings, &self.identity);
                return Ok(Outcome::Ask(Order::Guards(guards), Then::Settings(settings)));
            }
            Command::GetModel => Reply::Model(self.model.clone()),
            Command::LoadModel(model) => {
                self.idle()?;
                self.saved &= self.model.as_ref() == Some(&model);
                self.model = Some(model);
                Reply::Done
            }
            Command::Save => {
                self.idle()?;
                self.store.save(&self.settings, self.model.as_ref()).map_err(|_| CommandError::Storage)?;
                self.saved = true;
                Reply::Done
            }
            Command::StartRelay(relay) => return self.relay(&relay),
            Command::StartDrive(drive) => {
                let run = RunOrder::Excite(Excitation::Drive(drive));
                return Ok(Outcome::Run(run, drive.bounds, Then::Nothing));
            }
            Command::StartTrack(track) => return self.track(&track),
            Command::LoadWaveform(part) => return Ok(Outcome::Ask(Order::Waveform(part), Then::Nothing)),
            Command::Identify => Reply::Identified(self.identification.solve()?),
            Command::Stop => return Ok(Outcome::Ask(Order::Stop, Then::Nothing)),
            Command::StreamOn { decimation } => {
                self.stream.switch(decimation);
                Reply::Done
            }
            Command::StreamOff => {
                self.stream.switch(0);
                Reply::Done
            }
            Command::GetFault => Reply::Fault(self.fault),
            Command::ClearFault => return Ok(Outcome::Ask(Order::ClearFault, Then::Cleared)),
            Command::Reboot => {
                self.reboot = true;
                Reply::Done
            }
        }))
    }

    fn relay(&self, relay: &Relay) -> Result<Outcome<'a, P::Plan>, CommandError> {
        let hysteresis = relay.hysteresis_counts.unwrap_or(self.settings.hysteresis_counts);
        let relays = DualRelay::new(i32::from(relay.h1_code), i32::from(relay.h2_code), hysteresis);
        let relays = relays.map_err(|error| {
            CommandError::Range(match error {
                RelayError::H1 => Field::H1,
                RelayError::H2 | RelayError::Sum => Field::H2,
                RelayError::Hysteresis => Field::Hysteresis,
            })
        })?;
        let run = RunOrder::Excite(Excitation::Relay { relay: relays, reference: relay.reference });
        let experiment = Experiment::new(relay, hysteresis);
        Ok(Outcome::Run(run, relay.bounds, Then::Relay(experiment)))
    }

    fn track(&self, track: &Track) -> Result<Outcome<'a, P::Plan>, CommandError> {
        let plan = self.planner.plan(track, self.model.as_ref(), &self.settings, self.identity.tick_hz)?;
        let run = if track.trajectory == Trajectory::Hold { RunOrder::Hold(plan) } else { RunOrder::Track(plan) };
        Ok(Outcome::Run(run, track.bounds, Then::Track(*track)))
    }

    fn idle(&self) -> Result<(), CommandError> {
        match self.mode() {
            Mode::Idle => Ok(()),
            Mode::Fault => Err(CommandError::Faulted),
            mode => Err(CommandError::Busy(mode)),
        }
    }

    fn mode(&self) -> Mode {
        // An encoder that does not answer leaves no samples that could say so.
        if self.fault.is_some() { Mode::Fault } else { self.last.mode }
    }

    fn info(&self) -> Info {
        // What does not fit is left out whole: a cut name would be another's.
        let text = |text: &str| Text::try_from(text).unwrap_or_default();
        Info {
            protocol_version: PROTOCOL_VERSION,
            schema: SCHEMA,
            firmware: text(env!("CARGO_PKG_VERSION")),
            build: text(self.identity.build),
            board: text(self.identity.board),
            tick_hz: self.identity.tick_hz,
            counts_per_revolution: self.settings.counts_per_revolution,
            position_per_count: self.settings.position_per_count,
            position_unit: self.settings.position_unit,
            drive_full_scale: self.settings.drive_full_scale,
            drive_unit: self.settings.drive_unit,
        }
    }

    fn status(&self) -> Status {
        Status {
            mode: self.mode(),
            tick: self.last.tick,
            count: self.last.count,
            drive_code: self.last.drive_code,
            decimation: self.stream.decimation(),
            dropped: self.stream.dropped(),
            bad_frames: self.decoder.bad_frames(),
            overruns: self.overruns,
            unsaved: !self.saved,
        }
    }
}
