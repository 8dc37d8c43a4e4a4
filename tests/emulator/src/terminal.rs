//! The board's link on a pseudo-terminal, for programs that know only ports: as fast as the emulation goes.

use std::fs::File;
use std::io::{ErrorKind, Read as _, Write as _};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use rustix::fs::{Mode, OFlags, fcntl_setfl, open};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

use crate::bench::{Bench, MS};

/// A board in a thread of its own.
pub struct Terminal {
    /// Its port.
    pub port: String,
    end: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Terminal {
    /// Starts a board that `make` has prepared: in the thread in which it goes on.
    ///
    /// # Errors
    /// The system gives no pseudo-terminal.
    pub fn serve(make: impl FnOnce() -> Bench + Send + 'static) -> std::io::Result<Self> {
        let ours = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
        grantpt(&ours)?;
        unlockpt(&ours)?;
        let port = ptsname(&ours, Vec::new())?.to_string_lossy().into_owned();
        // Kept open: bytes that come before anybody is there are not an error.
        let other = open(&port, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty())?;
        let mut settings = tcgetattr(&other)?;
        settings.make_raw();
        tcsetattr(&other, OptionalActions::Now, &settings)?;
        fcntl_setfl(&ours, OFlags::RDWR | OFlags::NONBLOCK)?;
        let end = Arc::new(AtomicBool::new(false));
        let thread = std::thread::spawn({
            let end = Arc::clone(&end);
            move || {
                let _other = other;
                let (mut bench, mut ours) = (make(), File::from(ours));
                let mut waiting = Vec::new();
                while !end.load(Ordering::Relaxed) {
                    copy(&mut bench, &mut ours, &mut waiting);
                }
            }
        });
        Ok(Self { port, end, thread: Some(thread) })
    }
}

/// A millisecond of the board, and its bytes.
fn copy(bench: &mut Bench, ours: &mut File, waiting: &mut Vec<u8>) {
    let mut buffer = [0; 512];
    if let Ok(read @ 1..) = ours.read(&mut buffer) {
        bench.machine.bus().link.to_board.extend(&buffer[..read]);
    }
    let end = bench.now() + MS;
    bench.machine.run_until(end).unwrap_or_else(|violation| panic!("{violation}"));
    waiting.extend(bench.machine.bus().link.from_board.drain(..));
    while !waiting.is_empty() {
        match ours.write(waiting) {
            Ok(written) => drop(waiting.drain(..written)),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            // Nobody reads just now.
            Err(_) => break,
        }
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        self.end.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // What it has to say is said.
            let _ = thread.join();
        }
    }
}
