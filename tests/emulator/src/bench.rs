//! The host of an emulated board, in the board's own time: no threads, and the same bytes at the same cycles in every run.

use breakaway::command::run::papers_plant;
use breakaway::device::virtual_board::Machine as Axis;
use breakaway_core::link::{
    Command, Decoder, Ended, Event, FaultRecord, Info, MAX_FRAME, Message, Reply, Request, Sample, Settings, encode,
};

use crate::bus::{Bus, CORE_HZ, STEP_CYCLES};
use crate::flash::Cells;
use crate::machine::{Machine, Violation};
use crate::unicorn::{NoUnicorn, in_images};
use crate::winding::Winding;

/// What `cargo xtask test` calls the image.
const IMAGE: &str = "nucleo-g474re.elf";
/// Cycles in a millisecond.
pub const MS: u64 = CORE_HZ / 1000;
/// Ticks of the board in a second.
pub const TICK_HZ: u32 = 10_000;
/// Cycles of a tick.
pub const TICK: u64 = CORE_HZ / TICK_HZ as u64;
/// How often the host says that it is there.
const KEEP_ALIVE: u64 = 100 * MS;
/// How long an answer may take: an erase takes 22 ms, and the board solves equations in some.
const REPLY: u64 = 2000 * MS;
/// In how small steps the host looks at what has come.
const LOOK: u64 = MS;

/// A board with its host.
pub struct Bench {
    /// The board.
    pub machine: Machine,
    /// Samples that have come.
    pub samples: Vec<Sample>,
    /// Events that have come.
    pub events: Vec<Event>,
    /// The host says now and then that it is there.
    pub alive: bool,
    decoder: Decoder,
    replies: Vec<(u16, Reply)>,
    next_id: u16,
    said_at: u64,
}

/// The papers' plant, ±5 V at full scale, 1 mrad for a count: as on the virtual board.
pub fn axis() -> Axis {
    Axis {
        base: papers_plant().base,
        effects: Vec::new(),
        tick_hz: (CORE_HZ / STEP_CYCLES) as u32,
        encoder_step: 1e-3,
        noise: 0.0,
        drive_full_scale: 5.0,
        seed: 1,
    }
}

impl Bench {
    /// Power-on with a blank flash, until the board says that it has started.
    ///
    /// # Errors
    /// [`NoUnicorn`].
    pub fn start() -> Result<Self, NoUnicorn> {
        Self::with(&axis(), Cells::blank())
    }

    /// Power-on with an axis and cells.
    ///
    /// # Errors
    /// [`NoUnicorn`].
    ///
    /// # Panics
    /// If there is no image, or it does not start.
    pub fn with(axis: &Axis, cells: Cells) -> Result<Self, NoUnicorn> {
        Self::set_up(axis, cells, |_| {})
    }

    fn set_up(axis: &Axis, cells: Cells, change: impl FnOnce(&mut Bus)) -> Result<Self, NoUnicorn> {
        let image = in_images(IMAGE).unwrap_or_else(|| panic!("no images/{IMAGE}: `cargo xtask emulator` builds it"));
        let mut bench = Self {
            machine: Machine::power_on(&image, axis, cells)?,
            samples: Vec::new(),
            events: Vec::new(),
            alive: true,
            decoder: Decoder::new(),
            replies: Vec::new(),
            next_id: 1,
            said_at: 0,
        };
        change(bench.machine.bus());
        bench.started();
        Ok(bench)
    }

    /// The same with a winding, and with the shunt amplifier. The axis has its back-EMF in the winding, not in c.
    ///
    /// # Errors
    /// [`NoUnicorn`].
    ///
    /// # Panics
    /// As [`Bench::with`].
    pub fn with_winding(winding: Winding) -> Result<Self, NoUnicorn> {
        Self::with_amplifier(winding, 0.0, [false; 2])
    }

    /// The same with an amplifier that is off by so many V, and with wires to PC1 and PB1 that are off.
    ///
    /// # Errors
    /// [`NoUnicorn`].
    ///
    /// # Panics
    /// As [`Bench::with`].
    pub fn with_amplifier(winding: Winding, offset: f64, cut: [bool; 2]) -> Result<Self, NoUnicorn> {
        let mut axis = axis();
        axis.base.c -= winding.back_emf;
        axis.drive_full_scale = 2.0 * winding.supply;
        Self::set_up(&axis, Cells::blank(), |bus| {
            bus.winding = Some(winding);
            (bus.analog.offset, bus.analog.cut) = (offset, cut);
        })
    }

    /// Runs until the board says that it has started.
    ///
    /// # Panics
    /// If it does not within 0.1 s.
    pub fn started(&mut self) {
        self.decoder = Decoder::new();
        self.events.clear();
        self.until("the start", 100, |bench| bench.events.contains(&Event::Started));
    }

    /// Cycles since power-on.
    pub fn now(&mut self) -> u64 {
        self.machine.bus().time
    }

    /// Runs for so many cycles, and takes what comes.
    ///
    /// # Errors
    /// The rule that the image has broken.
    pub fn try_run(&mut self, cycles: u64) -> Result<(), Violation> {
        let end = self.now() + cycles;
        while self.now() < end {
            let now = self.now();
            if self.alive && now > self.said_at + KEEP_ALIVE {
                self.send(Command::Status);
            }
            let result = self.machine.run_until(end.min(now + LOOK));
            self.take();
            result?;
        }
        Ok(())
    }

    /// As [`Bench::try_run`], with no rule broken.
    ///
    /// # Panics
    /// If one was.
    pub fn run(&mut self, cycles: u64) {
        self.try_run(cycles).unwrap_or_else(|violation| panic!("{violation}"));
    }

    fn take(&mut self) {
        let bytes: Vec<u8> = self.machine.bus().link.from_board.drain(..).collect();
        for byte in bytes {
            let Some(Ok(frame)) = self.decoder.push(byte) else { continue };
            match Message::decode(frame) {
                Some(Message::Samples(batch)) => self.samples.extend(batch.samples().filter_map(Result::ok)),
                Some(Message::Event(event)) => self.events.push(event),
                Some(Message::Reply { id, reply }) => self.replies.push((id, reply)),
                None => {}
            }
        }
    }

    /// Sends a command.
    ///
    /// # Panics
    /// If it has no frame.
    pub fn send(&mut self, command: Command) -> u16 {
        let id = self.next_id;
        self.next_id += 1;
        let mut frame = [0; MAX_FRAME];
        let used = encode(&Request { id, command }, &mut frame).unwrap_or_else(|error| panic!("{error:?}"));
        self.said_at = self.now();
        self.machine.bus().link.to_board.extend(&frame[..used]);
        id
    }

    /// Runs until `done` is content.
    ///
    /// # Panics
    /// If it is not within so many milliseconds.
    pub fn until(&mut self, what: &str, within_ms: u64, mut done: impl FnMut(&Self) -> bool) {
        let end = self.now() + within_ms * MS;
        while !done(self) {
            let (pc, function) = self.machine.place();
            assert!(self.now() < end, "{what}: not within {within_ms} ms; at {pc:#010x} in {function}");
            self.run(LOOK);
        }
    }

    /// Sends a command and waits for its reply.
    ///
    /// # Panics
    /// If none comes.
    pub fn request(&mut self, command: Command) -> Reply {
        self.replies.clear();
        let id = self.send(command);
        self.until("a reply", REPLY / MS, |bench| bench.replies.iter().any(|(other, _)| *other == id));
        let at = self.replies.iter().position(|(other, _)| *other == id).unwrap_or_default();
        self.replies.swap_remove(at).1
    }

    /// Sends a command that is answered by `Done`.
    ///
    /// # Panics
    /// If it is not.
    pub fn done(&mut self, command: Command) {
        let reply = self.request(command);
        assert!(matches!(reply, Reply::Done), "{reply:?}");
    }

    /// What the board says of itself.
    ///
    /// # Panics
    /// If it does not.
    pub fn info(&mut self) -> Info {
        match self.request(Command::Hello) {
            Reply::Info(info) => info,
            other => panic!("{other:?}"),
        }
    }

    /// The settings.
    ///
    /// # Panics
    /// If the board does not send them.
    pub fn settings(&mut self) -> Settings {
        match self.request(Command::GetSettings) {
            Reply::Settings(settings) => settings,
            other => panic!("{other:?}"),
        }
    }

    /// The latched fault.
    ///
    /// # Panics
    /// If the board does not answer.
    pub fn fault(&mut self) -> Option<FaultRecord> {
        match self.request(Command::GetFault) {
            Reply::Fault(fault) => fault,
            other => panic!("{other:?}"),
        }
    }

    /// How the last run has ended, if it has.
    pub fn ended(&self) -> Option<Ended> {
        self.events.iter().rev().find_map(|event| match event {
            Event::ExperimentEnded(ended) => Some(*ended),
            _ => None,
        })
    }
}
