//! A guest at the holder: a thread that reads its requests, one that writes what is for it.

use std::io::{self, Read, Write};
use std::net::Shutdown;
use std::sync::mpsc::{self, SyncSender, TrySendError};
use std::sync::{Arc, Weak};

use breakaway_core::link::{Decoder, Request};

use super::hub::Hub;
use super::socket::Stream;

/// Frames that wait for a guest: 5 s of samples at 10 kHz. Later ones are lost, as on a link that is too slow.
const WAITING: usize = 1024;

/// A guest, for as long as it stays.
pub(super) struct Guest {
    pub number: u64,
    frames: SyncSender<Arc<[u8]>>,
    stream: Stream,
}

impl Guest {
    /// Starts its threads.
    ///
    /// # Errors
    /// Its socket is gone.
    pub(super) fn start(number: u64, stream: Stream, hub: &Arc<Hub>) -> io::Result<Self> {
        let (frames, waiting) = mpsc::sync_channel::<Arc<[u8]>>(WAITING);
        let (mut reading, mut writing) = (stream.try_clone()?, stream.try_clone()?);
        std::thread::spawn(move || {
            for frame in waiting {
                if writing.write_all(&frame).is_err() {
                    break;
                }
            }
            let _ = writing.shutdown(Shutdown::Both);
        });
        // The hub keeps its guests, and no guest the hub.
        let hub = Arc::downgrade(hub);
        std::thread::spawn(move || {
            listen(&mut reading, number, &hub);
            if let Some(hub) = hub.upgrade() {
                hub.leave(number);
            }
        });
        Ok(Self { number, frames, stream })
    }

    /// Sends a frame, if there is room; whether the guest is still there.
    pub(super) fn send(&self, frame: Arc<[u8]>) -> bool {
        !matches!(self.frames.try_send(frame), Err(TrySendError::Disconnected(_)))
    }
}

impl Drop for Guest {
    fn drop(&mut self) {
        let _ = self.stream.shutdown(Shutdown::Both);
    }
}

/// Reads requests until the guest or the hub is gone.
fn listen(stream: &mut impl Read, number: u64, hub: &Weak<Hub>) {
    let mut decoder = Decoder::new();
    let mut buffer = [0; 1024];
    loop {
        let count = match stream.read(&mut buffer) {
            Ok(0) => return,
            Ok(count) => count,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(_) => return,
        };
        for byte in buffer.iter().take(count) {
            // What is no request is not answered, as by a board.
            let Some(Ok(Ok(request))) = decoder.push(*byte).map(|message| message.map(Request::decode)) else {
                continue;
            };
            let Some(hub) = hub.upgrade() else { return };
            hub.request(number, request);
        }
    }
}
