//! A cable that can be cut and that picks up noise: a thread that copies between QEMU's pseudo-terminal and one of ours.
//!
//! It is there only where such a fault is asked for. With nobody at our end, what the board sends is lost, as on a real port.

mod noise;

use std::fs::File;
use std::io::{ErrorKind, Read, Write};
use std::os::fd::OwnedFd;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags, fcntl_setfl};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

use super::VirtualBoardError;
pub use noise::Counts;
use noise::Noise;

/// How often it looks whether it should end, or whether somebody has come.
const LOOK: Timespec = Timespec { tv_sec: 0, tv_nsec: 20_000_000 };
/// Bytes copied at once.
const CHUNK: usize = 512;

/// What has gone over the cable, and what was hit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// From the board to the host.
    pub from_board: Counts,
    /// From the host to the board.
    pub to_board: Counts,
}

impl Traffic {
    /// What has come since `before`.
    #[must_use]
    pub fn since(&self, before: Self) -> Self {
        Self { from_board: self.from_board.since(before.from_board), to_board: self.to_board.since(before.to_board) }
    }
}

#[derive(Debug, Default)]
struct Shared {
    cut: AtomicBool,
    noise_ppm: AtomicU32,
    end: AtomicBool,
    traffic: Mutex<Traffic>,
}

/// The running cable.
#[derive(Debug)]
pub(super) struct Relay {
    /// The pseudo-terminal at the host's end.
    pub port: String,
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

/// What steers it from elsewhere.
#[derive(Clone, Debug)]
pub(super) struct Handle(Arc<Shared>);

impl Handle {
    pub(super) fn traffic(&self) -> Traffic {
        *self.0.traffic.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Relay {
    /// A whole cable to the pseudo-terminal `board`.
    pub(super) fn start(board: &str, seed: u64) -> Result<Self, VirtualBoardError> {
        let at_board =
            rustix::fs::open(board, OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC, Mode::empty())
                .map_err(std::io::Error::from)?;
        let (ours, port) = pseudo_terminal()?;
        raw(&at_board)?;
        let shared = Arc::new(Shared::default());
        let thread = std::thread::spawn({
            let shared = Arc::clone(&shared);
            let mut cable = Cable {
                board: at_board.into(),
                host: ours.into(),
                to_host: Way::new(seed),
                to_board: Way::new(seed.wrapping_add(1)),
            };
            move || {
                while !shared.end.load(Ordering::Relaxed) {
                    cable.copy(&shared);
                }
            }
        });
        Ok(Self { port, shared, thread: Some(thread) })
    }

    /// Nothing gets through any more, either way; or again.
    pub(super) fn cut(&self, cut: bool) {
        self.shared.cut.store(cut, Ordering::Relaxed);
    }

    /// Of a million bytes this many are hit, each way.
    pub(super) fn noise(&self, ppm: u32) {
        self.shared.noise_ppm.store(ppm, Ordering::Relaxed);
    }

    pub(super) fn handle(&self) -> Handle {
        Handle(Arc::clone(&self.shared))
    }
}

impl Drop for Relay {
    fn drop(&mut self) {
        self.shared.end.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// A pseudo-terminal that passes bytes as they are: our end, and the other's name.
fn pseudo_terminal() -> Result<(OwnedFd, String), VirtualBoardError> {
    let open = || -> rustix::io::Result<(OwnedFd, String)> {
        let ours = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
        grantpt(&ours)?;
        unlockpt(&ours)?;
        let port = ptsname(&ours, Vec::new())?.to_string_lossy().into_owned();
        // Opened and closed once: from now on our end is told when nobody is at the other.
        let other = rustix::fs::open(&port, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty())?;
        let mut settings = tcgetattr(&other)?;
        settings.make_raw();
        tcsetattr(&other, OptionalActions::Now, &settings)?;
        fcntl_setfl(&ours, OFlags::RDWR | OFlags::NONBLOCK)?;
        Ok((ours, port))
    };
    open().map_err(|error| VirtualBoardError::Io(error.into()))
}

fn raw(terminal: &OwnedFd) -> Result<(), VirtualBoardError> {
    let set = || {
        let mut settings = tcgetattr(terminal)?;
        settings.make_raw();
        tcsetattr(terminal, OptionalActions::Now, &settings)
    };
    set().map_err(|error| VirtualBoardError::Io(error.into()))
}

/// Both ends, and what is on its way between them.
struct Cable {
    board: File,
    host: File,
    to_host: Way,
    to_board: Way,
}

/// One direction.
struct Way {
    noise: Noise,
    waiting: Vec<u8>,
}

impl Way {
    fn new(seed: u64) -> Self {
        Self { noise: Noise::new(seed), waiting: Vec::new() }
    }

    /// What the end that it comes from has, if all before is out.
    fn take(&mut self, from: &mut File, ppm: u32) {
        let mut bytes = [0; CHUNK];
        if let (true, Ok(count)) = (self.waiting.is_empty(), from.read(&mut bytes)) {
            self.noise.transmit(&bytes[..count], ppm, &mut self.waiting);
        }
    }

    /// Hands on what the other end takes now. `false` where there is none.
    fn give(&mut self, to: &mut File) -> bool {
        while !self.waiting.is_empty() {
            match to.write(&self.waiting) {
                Ok(count) => drop(self.waiting.drain(..count)),
                Err(error) if error.kind() == ErrorKind::WouldBlock => return true,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(_) => {
                    self.waiting.clear();
                    return false;
                }
            }
        }
        true
    }
}

impl Cable {
    /// Waits for something to copy, a moment at the most, and copies it.
    fn copy(&mut self, shared: &Shared) {
        let wants = |way: &Way, back: &Way| {
            let read = if way.waiting.is_empty() { PollFlags::IN } else { PollFlags::empty() };
            let write = if back.waiting.is_empty() { PollFlags::empty() } else { PollFlags::OUT };
            read | write
        };
        let mut ends = [
            PollFd::new(&self.board, wants(&self.to_host, &self.to_board)),
            PollFd::new(&self.host, wants(&self.to_board, &self.to_host)),
        ];
        // An interrupted wait is a short one.
        let _ = poll(&mut ends, Some(&LOOK));
        let nobody = ends[1].revents().contains(PollFlags::HUP);
        let ppm = shared.noise_ppm.load(Ordering::Relaxed);
        self.to_host.take(&mut self.board, ppm);
        if !nobody {
            self.to_board.take(&mut self.host, ppm);
        }
        if shared.cut.load(Ordering::Relaxed) || nobody {
            self.to_host.waiting.clear();
        }
        if shared.cut.load(Ordering::Relaxed) {
            self.to_board.waiting.clear();
        }
        self.to_host.give(&mut self.host);
        self.to_board.give(&mut self.board);
        let traffic = Traffic { from_board: self.to_host.noise.counts, to_board: self.to_board.noise.counts };
        *shared.traffic.lock().unwrap_or_else(PoisonError::into_inner) = traffic;
        if nobody {
            // A terminal without a host is ready all the time.
            std::thread::sleep(Duration::from_millis(2));
        }
    }
}

#[cfg(test)]
mod tests;
