//! Commands: checked here, carried out here or by the tick.

use breakaway_core::excite::relay::{DualRelay, RelayError};
use breakaway_core::link::{
    Bounds, Command, CommandError, DriveUnit, FULL_SCALE_CODE, Field, Info, Mode, PROTOCOL_VERSION, Push, Relay, Reply,
    Request, SCHEMA, Settings, Status, Text, Track, Trajectory,
};

use super::{App, Experiment, Identity, Planner, PowerStage, Then, Waiting};
use crate::app::channels::Order;
use crate::app::control::ControlPlan;
use crate::app::excite::Excitation;
use crate::app::guard::Guards;
use crate::app::run::RunOrder;
use crate::board::Wire;
use crate::storage::Store;

impl<'a, P: Planner, W: Wire, S: Store> App<'_, 'a, P, W, S> {
    #[inline(never)]
    pub(super) fn answer_request(&mut self, request: Request) {
        let Request { id, command } = request;
        if let Err(error) = command.validate().and_then(|()| self.decide(id, command)) {
            self.outbox.reply(id, Reply::Error(error));
        }
    }

    /// Answers at once, or has the tick asked first.
    fn decide(&mut self, id: u16, command: Command) -> Result<(), CommandError> {
        match command {
            Command::Hello => self.outbox.reply(id, Reply::Info(self.info())),
            Command::Status => self.outbox.reply(id, Reply::Status(self.status())),
            Command::GetSettings => self.outbox.reply(id, Reply::Settings(self.settings)),
            // What nothing measures would protect nothing.
            Command::SetSettings(settings) if settings.current_max_ma > self.identity.current_range_ma => {
                return Err(CommandError::Settings(Field::CurrentMax));
            }
            Command::SetSettings(settings) if settings.drive_max_code > self.identity.drive_max_code => {
                return Err(CommandError::Settings(Field::DriveMax));
            }
            Command::SetSettings(settings) => {
                self.current_plan(&settings)?;
                self.ask(id, Order::Guards(Guards::new(&settings, self.identity.tick_hz)), Then::Settings(settings));
            }
            Command::GetModel => self.outbox.reply(id, Reply::Model(self.model.clone())),
            Command::LoadModel(model) => {
                self.mode().idle()?;
                self.saved &= self.model.as_ref() == Some(&model);
                self.model = Some(model);
                self.done(id);
            }
            Command::Save => {
                self.mode().idle()?;
                self.store.save(&self.settings, self.model.as_ref()).map_err(|_| CommandError::Storage)?;
                self.saved = true;
                self.done(id);
            }
            Command::StartRelay(relay) => self.relay(id, &relay)?,
            Command::StartDrive(drive) => {
                self.start(id, RunOrder::Excite(Excitation::Drive(drive)), drive.bounds, Then::Nothing)?;
            }
            Command::StartTrack(track) => self.track(id, &track)?,
            Command::LoadWaveform(part) => self.ask(id, Order::Waveform(part), Then::Nothing),
            Command::Identify => self.outbox.reply(id, Reply::Identified(self.identification.solve()?)),
            Command::Stop => self.ask(id, Order::Stop, Then::Nothing),
            Command::StreamOn { decimation } => self.switch(id, decimation),
            Command::StreamOff => self.switch(id, 0),
            Command::GetFault => self.outbox.reply(id, Reply::Fault(self.fault)),
            Command::ClearFault => self.ask(id, Order::ClearFault, Then::Cleared),
            Command::Zero { count } => self.ask(id, Order::Zero(count), Then::Zeroed),
            Command::Jog(push) => self.push(id, push, None)?,
            Command::Home { push, at } => self.push(id, push, Some(at))?,
            Command::SetPoints(points) => self.set_points(id, &points)?,
            Command::Reboot => {
                self.reboot = true;
                self.done(id);
            }
        }
        Ok(())
    }

    #[inline(never)]
    fn done(&mut self, id: u16) {
        self.outbox.reply(id, Reply::Done);
    }

    fn switch(&mut self, id: u16, decimation: u16) {
        self.stream.switch(decimation);
        self.done(id);
    }

    /// Answers once the tick has answered.
    #[inline(never)]
    fn ask(&mut self, id: u16, order: Order<'a>, then: Then) {
        let taken = self.channels.orders.enqueue(order).is_ok();
        self.asked(id, then, taken);
    }

    /// As [`Self::ask`], of a run.
    #[inline(never)]
    fn start(&mut self, id: u16, run: RunOrder<P::Plan>, bounds: Bounds, then: Then) -> Result<(), CommandError> {
        let current = self.current_plan(&self.settings)?;
        let taken = self.channels.runs.enqueue((run, bounds, current)).is_ok();
        self.asked(id, then, taken);
        Ok(())
    }

    /// The current loop where the drive is a current, which must be one that is measured. What takes a drive in A as it is has none.
    #[inline(never)]
    fn current_plan(&self, settings: &Settings) -> Result<Option<<P::Plan as ControlPlan>::Current>, CommandError> {
        if settings.drive_unit != DriveUnit::Ampere {
            return Ok(None);
        }
        let Identity { current_range_ma, tick_hz, power_stage, .. } = self.identity;
        if power_stage == PowerStage::AsSet && settings.motor_resistance_ohm <= 0.0 {
            return Ok(None);
        }
        if current_range_ma == 0 {
            return Err(CommandError::Settings(Field::DriveUnit));
        }
        let largest =
            1000.0 * settings.drive_full_scale * f32::from(settings.drive_max_code) / f32::from(FULL_SCALE_CODE);
        // A rounding above it is not above it.
        if largest > 1.000_1 * current_range_ma as f32 {
            return Err(CommandError::Settings(Field::DriveMax));
        }
        self.planner.current(settings, tick_hz).map(Some)
    }

    fn asked(&mut self, id: u16, then: Then, taken: bool) {
        if taken {
            self.waiting = Some(Waiting { id, then });
        } else {
            // The tick has not taken the orders before: it stands still.
            self.outbox.reply(id, Reply::Error(CommandError::Busy(self.mode())));
        }
    }

    fn push(&mut self, id: u16, push: Push, stop_at: Option<i32>) -> Result<(), CommandError> {
        let Push { drive_code, bounds } = push;
        // Against a stop it is a stalled motor.
        if drive_code.unsigned_abs() > self.settings.mean_drive_max_code.unsigned_abs() {
            return Err(CommandError::Range(Field::PushDrive));
        }
        self.start(id, RunOrder::Excite(Excitation::Push { drive_code, stop_at }), bounds, Then::Nothing)
    }

    fn relay(&mut self, id: u16, relay: &Relay) -> Result<(), CommandError> {
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
        self.start(id, run, relay.bounds, Then::Relay(experiment))
    }

    #[inline(never)]
    fn track(&mut self, id: u16, track: &Track) -> Result<(), CommandError> {
        let plan = self.planner.plan(track, self.model.as_ref(), &self.settings, self.identity.tick_hz)?;
        let run = if track.trajectory == Trajectory::Hold { RunOrder::Hold(plan) } else { RunOrder::Track(plan) };
        self.start(id, run, track.bounds, Then::Track(*track))
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
            current_range_ma: self.identity.current_range_ma,
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
            zero_needed: self.zero_needed,
        }
    }
}
