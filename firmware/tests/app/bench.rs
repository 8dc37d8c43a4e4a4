//! The application on a simulated axis, in process and in virtual time.

use std::cell::RefCell;
use std::rc::Rc;

use breakaway_core::control::Fast;
use breakaway_core::link::{
    Command, Decoder, Ended, Event, FULL_SCALE_CODE, FaultRecord, MAX_FRAME, Message, Reply, Request, Sample, Settings,
    Status, encode,
};
use breakaway_core::plant::{Base, Drive as Held, Effect, Plant, State};
use breakaway_firmware::app::{
    App, Channels, Identity, PowerStage, Sums, Tick, TickSettings, TrackController, Wish, guards,
};
use breakaway_firmware::board::RETAINED_WORDS;
use breakaway_firmware::storage::{Loaded, NoStore};
use breakaway_rig::{FULL_SCALE, Motion, STEP, Shared, TICK_HZ};

/// The papers' plant at 1 kHz behind an encoder of 1 mrad and a drive of ±5 V.
pub const PLANT: Base<f64> = Base { b: 0.02685, c: 0.11, f1: 0.5 };

/// The plant that the drive moves.
#[derive(Debug)]
pub struct Axis {
    pub state: State<f64>,
    pub base: Base<f64>,
    pub effects: Vec<Effect<f64>>,
    /// Drive of the ticks so far, V: what a delay looks back on.
    pub past: Vec<f64>,
    /// A stop that gives nothing, rad.
    pub stop: Option<f64>,
}

impl Default for Axis {
    fn default() -> Self {
        Self {
            state: Plant { base: PLANT, effects: &[] }.at_rest(0.0),
            base: PLANT,
            effects: Vec::new(),
            past: Vec::new(),
            stop: None,
        }
    }
}

impl Motion for Axis {
    fn counts(&self) -> i32 {
        (self.state.x / STEP).round() as i32
    }
    fn advance(&mut self, code: i16) {
        let volts = f64::from(code) / f64::from(FULL_SCALE_CODE) * FULL_SCALE;
        self.past.push(volts);
        let plant = Plant { base: self.base, effects: &self.effects };
        plant.advance(&mut self.state, Held { u: &self.past, ts: 1.0 / f64::from(TICK_HZ), t: 0.0 }, 4);
        if let Some(stop) = self.stop.filter(|stop| self.state.x > *stop) {
            (self.state.x, self.state.v) = (stop, 0.0);
        }
    }
}

pub type World = breakaway_rig::World<Axis>;

/// A running board and its host.
pub struct Bench<R: Fast = f32> {
    pub world: Shared<Axis>,
    tick: Tick<'static, 'static, Shared<Axis>, TrackController<R>>,
    app: App<'static, 'static, TrackController<R>, Shared<Axis>, NoStore>,
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

impl Bench {
    pub fn new() -> Self {
        Self::with_memory([0; RETAINED_WORDS], settings())
    }

    pub fn with_memory(retained: [u32; RETAINED_WORDS], settings: Settings) -> Self {
        Self::loaded(retained, Loaded::defaults(settings))
    }

    /// With what a store says.
    pub fn loaded(retained: [u32; RETAINED_WORDS], loaded: Loaded) -> Self {
        Self::on(World { retained, ..World::default() }, loaded)
    }

    /// In a world that is already so.
    pub fn on(world: World, loaded: Loaded) -> Self {
        Self::computing(world, loaded)
    }
}

impl<R: Fast> Bench<R> {
    /// In a number type of its own.
    pub fn computing(world: World, loaded: Loaded) -> Self {
        let identity = Identity {
            board: "bench",
            build: "test",
            tick_hz: TICK_HZ,
            drive_max_code: world.stage_limit.unwrap_or(FULL_SCALE_CODE),
            current_range_ma: world.current_range_ma,
            power_stage: if world.simulated { PowerStage::AsSet } else { PowerStage::Bridge },
        };
        let world = Shared(Rc::new(RefCell::new(world)));
        // Leaked: a board has them for ever, too.
        let channels = Box::leak(Box::new(Channels::new()));
        let (tick_end, app_end) = channels.split();
        let guards = guards(&loaded, &identity);
        let tick =
            Tick::new(world.clone(), TrackController::default(), tick_end, TickSettings::at_rate(TICK_HZ), guards);
        let sums = Box::leak(Box::new(Sums::new()));
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
        self.world.0.borrow_mut().advance();
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
