//! A virtual board of its own for each test, with the host's client on its pseudo-terminal.

use std::time::{Duration, Instant};

use breakaway::command::run::papers_plant;
use breakaway::command::virtual_board::settings;
use breakaway::device::Client;
use breakaway::device::virtual_board::{Fault, Machine, Options, VirtualBoard, find_qemu};
use breakaway::model::Model;
use breakaway_core::link::{
    BAUD, Command, Ended, Event, FaultCause, FaultRecord, Message, Mode, Reply, Sample, Settings,
};
use breakaway_rig::{FULL_SCALE, STEP, TICK_HZ, relay};

/// The papers' plant at 1 kHz, encoder step 1 mrad, ±5 V, as fast as three times real time.
pub fn options(model: &Model) -> Options {
    let machine = Machine {
        base: model.base,
        effects: model.plant_effects().unwrap(),
        tick_hz: TICK_HZ,
        encoder_step: STEP,
        noise: 0.0,
        drive_full_scale: FULL_SCALE,
        seed: 1,
    };
    let mut settings = settings(&machine, model, 40.0);
    // The client says something every 0.2 s of its own time; on a machine that is busy the board's runs ahead.
    settings.command_timeout_ms = 20_000;
    Options { image: None, machine, settings, speed: 3.0, flash: None, faults: Vec::new(), cable: false }
}

/// Whether there is a QEMU. In CI a missing one is a failure; elsewhere the test says that it was not run.
pub fn qemu() -> bool {
    let Err(error) = find_qemu() else { return true };
    assert!(std::env::var_os("CI").is_none(), "{error}");
    eprintln!("NOT RUN: {error}");
    false
}

pub fn start(options: &Options) -> VirtualBoard {
    // A missing image fails the test with the command that brings it.
    VirtualBoard::start(options).unwrap_or_else(|error| panic!("{error}"))
}

/// A board with a client on it.
pub struct Bench {
    pub board: VirtualBoard,
    pub client: Client,
    pub samples: Vec<Sample>,
    pub events: Vec<Event>,
}

/// Ticks after which no fault is waited for: a minute at 1 kHz.
const LONGEST: u64 = 60_000;

impl Bench {
    pub fn new(change: impl FnOnce(&mut Options)) -> Self {
        let mut options = options(&papers_plant());
        change(&mut options);
        Self::on(start(&options))
    }

    pub fn on(board: VirtualBoard) -> Self {
        let (client, _) = Client::connect(&board.port, BAUD).unwrap_or_else(|error| panic!("{error}"));
        Self { board, client, samples: Vec::new(), events: Vec::new() }
    }

    /// Heals the board. Its next tick has passed then: a command that came before that tick would find the fault there.
    pub fn heal(&self) {
        self.board.inject(Fault::Healed);
        let ticks = self.board.watch();
        assert!(ticks.recv_timeout(Duration::from_secs(10)).is_ok(), "no tick after the board was healed");
    }

    pub fn done(&mut self, command: Command) {
        self.client.done(command).unwrap_or_else(|error| panic!("{error}"));
    }

    /// Takes what the board says until `done` is content.
    pub fn until(&mut self, what: &str, mut done: impl FnMut(&Self) -> bool) {
        let start = Instant::now();
        while !done(self) {
            assert!(start.elapsed() < Duration::from_secs(60), "{what}: not within a minute");
            self.take(Duration::from_millis(20));
        }
    }

    /// Takes the next thing the board says, if it says something within `timeout`; whether it did.
    pub fn take(&mut self, timeout: Duration) -> bool {
        match self.client.receive(timeout).unwrap() {
            Some(Message::Samples(batch)) => self.samples.extend(batch.samples().map(Result::unwrap)),
            Some(Message::Event(event)) => self.events.push(event),
            Some(Message::Reply { .. }) => {}
            None => return false,
        }
        true
    }

    pub fn ended(&self) -> Option<Ended> {
        self.events.iter().find_map(|event| match event {
            Event::ExperimentEnded(ended) => Some(*ended),
            _ => None,
        })
    }

    /// A relay experiment of `ticks`, to its end.
    pub fn run_relay(&mut self, h1: f64, h2: f64, ticks: u32) -> Ended {
        self.events.clear();
        self.done(Command::StartRelay(relay(h1, h2, ticks)));
        self.until("the end of the relay experiment", |bench| bench.ended().is_some());
        self.ended().unwrap()
    }

    /// A relay experiment in full swing, streaming.
    pub fn swing(&mut self) {
        self.done(Command::StreamOn { decimation: 1 });
        self.done(Command::StartRelay(relay(2.0, 1.5, 0)));
        self.until("two seconds of motion", |bench| {
            bench.samples.iter().filter(|sample| sample.mode == Mode::Relay).count() > 2000
        });
    }

    pub fn fault(&mut self) -> Option<FaultRecord> {
        match self.client.request(Command::GetFault).unwrap() {
            Reply::Fault(fault) => fault,
            other => panic!("{other:?}"),
        }
    }

    /// Resets the board by command, and waits until it is up again.
    pub fn reboot(&mut self) {
        let starts = self.board.seen().unwrap().starts;
        self.done(Command::Reboot);
        let begin = Instant::now();
        while self.board.seen().unwrap().starts == starts {
            assert!(begin.elapsed() < Duration::from_secs(20), "the board does not come back");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    pub fn settings(&mut self) -> Settings {
        match self.client.request(Command::GetSettings).unwrap() {
            Reply::Settings(settings) => settings,
            other => panic!("{other:?}"),
        }
    }

    /// Injects a fault and follows the drive, as the plant sees it, until it is off: within `ticks`.
    pub fn breaks(&mut self, fault: Fault, ticks: u64) {
        self.breaks_at(fault, 0, ticks);
    }

    /// The same, where only ticks count that are driven with `least_code` or more, either way. The fault comes first, so that
    /// no tick before it is counted.
    pub fn breaks_at(&mut self, fault: Fault, least_code: u16, ticks: u64) {
        self.board.inject(fault);
        let seen = self.board.watch();
        let first = seen.recv().unwrap();
        let (mut counted, mut quiet) = (0, 0);
        // As long without any drive as the longest stay at 0 of a running relay, which has none.
        while quiet < 50 {
            let now = seen.recv_timeout(Duration::from_secs(20)).expect("ticks");
            quiet = if now.code == 0 { quiet + 1 } else { 0 };
            counted += u64::from(now.code.unsigned_abs() >= least_code);
            assert!(now.code == 0 || counted <= ticks, "{fault:?}: still driven after {counted} ticks");
            assert!(now.tick - first.tick < LONGEST, "{fault:?}: not told from less drive");
            // The host goes on saying that it is there.
            while self.client.receive(Duration::ZERO).is_ok_and(|message| {
                match message {
                    Some(Message::Samples(batch)) => self.samples.extend(batch.samples().map(Result::unwrap)),
                    Some(Message::Event(event)) => self.events.push(event),
                    Some(Message::Reply { .. }) => {}
                    None => return false,
                }
                true
            }) {}
        }
    }

    /// The fault is latched, has been told, and everything up to it has been captured.
    pub fn kept(&mut self, cause: FaultCause) -> FaultRecord {
        self.until("the end of the run", |bench| bench.ended().is_some());
        let record = self.fault().expect("a latched fault");
        assert_eq!(record.cause, cause);
        assert!(self.events.contains(&Event::FaultRaised(record)));
        let ended = self.ended().unwrap();
        self.until("the samples up to the end", |bench| bench.samples.last().is_some_and(|s| s.tick >= ended.tick - 1));
        self.no_gap();
        record
    }

    pub fn no_gap(&self) {
        let gap = self.samples.windows(2).find(|pair| pair[1].tick != pair[0].tick.wrapping_add(1));
        assert!(gap.is_none(), "samples are missing: {gap:?}");
    }
}
