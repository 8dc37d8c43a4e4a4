//! The thread: link, identification, settings. Called over and over from the main loop, below the tick's interrupt.

mod command;
mod drift;
mod follow;
mod identification;
mod outbox;
mod plan;
mod stream;

pub use identification::{Experiment, Identification};
pub use plan::Planner;

use breakaway_core::link::{
    CommandError, Decoder, Ended, Ending, Event, FaultCause, FaultRecord, Mode, Model, Reply, Request, Sample,
    Settings, Track,
};

use super::accumulate::Sums;
use super::channels::{AppEnd, Order, TickEvent};
use super::guard::Guards;
use crate::board::Wire;
use crate::storage::{Loaded, Store};
use drift::Drift;
use follow::Follow;
use outbox::Outbox;
use stream::Stream;

/// Who this is; for [`breakaway_core::link::Info`].
#[derive(Clone, Copy, Debug)]
pub struct Identity {
    /// Name of the board, at most 24 bytes.
    pub board: &'static str,
    /// Build hash, at most 24 bytes.
    pub build: &'static str,
    /// Control ticks per second, ≥ 1.
    pub tick_hz: u32,
    /// Largest drive that its power stage gives, drive codes: settings above are refused.
    pub drive_max_code: i16,
    /// Largest motor current that it measures either way, mA ([`crate::board::Protection::current_ma`]); 0: none is measured, and a
    /// limit of it is refused.
    pub current_range_ma: u32,
    /// What its drive is.
    pub power_stage: PowerStage,
}

/// What a power stage makes of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PowerStage {
    /// A voltage: a drive in A needs the current loop, and with it a current that is measured.
    Bridge,
    /// What the settings say, as in a simulated machine: its drive has the unit of its model.
    AsSet,
}

/// What the main loop should do after a poll.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wish {
    /// Poll again, after sleeping until there is something to do.
    Nothing,
    /// Reset the board now: it was commanded, and the reply is out.
    Reboot,
}

/// A command that waits for the tick's answer.
#[derive(Debug)]
struct Waiting {
    id: u16,
    then: Then,
}

/// What a good answer means.
#[derive(Debug)]
enum Then {
    Nothing,
    Cleared,
    Settings(Settings),
    Zeroed,
    Relay(Experiment),
    Track(Track),
}

/// Bytes taken from the wire per poll: bounds the time of one.
const READ_BYTES: usize = 64;

/// The application beside the tick.
#[allow(clippy::struct_excessive_bools, reason = "each is so or not whatever the others are")]
pub struct App<'q, 'a, P: Planner, W, S> {
    channels: AppEnd<'q, 'a, P::Plan>,
    planner: P,
    wire: W,
    store: S,
    identity: Identity,
    settings: Settings,
    model: Option<Model>,
    saved: bool,
    /// As the tick's guards have it.
    zero_needed: bool,
    decoder: Decoder,
    outbox: Outbox,
    stream: Stream,
    identification: Identification,
    drift: Drift,
    follow: Option<Follow>,
    sums: Option<&'a mut Sums>,
    waiting: Option<Waiting>,
    unread: heapless::Deque<u8, READ_BYTES>,
    last: Sample,
    fault: Option<FaultRecord>,
    overruns: u32,
    reboot: bool,
    /// The tick runs, and has said whether a fault is latched.
    ticking: bool,
}

impl<'q, 'a, P: Planner, W: Wire, S: Store> App<'q, 'a, P, W, S> {
    /// Settings and model as `loaded` from the store (see [`guards`] for the tick's start); `sums` is lent to the tick
    /// during relay experiments.
    #[inline(never)]
    pub fn new(
        channels: AppEnd<'q, 'a, P::Plan>,
        planner: P,
        wire: W,
        store: S,
        identity: Identity,
        loaded: Loaded,
        sums: &'a mut Sums,
    ) -> Self {
        let mut app = Self {
            channels,
            planner,
            wire,
            store,
            identity,
            settings: loaded.settings,
            model: loaded.model,
            saved: true,
            zero_needed: loaded.zero_needed,
            decoder: Decoder::new(),
            outbox: Outbox::new(),
            stream: Stream::new(),
            identification: Identification::new(),
            drift: Drift::new(),
            follow: None,
            sums: Some(sums),
            waiting: None,
            unread: heapless::Deque::new(),
            last: Sample::default(),
            fault: None,
            overruns: 0,
            reboot: false,
            ticking: false,
        };
        app.outbox.event(Event::Started);
        if let Some((cause, found)) = loaded.lost {
            app.lost(cause, found);
        }
        app
    }

    /// One round. Bounded: some bytes, the samples that are waiting, at most one command.
    pub fn poll(&mut self) -> Wish {
        self.take_samples();
        self.take_events();
        // Before the first tick nothing true can be said of the board.
        if self.ticking && self.waiting.is_none() && self.outbox.can_reply() {
            self.receive();
        }
        self.send();
        if self.reboot && self.outbox.is_empty() && self.wire.idle() { Wish::Reboot } else { Wish::Nothing }
    }

    /// Settings or model in flash could not be used.
    fn lost(&mut self, cause: FaultCause, found: i32) {
        let record = FaultRecord {
            cause,
            mode: Mode::Idle,
            tick: 0,
            count: 0,
            drive_code: 0,
            value: found,
            limit: i32::from(crate::storage::VERSION),
        };
        // The queue is empty at start-up.
        let _ = self.channels.orders.enqueue(Order::Fault(record));
    }

    #[inline(never)]
    fn take_samples(&mut self) {
        // Samples that do not fit the wire now wait in their queue, as long as there is room for new ones.
        while self.stream.ready() || self.channels.samples.len() > self.channels.samples.capacity() / 2 {
            let Some(sample) = self.channels.samples.dequeue() else {
                break;
            };
            self.last = sample;
            self.ticking = true;
            self.stream.push(sample);
            if let Some(order) = self.identification.push(&sample, &self.settings, self.identity.tick_hz) {
                self.carry_on(order);
            }
            if let Some(follow) = &mut self.follow {
                follow.push(&sample);
            }
            if let Some(mismatch) = self.drift.push(&sample) {
                self.outbox.event(Event::ModelMismatch(mismatch));
            }
        }
    }

    /// What the identification wants of the tick.
    fn carry_on(&mut self, want: identification::Want) {
        match want {
            identification::Want::Sums(config) => {
                if let Some(sums) = self.sums.take() {
                    *sums = Sums::new();
                    if let Err(Order::Accumulate(_, sums)) =
                        self.channels.orders.enqueue(Order::Accumulate(config, sums))
                    {
                        self.sums = Some(sums);
                    }
                }
            }
            // A full queue means that the tick stands still; then there is nothing to end.
            identification::Want::End(ending) => {
                let _ = self.channels.orders.enqueue(Order::End(ending));
            }
        }
    }

    #[inline(never)]
    fn take_events(&mut self) {
        while let Some(event) = self.channels.events.peek() {
            // What a run recorded comes before its end.
            if let TickEvent::Ended(ended) = event {
                let missing = ended.tick.wrapping_sub(self.last.tick).cast_signed();
                if missing > 0 && self.channels.samples.ready() {
                    return;
                }
            }
            let Some(event) = self.channels.events.dequeue() else {
                return;
            };
            match event {
                TickEvent::Answer(answer) => self.answered(answer),
                TickEvent::Fault(record) => {
                    self.ticking = true;
                    self.fault = Some(record);
                    self.outbox.event(Event::FaultRaised(record));
                }
                TickEvent::Ended(ended) => self.ended(ended),
                TickEvent::Overruns(overruns) => self.overruns = overruns,
                TickEvent::Sums(done) => {
                    self.identification.summed(&done, self.settings.position_per_count);
                    self.sums = Some(done.sums);
                }
            }
        }
    }

    fn ended(&mut self, ended: Ended) {
        if ended.mode == Mode::Relay {
            self.identification.ended(matches!(ended.ending, Ending::Fault(_)));
        }
        if ended.mode == Mode::Track {
            self.drift.ended();
            self.follow = None;
        }
        self.zero_needed &= ended.ending != Ending::Homed;
        self.outbox.event(Event::ExperimentEnded(ended));
    }

    fn answered(&mut self, answer: Result<(), CommandError>) {
        let Some(Waiting { id, then }) = self.waiting.take() else {
            return;
        };
        if let Err(error) = answer {
            self.outbox.reply(id, Reply::Error(error));
            return;
        }
        match then {
            Then::Nothing => {}
            Then::Cleared => self.fault = None,
            Then::Zeroed => self.zero_needed = false,
            Then::Settings(settings) => {
                self.saved &= settings == self.settings;
                self.zero_needed &= settings.same_travel(&self.settings);
                self.settings = settings;
            }
            Then::Relay(experiment) => self.identification.start(experiment),
            Then::Track(track) => {
                self.follow = Follow::start(&track);
                self.drift.start(&track, self.model.as_ref(), &self.settings, self.identity.tick_hz);
            }
        }
        self.outbox.reply(id, Reply::Done);
    }

    #[inline(never)]
    fn receive(&mut self) {
        let mut bytes = [0; READ_BYTES];
        if self.unread.is_empty() {
            let read = self.wire.read(&mut bytes).min(bytes.len());
            // Empty, and as long as the buffer.
            self.unread.extend(bytes.iter().take(read).copied());
        }
        while let Some(byte) = self.unread.pop_front() {
            let request = match self.decoder.push(byte) {
                Some(Ok(message)) => Request::decode(message),
                Some(Err(_)) | None => continue,
            };
            match request {
                Ok(request) => {
                    self.channels.alive();
                    self.answer_request(request);
                    return;
                }
                Err(rejected) => {
                    if let Some(id) = rejected.id {
                        self.outbox.reply(id, Reply::Error(rejected.error));
                        return;
                    }
                }
            }
        }
    }

    fn send(&mut self) {
        self.outbox.fill(&mut self.stream);
        self.outbox.send(&mut self.wire);
        self.wire.flush();
    }
}

/// The tick's guards at the start.
pub fn guards(loaded: &Loaded, identity: &Identity) -> Guards {
    Guards { zero_needed: loaded.zero_needed, ..Guards::new(&loaded.settings, identity.tick_hz) }
}
