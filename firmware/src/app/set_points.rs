//! Set-points on their way from the thread to the controller in the tick.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use breakaway_core::link::MOST_AHEAD;
use heapless_spsc::spsc::{Consumer, Producer, Queue};

/// One less fits.
const QUEUE: usize = MOST_AHEAD + 1;

/// The queue between thread and tick. A knot is a set-point in the controller's own numbers.
pub(super) struct SetPointQueue<K> {
    knots: Queue<K, QUEUE>,
    complete: AtomicBool,
    dry: AtomicU32,
}

/// The thread's end.
pub struct SetPointInlet<'q, K> {
    knots: Producer<'q, K, QUEUE>,
    complete: &'q AtomicBool,
    dry: &'q AtomicU32,
}

/// The tick's end.
pub struct SetPointOutlet<'q, K> {
    knots: Consumer<'q, K, QUEUE>,
    complete: &'q AtomicBool,
    dry: &'q AtomicU32,
}

impl<K> SetPointQueue<K> {
    pub(super) const fn new() -> Self {
        Self { knots: Queue::new(), complete: AtomicBool::new(false), dry: AtomicU32::new(0) }
    }

    pub(super) fn split(&mut self) -> (SetPointInlet<'_, K>, SetPointOutlet<'_, K>) {
        let (producer, consumer) = self.knots.split();
        let (complete, dry) = (&self.complete, &self.dry);
        (SetPointInlet { knots: producer, complete, dry }, SetPointOutlet { knots: consumer, complete, dry })
    }
}

impl<K> SetPointInlet<'_, K> {
    /// So many more fit.
    pub(super) fn room(&self) -> usize {
        self.knots.capacity() - self.knots.len()
    }

    /// Adds one. One for which there is no room is lost: the caller asks first.
    pub(super) fn put(&mut self, knot: K) {
        let _ = self.knots.enqueue(knot);
    }

    /// None follow.
    pub(super) fn complete(&self) {
        self.complete.store(true, Ordering::Release);
    }

    /// How often they ran dry in this run.
    pub(super) fn dry(&self) -> u32 {
        self.dry.load(Ordering::Acquire)
    }
}

impl<K> SetPointOutlet<'_, K> {
    /// So many wait.
    pub(super) fn waiting(&self) -> usize {
        self.knots.len()
    }

    /// The next.
    pub(super) fn take(&mut self) -> Option<K> {
        self.knots.dequeue()
    }

    /// None follow those that wait.
    pub(super) fn is_complete(&self) -> bool {
        self.complete.load(Ordering::Acquire)
    }

    /// They have run dry. Load and store, no exchange: only the tick writes it.
    pub(super) fn ran_dry(&self) {
        self.dry.store(self.dry.load(Ordering::Acquire).wrapping_add(1), Ordering::Release);
    }

    /// A new run: what is left of the one before goes. The thread puts nothing here before the run has been answered.
    pub(super) fn clear(&mut self) {
        while self.take().is_some() {}
        self.complete.store(false, Ordering::Release);
        self.dry.store(0, Ordering::Release);
    }
}
