//! The application on a simulated axis, in process and in virtual time.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use breakaway_core::link::{
    Bounds, Command, Decoder, Ended, Event, FULL_SCALE_CODE, FaultRecord, MAX_FRAME, Message, Reference, Relay, Reply,
    Request, Sample, Settings, Status, encode,
};
use breakaway_core::plant::{Base, Drive as Held, Effect, Plant, State};
use breakaway_firmware::app::{App, Channels, Identity, Sums, Tick, TickSettings, TrackController, Wish, guards};
use breakaway_firmware::board::{Applied, Clock, Drive, Encoder, Protection, RETAINED_WORDS, Retained, Trip, Wire};
use breakaway_firmware::storage::{Loaded, NoStore};

/// The papers' plant at 1 kHz behind an encoder of 1 mrad and a drive of ±5 V.
pub const PLANT: Base<f64> = Base { b: 0.02685, c: 0.11, f1: 0.5 };
pub const TICK_HZ: u32 = 1000;
pub const STEP: f64 = 1e-3;
pub const FULL_SCALE: f64 = 5.0;

/// What is outside of the microcontroller, and what is wrong with it.
#[allow(clippy::struct_excessive_bools, reason = "independent things that break")]
pub struct World {
    pub plant: State<f64>,
    pub base: Base<f64>,
    pub effects: Vec<Effect<f64>>,
    pub drive: i16,
    pub enabled: bool,
    pub now_us: u32,
    pub frozen: Option<i32>,
    pub jump: i32,
    pub dead_encoder: bool,
    pub reversed: bool,
    pub trip: Option<Trip>,
    pub late_us: u32,
    pub broken_drive: bool,
    pub fed: u32,
    pub retained: [u32; RETAINED_WORDS],
    pub to_board: VecDeque<u8>,
    pub from_board: Vec<u8>,
}

#[derive(Clone)]
pub struct Shared(pub Rc<RefCell<World>>);

impl Encoder for Shared {
    type Error = ();
    fn count(&mut self) -> Result<i32, ()> {
        let world = self.0.borrow();
        let count = (world.plant.x / STEP).round() as i32 * if world.reversed { -1 } else { 1 };
        if world.dead_encoder { Err(()) } else { Ok(world.frozen.unwrap_or(count) + world.jump) }
    }
}
impl Drive for Shared {
    type Error = ();
    fn enable(&mut self) -> Result<(), ()> {
        self.0.borrow_mut().enabled = true;
        Ok(())
    }
    fn apply(&mut self, command: i32) -> Result<Applied, ()> {
        let mut world = self.0.borrow_mut();
        if world.broken_drive {
            return Err(());
        }
        let code = command.clamp(-i32::from(FULL_SCALE_CODE), i32::from(FULL_SCALE_CODE)) as i16;
        world.drive = if world.enabled { code } else { 0 };
        Ok(Applied { code: world.drive, limited: i32::from(code) != command })
    }
    fn off(&mut self) -> Result<(), ()> {
        let mut world = self.0.borrow_mut();
        (world.enabled, world.drive) = (false, 0);
        Ok(())
    }
}
impl Clock for Shared {
    fn now_us(&self) -> u32 {
        self.0.borrow().now_us
    }
}
impl Protection for Shared {
    fn tripped(&mut self) -> Option<Trip> {
        self.0.borrow().trip
    }
    fn feed_watchdog(&mut self) {
        self.0.borrow_mut().fed += 1;
    }
}
impl Retained for Shared {
    fn read(&self) -> [u32; RETAINED_WORDS] {
        self.0.borrow().retained
    }
    fn write(&mut self, words: [u32; RETAINED_WORDS]) {
        self.0.borrow_mut().retained = words;
    }
}
impl Wire for Shared {
    fn read(&mut self, buffer: &mut [u8]) -> usize {
        let mut world = self.0.borrow_mut();
        let n = buffer.len().min(world.to_board.len());
        world.to_board.drain(..n).zip(buffer).for_each(|(byte, slot)| *slot = byte);
        n
    }
    fn write(&mut self, bytes: &[u8]) -> usize {
        self.0.borrow_mut().from_board.extend(bytes);
        bytes.len()
    }
}
/// A running board and its host.
pub struct Bench {
    pub world: Shared,
    tick: Tick<'static, 'static, Shared, TrackController>,
    app: App<'static, 'static, TrackController, Shared, NoStore>,
    decoder: Decoder,
    id: u16,
    pub replies: Vec<(u16, Reply)>,
    pub events: Vec<Event>,
    pub samples: Vec<Sample>,
    /// Ticks between the host's signs of life; 0: silent.
    pub keep_alive: u32,
    ticks: u32,
    /// Frames that are expected to come damaged.
    pub cut: u32,
}

pub fn settings() -> Settings {
    Settings {
        drive_max_code: FULL_SCALE_CODE,
        mean_drive_max_code: FULL_SCALE_CODE,
        frozen_ticks: 200,
        position_per_count: STEP as f32,
        drive_full_scale: FULL_SCALE as f32,
        ..Settings::default()
    }
}

pub fn code(volts: f64) -> i16 {
    (volts / FULL_SCALE * f64::from(FULL_SCALE_CODE)).round() as i16
}

pub fn relay(h1: f64, h2: f64, ticks: u32) -> Relay {
    Relay {
        h1_code: code(h1),
        h2_code: code(h2),
        hysteresis_counts: Some(1),
        reference: Reference::default(),
        until_settled: false,
        append: true,
        bounds: Bounds { max_ticks: ticks, ..Bounds::default() },
    }
}

impl Bench {
    pub fn new() -> Self {
        Self::with_memory([0; RETAINED_WORDS], settings())
    }

    pub fn with_memory(retained: [u32; RETAINED_WORDS], settings: Settings) -> Self {
        let world = Shared(Rc::new(RefCell::new(World {
            plant: Plant { base: PLANT, effects: &[] }.at_rest(0.0),
            base: PLANT,
            effects: Vec::new(),
            drive: 0,
            enabled: false,
            now_us: 0,
            frozen: None,
            jump: 0,
            dead_encoder: false,
            reversed: false,
            trip: None,
            late_us: 0,
            broken_drive: false,
            fed: 0,
            retained,
            to_board: VecDeque::new(),
            from_board: Vec::new(),
        })));
        let identity = Identity { board: "bench", build: "test", tick_hz: TICK_HZ };
        // Leaked: a board has them for ever, too.
        let channels = Box::leak(Box::new(Channels::new()));
        let (tick_end, app_end) = channels.split();
        let guards = guards(&settings, &identity);
        let tick =
            Tick::new(world.clone(), TrackController::default(), tick_end, TickSettings::at_rate(TICK_HZ), guards);
        let sums = Box::leak(Box::new(Sums::new()));
        let loaded = Loaded::defaults(settings);
        let app = App::new(app_end, TrackController::default(), world.clone(), NoStore, identity, loaded, sums);
        Self {
            world,
            tick,
            app,
            decoder: Decoder::new(),
            id: 0,
            replies: Vec::new(),
            events: Vec::new(),
            samples: Vec::new(),
            keep_alive: 100,
            ticks: 0,
            cut: 0,
        }
    }

    /// One period: tick, thread, plant.
    pub fn step(&mut self) {
        if self.keep_alive > 0 && self.ticks.is_multiple_of(self.keep_alive) {
            self.send(&Command::Status);
        }
        self.ticks += 1;
        self.tick.tick();
        assert_eq!(self.app.poll(), Wish::Nothing);
        self.receive();
        let world = &mut *self.world.0.borrow_mut();
        let volts = f64::from(world.drive) / f64::from(FULL_SCALE_CODE) * FULL_SCALE;
        let plant = Plant { base: world.base, effects: &world.effects };
        let ts = 1.0 / f64::from(TICK_HZ);
        plant.advance(&mut world.plant, Held { u: &[volts], ts, t: 0.0 }, 4);
        world.now_us += 1_000_000 / TICK_HZ + world.late_us;
    }

    pub fn steps(&mut self, n: u32) {
        (0..n).for_each(|_| self.step());
    }

    pub fn send(&mut self, command: &Command) -> u16 {
        self.id += 1;
        let mut frame = [0; MAX_FRAME];
        let request = Request { id: self.id, command: command.clone() };
        let used = encode(&request, &mut frame).unwrap();
        self.world.0.borrow_mut().to_board.extend(&frame[..used]);
        self.id
    }

    /// Sends a command and steps until it is answered.
    #[allow(clippy::needless_pass_by_value, reason = "commands are written where they are sent")]
    pub fn command(&mut self, command: Command) -> Reply {
        let id = self.send(&command);
        for _ in 0..100 {
            self.step();
            if let Some((_, reply)) = self.replies.iter().find(|(found, _)| *found == id) {
                return reply.clone();
            }
        }
        panic!("no answer to {command:?}");
    }

    pub fn status(&mut self) -> Status {
        match self.command(Command::Status) {
            Reply::Status(status) => status,
            other => panic!("{other:?}"),
        }
    }

    /// Steps until a run has ended.
    pub fn until_ended(&mut self, most: u32) -> Ended {
        for _ in 0..most {
            self.step();
            let ended = self.events.iter().find_map(|event| match event {
                Event::ExperimentEnded(ended) => Some(*ended),
                _ => None,
            });
            if let Some(ended) = ended {
                return ended;
            }
        }
        panic!("the run did not end within {most} ticks");
    }

    pub fn fault(&mut self) -> Option<FaultRecord> {
        match self.command(Command::GetFault) {
            Reply::Fault(fault) => fault,
            other => panic!("{other:?}"),
        }
    }

    pub fn limits(&self) -> breakaway_firmware::app::RunLimits {
        self.tick.limits()
    }

    fn receive(&mut self) {
        let bytes = std::mem::take(&mut self.world.0.borrow_mut().from_board);
        for byte in bytes {
            let Some(message) = self.decoder.push(byte) else {
                continue;
            };
            if message.is_err() && self.cut > 0 {
                self.cut -= 1;
                continue;
            }
            match Message::decode(message.expect("a whole frame")).expect("a message") {
                Message::Reply { id, reply } => self.replies.push((id, reply)),
                Message::Event(event) => self.events.push(event),
                Message::Samples(batch) => self.samples.extend(batch.samples().map(Result::unwrap)),
            }
        }
    }
}
