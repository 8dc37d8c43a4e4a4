//! The monitor beside a run of the same process.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use super::{connect, screen};
use crate::interrupt::finish_first;

/// The screen, until it is dropped. It is a guest of this process's own port.
#[derive(Debug)]
pub struct Beside {
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<anyhow::Result<()>>>,
}

impl Beside {
    /// Opens the screen. `q` closes it and leaves the run alone; `s` and Ctrl-C end the run.
    ///
    /// # Errors
    /// The port is not shared.
    pub fn open(port: &str, baud: u32, plain: bool) -> anyhow::Result<Self> {
        let connected = connect(port, baud)?;
        let over = Arc::new(AtomicBool::new(false));
        let thread = std::thread::spawn({
            let (port, over) = (port.to_owned(), Arc::clone(&over));
            move || screen(connected, &port, baud, plain, &finish_first(), Some(&over))
        });
        Ok(Self { over, thread: Some(thread) })
    }
}

impl Drop for Beside {
    fn drop(&mut self) {
        self.over.store(true, Ordering::SeqCst);
        if let Some(thread) = self.thread.take() {
            // A terminal that fails costs the screen, not the run.
            let _ = thread.join();
        }
    }
}
