//! The virtual board: the firmware under QEMU, and the simulated plant in lock-step with it (docs/virtual-board.md).
//!
//! What is downstream of its pseudo-terminal cannot tell it from hardware.

mod error;
mod image;
mod injection;
mod lockstep;
mod plant;
mod qemu;
mod relay;

use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, Sender, TryRecvError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use breakaway_core::link::Settings;

pub use error::VirtualBoardError;
pub use image::find as find_image;
pub use injection::{FAULTS, Fault, Injection, MOST_GARBAGE, MOST_NOISE};
use lockstep::{Answer, Lockstep};
pub use plant::{Machine, SimulatedMachine};
use qemu::Qemu;
pub use qemu::find as find_qemu;
use relay::Relay;
pub use relay::{Counts, Traffic};

/// What to start.
#[derive(Clone, Debug)]
pub struct Options {
    /// The firmware's image; `None`: the one that `cargo xtask image` has built.
    pub image: Option<PathBuf>,
    /// The simulated machine.
    pub machine: Machine,
    /// What a board without settings of its own starts with.
    pub settings: Settings,
    /// Virtual time over real time at the most; infinity for as fast as it goes.
    pub speed: f64,
    /// The flash's image: kept there across starts. `None`: blank at every start.
    pub flash: Option<PathBuf>,
    /// Faults to inject, by tick.
    pub faults: Vec<Injection>,
    /// A cable that can be cut and disturbed later on; there is one anyway where the faults above ask for it.
    pub cable: bool,
}

/// What the plant's side has seen of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// Ticks since the start, through resets.
    pub tick: u64,
    /// Drive applied by the board after it, drive codes.
    pub code: i16,
    /// True position, position units.
    pub x: f64,
    /// Starts of the board: 1, and one more per reset.
    pub starts: u32,
}

/// A running virtual board. It ends when this is dropped.
#[derive(Debug)]
pub struct VirtualBoard {
    /// The pseudo-terminal of its link.
    pub port: String,
    orders: Sender<Order>,
    cable: Option<relay::Handle>,
    runner: Option<JoinHandle<Result<(), VirtualBoardError>>>,
}

enum Order {
    Inject(Fault),
    /// Tell what has been seen last.
    Report(Sender<Seen>),
    /// Tell every tick from now on.
    Watch(Sender<Seen>),
    End,
}

impl VirtualBoard {
    /// Starts QEMU and the plant, and waits for the board's first tick.
    ///
    /// # Errors
    /// [`VirtualBoardError`]: QEMU or the image is missing (and the command that brings it), or QEMU does not start.
    pub fn start(options: &Options) -> Result<Self, VirtualBoardError> {
        let image = image::find(options.image.as_deref())?;
        if options.faults.iter().any(|injection| injection.fault == Fault::CorruptFlash) {
            corrupt(options.flash.as_deref().ok_or(VirtualBoardError::NoFlash)?)?;
        }
        let (qemu, lockstep) = Qemu::start(&image, options.flash.as_deref())?;
        let wanted = options.cable || options.faults.iter().any(|injection| injection.fault.on_the_cable());
        let relay = wanted.then(|| Relay::start(&qemu.port, options.machine.seed)).transpose()?;
        let port = relay.as_ref().map_or(&qemu.port, |relay| &relay.port).clone();
        let cable = relay.as_ref().map(Relay::handle);
        let (orders, received) = mpsc::channel();
        let mut faults = options.faults.clone();
        faults.sort_by_key(|fault| fault.tick);
        let mut runner = Runner {
            qemu,
            relay,
            lockstep,
            machine: SimulatedMachine::new(&options.machine),
            settings: options.settings,
            speed: options.speed,
            faults: faults.into(),
            orders: received,
            watchers: Vec::new(),
            seen: Seen::default(),
        };
        runner.boot()?;
        // Until it has said what a board says when it starts.
        for _ in 0..FIRST_TICKS {
            runner.tick()?;
        }
        let runner = std::thread::spawn(move || runner.run());
        Ok(Self { port, orders, cable, runner: Some(runner) })
    }

    /// Makes something go wrong from the next tick on.
    pub fn inject(&self, fault: Fault) {
        // A runner that has ended says why when it is joined.
        let _ = self.orders.send(Order::Inject(fault));
    }

    /// What has passed the cable and what was hit; nothing without one.
    pub fn traffic(&self) -> Traffic {
        self.cable.as_ref().map(relay::Handle::traffic).unwrap_or_default()
    }

    /// What has been seen last; `None` if the board has ended.
    pub fn seen(&self) -> Option<Seen> {
        let (sender, receiver) = mpsc::channel();
        self.orders.send(Order::Report(sender)).ok()?;
        receiver.recv_timeout(Duration::from_secs(10)).ok()
    }

    /// Every tick from now on.
    pub fn watch(&self) -> Receiver<Seen> {
        let (sender, receiver) = mpsc::channel();
        let _ = self.orders.send(Order::Watch(sender));
        receiver
    }

    /// Waits until the board ends by itself, which it does only for an error, or `go_on` says no.
    ///
    /// # Errors
    /// Why it ended.
    pub fn wait(mut self, mut go_on: impl FnMut() -> bool) -> Result<(), VirtualBoardError> {
        while go_on() && self.runner.as_ref().is_some_and(|runner| !runner.is_finished()) {
            std::thread::sleep(Duration::from_millis(50));
        }
        self.end()
    }

    fn end(&mut self) -> Result<(), VirtualBoardError> {
        let _ = self.orders.send(Order::End);
        let Some(runner) = self.runner.take() else {
            return Ok(());
        };
        runner.join().unwrap_or(Err(VirtualBoardError::Lost("the simulation panicked".into())))
    }
}

impl Drop for VirtualBoard {
    fn drop(&mut self) {
        // Whoever wants to know why it ended waits for it.
        let _ = self.end();
    }
}

/// The plant's thread.
struct Runner {
    qemu: Qemu,
    relay: Option<Relay>,
    lockstep: Lockstep,
    machine: SimulatedMachine,
    settings: Settings,
    speed: f64,
    faults: std::collections::VecDeque<Injection>,
    orders: Receiver<Order>,
    watchers: Vec<Sender<Seen>>,
    seen: Seen,
}

/// Flips a bit in every eighth byte of what has been written to a flash's file.
fn corrupt(flash: &Path) -> std::io::Result<()> {
    let mut image = std::fs::read(flash)?;
    image.iter_mut().step_by(8).filter(|byte| **byte != 0xff).for_each(|byte| *byte ^= 0x10);
    std::fs::write(flash, image)
}

/// Ticks before anybody is told of the board.
const FIRST_TICKS: u32 = 20;
/// Behind real time by more than this, it is not made up for.
const LARGEST_LAG: Duration = Duration::from_millis(250);

impl Runner {
    /// Waits for the board's announcement, and starts it.
    fn boot(&mut self) -> Result<(), VirtualBoardError> {
        while self.lockstep.answer(&mut self.qemu)? != Answer::Boot {}
        self.start()
    }

    fn start(&mut self) -> Result<(), VirtualBoardError> {
        self.seen.starts += 1;
        self.lockstep.start(self.machine.tick_hz(), &self.settings)
    }

    fn run(&mut self) -> Result<(), VirtualBoardError> {
        let mut due = Instant::now();
        let period = Duration::from_secs_f64((1.0 / (f64::from(self.machine.tick_hz()) * self.speed)).clamp(0.0, 10.0));
        loop {
            loop {
                match self.orders.try_recv() {
                    Ok(Order::Inject(fault)) => self.inject(fault)?,
                    Ok(Order::Report(sender)) => drop(sender.send(self.seen)),
                    Ok(Order::Watch(sender)) => self.watchers.push(sender),
                    Ok(Order::End) | Err(TryRecvError::Disconnected) => return Ok(()),
                    Err(TryRecvError::Empty) => break,
                }
            }
            while self.faults.front().is_some_and(|fault| fault.tick <= self.seen.tick) {
                if let Some(injection) = self.faults.pop_front() {
                    self.inject(injection.fault)?;
                }
            }
            self.tick()?;
            due += period;
            let now = Instant::now();
            match due.checked_duration_since(now) {
                Some(early) => std::thread::sleep(early),
                None if now.duration_since(due) > LARGEST_LAG => due = now,
                None => {}
            }
        }
    }

    fn tick(&mut self) -> Result<(), VirtualBoardError> {
        self.lockstep.tick(self.machine.count())?;
        let code = match self.lockstep.answer(&mut self.qemu)? {
            Answer::Drive(code) => code,
            // A reset: the tick is lost, the drive is off.
            Answer::Boot => {
                self.start()?;
                0
            }
        };
        self.machine.advance(code);
        self.seen = Seen { tick: self.seen.tick + 1, code, x: self.machine.position(), ..self.seen };
        let seen = self.seen;
        self.watchers.retain(|watcher| watcher.send(seen).is_ok());
        Ok(())
    }

    fn cable(&self) -> Result<&Relay, VirtualBoardError> {
        self.relay.as_ref().ok_or(VirtualBoardError::NoCable)
    }

    fn inject(&mut self, fault: Fault) -> Result<(), VirtualBoardError> {
        match fault {
            Fault::EncoderFrozen => self.machine.freeze(),
            Fault::EncoderChannelDead => self.machine.kill_channel(),
            Fault::EncoderReversed => self.machine.reverse(),
            Fault::EncoderJump(counts) => self.machine.jump(counts),
            Fault::EncoderDead => self.lockstep.condition(4, 1)?,
            Fault::TickLate(us) => self.lockstep.condition(0, us.cast_signed())?,
            Fault::Break(number) => self.lockstep.condition(1, number)?,
            Fault::EmergencyStop => self.lockstep.condition(5, 1)?,
            Fault::Supply(millivolts) => self.lockstep.condition(2, millivolts)?,
            Fault::Reset => self.qemu.reset()?,
            Fault::Garbage(bytes) => self.qemu.garbage(bytes)?,
            Fault::HostGone => self.cable()?.cut(true),
            Fault::LinkNoise(ppm) => self.cable()?.noise(ppm),
            // Done before the start: what the board has read it does not read again.
            Fault::CorruptFlash => {}
            Fault::Healed => {
                self.machine.heal();
                if let Some(cable) = &self.relay {
                    cable.cut(false);
                    cable.noise(0);
                }
                self.lockstep.condition(3, 0)?;
                self.lockstep.condition(4, 0)?;
            }
        }
        Ok(())
    }
}
