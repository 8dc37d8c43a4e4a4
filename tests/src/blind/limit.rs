//! Processor time, and an end to a case that takes too much of it.

use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

/// Time between two looks at the clock.
const LOOK: Duration = Duration::from_millis(500);

/// Processor time of this process so far, all its threads, s; on a shared machine it says more than a wall clock.
/// `None` where there is no /proc.
pub fn processor_s() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The name, in brackets, may hold blanks. User and system time are the 14th and 15th word, in hundredths on every Linux.
    let words: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks = |i: usize| words.get(i).and_then(|word| word.parse::<f64>().ok());
    Some((ticks(11)? + ticks(12)?) / 100.0)
}

/// A clock that starts now: processor time where there is any, else the wall's.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    started: Instant,
    processor_s: Option<f64>,
}

impl Clock {
    /// Starts.
    pub fn start() -> Self {
        Self { started: Instant::now(), processor_s: processor_s() }
    }

    /// Processor time since, s.
    pub fn processor_s(&self) -> Option<f64> {
        Some(processor_s()? - self.processor_s?)
    }

    /// Processor time since, or that of the wall, s.
    pub fn seconds(&self) -> f64 {
        self.processor_s().unwrap_or_else(|| self.started.elapsed().as_secs_f64())
    }
}

/// A watch over one case; dropped, it watches no longer.
#[derive(Debug)]
pub struct Watch {
    _done: Sender<()>,
}

impl Watch {
    /// Calls `over` on another thread once the clock shows more than `limit_s`.
    pub fn start(clock: Clock, limit_s: f64, over: impl FnOnce() + Send + 'static) -> Self {
        let (done, ended): (Sender<()>, Receiver<()>) = channel();
        std::thread::spawn(move || {
            while ended.recv_timeout(LOOK) == Err(RecvTimeoutError::Timeout) {
                if clock.seconds() > limit_s {
                    return over();
                }
            }
        });
        Self { _done: done }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A watch with no limit calls at its first look; one that is dropped does not call.
    #[test]
    fn a_watch_calls_unless_it_is_dropped() {
        let (called, calls) = channel();
        let watch = Watch::start(Clock::start(), -1.0, move || called.send(()).unwrap());
        calls.recv().unwrap();
        drop(watch);
        let (called, calls) = channel::<()>();
        drop(Watch::start(Clock::start(), -1.0, move || called.send(()).unwrap()));
        assert!(calls.recv().is_err(), "the thread ended and dropped its sender");
    }
}
