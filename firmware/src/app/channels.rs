//! What tick and thread tell each other: single-producer queues and a flag, no locks.

use core::sync::atomic::{AtomicBool, Ordering};

use breakaway_core::link::{Bounds, CommandError, Ended, Ending, FaultRecord, Sample, WaveformPart};
use heapless_spsc::spsc::{Consumer, Producer, Queue};

use super::accumulate::{Accumulation, SineConfig, Sums};
use super::control::ControlPlan;
use super::guard::Guards;
use super::run::RunOrder;
use super::set_points::{SetPointInlet, SetPointOutlet, SetPointQueue};

/// Samples that wait for the thread; one less fits. 6 ms at 10 kHz; a power of two, whose remainder is a mask.
pub const SAMPLE_QUEUE: usize = 64;
/// Orders that wait for the tick, which takes one per tick.
const ORDER_QUEUE: usize = 4;
/// Runs that wait for the tick; one less fits. The thread asks for one at a time.
const RUN_QUEUE: usize = 2;
/// Events that wait for the thread. The tick holds back what finds no room.
const EVENT_QUEUE: usize = 4;

/// What the thread asks of the tick, beside runs.
#[derive(Debug)]
#[allow(clippy::large_enum_variant)] // All of them live in one queue; boxes do not exist here.
pub enum Order<'a> {
    /// End the run by command. Answered.
    Stop,
    /// Unlatch the fault. Answered.
    ClearFault,
    /// New guards, from new settings. Answered.
    Guards(Guards),
    /// The present position is this count from now on. Answered.
    Zero(i32),
    /// Points of the waveform table. Answered.
    Waveform(WaveformPart),
    /// End the run for this reason, which the thread has found in the samples.
    End(Ending),
    /// Latch a fault that the thread has found.
    Fault(FaultRecord),
    /// Sum the run's samples from the next tick on, until [`Order::Collect`] or the end of the run.
    Accumulate(SineConfig, &'a mut Sums),
    /// Give the sums back.
    Collect,
}

/// What the tick tells the thread.
#[derive(Debug)]
pub enum TickEvent<'a> {
    /// Done, or why not.
    Answer(Result<(), CommandError>),
    /// A fault is latched; the drive is off.
    Fault(FaultRecord),
    /// A run has ended; the drive is off.
    Ended(Ended),
    /// Late ticks since the reset.
    Overruns(u32),
    /// The sums, given back.
    Sums(Accumulation<'a>),
}

/// A run with its bounds, and the current loop where the drive is a current.
pub type RunRequest<P> = (RunOrder<P>, Bounds, Option<<P as ControlPlan>::Current>);

/// The queues between tick and thread.
pub struct Channels<'a, P: ControlPlan> {
    orders: Queue<Order<'a>, ORDER_QUEUE>,
    runs: Queue<RunRequest<P>, RUN_QUEUE>,
    events: Queue<TickEvent<'a>, EVENT_QUEUE>,
    samples: Queue<Sample, SAMPLE_QUEUE>,
    set_points: SetPointQueue<P::Knot>,
    alive: AtomicBool,
}

/// The tick's end.
pub struct TickEnd<'q, 'a, P: ControlPlan> {
    pub(super) orders: Consumer<'q, Order<'a>, ORDER_QUEUE>,
    pub(super) runs: Consumer<'q, RunRequest<P>, RUN_QUEUE>,
    pub(super) events: Producer<'q, TickEvent<'a>, EVENT_QUEUE>,
    pub(super) samples: Producer<'q, Sample, SAMPLE_QUEUE>,
    pub(super) set_points: SetPointOutlet<'q, P::Knot>,
    alive: &'q AtomicBool,
}

/// The thread's end.
pub struct AppEnd<'q, 'a, P: ControlPlan> {
    /// Orders to the tick.
    pub orders: Producer<'q, Order<'a>, ORDER_QUEUE>,
    /// Runs to start, which the tick takes after all orders. Each is answered.
    pub runs: Producer<'q, RunRequest<P>, RUN_QUEUE>,
    /// Events from the tick.
    pub events: Consumer<'q, TickEvent<'a>, EVENT_QUEUE>,
    /// Samples from the tick.
    pub samples: Consumer<'q, Sample, SAMPLE_QUEUE>,
    /// Set-points to the tick, once a run along them is answered.
    pub set_points: SetPointInlet<'q, P::Knot>,
    alive: &'q AtomicBool,
}

impl<P: ControlPlan> Channels<'_, P> {
    /// Empty queues.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            orders: Queue::new(),
            runs: Queue::new(),
            events: Queue::new(),
            samples: Queue::new(),
            set_points: SetPointQueue::new(),
            alive: AtomicBool::new(false),
        }
    }
}

impl<'a, P: ControlPlan> Channels<'a, P> {
    /// Both ends.
    pub fn split(&mut self) -> (TickEnd<'_, 'a, P>, AppEnd<'_, 'a, P>) {
        let (to_tick, orders) = self.orders.split();
        let (to_start, runs) = self.runs.split();
        let (events, from_tick) = self.events.split();
        let (samples, recorded) = self.samples.split();
        let (points, due) = self.set_points.split();
        let alive = &self.alive;
        (
            TickEnd { orders, runs, events, samples, set_points: due, alive },
            AppEnd { orders: to_tick, runs: to_start, events: from_tick, samples: recorded, set_points: points, alive },
        )
    }
}

impl<P: ControlPlan> Default for Channels<'_, P> {
    fn default() -> Self {
        Self::new()
    }
}

impl<P: ControlPlan> TickEnd<'_, '_, P> {
    /// Whether a valid command has arrived since the last call.
    ///
    /// Load and store, no exchange (Cortex-M0 has none): the tick interrupts the thread, never the other way round.
    pub(super) fn alive(&self) -> bool {
        let alive = self.alive.load(Ordering::Acquire);
        if alive {
            self.alive.store(false, Ordering::Release);
        }
        alive
    }
}

impl<P: ControlPlan> AppEnd<'_, '_, P> {
    /// Tells the tick that a valid command has arrived.
    pub fn alive(&self) {
        self.alive.store(true, Ordering::Release);
    }
}
