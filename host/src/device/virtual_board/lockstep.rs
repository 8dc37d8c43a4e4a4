//! The plant's end of the lock-step (firmware/src/board/mps2_an386/lockstep.rs has the format).

use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use breakaway_core::link::Settings;

use super::VirtualBoardError;
use super::qemu::Qemu;

/// What a board says when it has started.
const BOOT: i16 = i16::MIN;
/// How long a tick may take: on-board identification is solved between two of them, on a busy machine.
const LONGEST_TICK: Duration = Duration::from_secs(20);
/// How often QEMU is looked after while waiting.
const LOOK: Duration = Duration::from_millis(500);

/// What the board says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Answer {
    /// Drive code applied after the tick.
    Drive(i16),
    /// It has started and asks for its start message.
    Boot,
}

/// The connection.
#[derive(Debug)]
pub(super) struct Lockstep {
    stream: UnixStream,
    /// Count of the last tick; `None` before the first since the board's start.
    last: Option<i32>,
}

impl Lockstep {
    pub(super) fn new(stream: UnixStream) -> std::io::Result<Self> {
        stream.set_read_timeout(Some(LOOK))?;
        Ok(Self { stream, last: None })
    }

    /// The first message after its announcement.
    pub(super) fn start(&mut self, tick_hz: u32, settings: &Settings) -> Result<(), VirtualBoardError> {
        self.last = None;
        let mut buffer = [0; 128];
        let settings = postcard::to_slice(settings, &mut buffer);
        let settings = settings.map_err(|error| VirtualBoardError::NotStarted(error.to_string()))?;
        let mut message = vec![0x82];
        message.extend(tick_hz.to_le_bytes());
        message.push(settings.len() as u8);
        message.extend(&*settings);
        self.send(&message)
    }

    pub(super) fn tick(&mut self, count: i32) -> Result<(), VirtualBoardError> {
        let step = self.last.map(|last| count.wrapping_sub(last));
        self.last = Some(count);
        match step {
            Some(step @ -64..64) => self.send(&[step as u8 & 0x7f]),
            _ => self.numbered(&[0x80], count),
        }
    }

    pub(super) fn condition(&mut self, what: u8, value: i32) -> Result<(), VirtualBoardError> {
        self.numbered(&[0x81, what], value)
    }

    fn numbered(&mut self, head: &[u8], value: i32) -> Result<(), VirtualBoardError> {
        let mut message = head.to_vec();
        message.extend(value.to_le_bytes());
        self.send(&message)
    }

    fn send(&mut self, message: &[u8]) -> Result<(), VirtualBoardError> {
        self.stream.write_all(message).map_err(|error| VirtualBoardError::Lost(error.to_string()))
    }

    /// Waits for the board.
    pub(super) fn answer(&mut self, qemu: &mut Qemu) -> Result<Answer, VirtualBoardError> {
        let mut bytes = [0; 2];
        let mut read = 0;
        let start = Instant::now();
        while read < bytes.len() {
            match self.stream.read(&mut bytes[read..]) {
                Ok(0) => return Err(qemu.epitaph("QEMU closed the connection")),
                Ok(n) => read += n,
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
                    if start.elapsed() > LONGEST_TICK {
                        return Err(qemu.epitaph("the firmware does not answer"));
                    }
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(qemu.epitaph(&error.to_string())),
            }
        }
        Ok(match i16::from_le_bytes(bytes) {
            BOOT => Answer::Boot,
            code => Answer::Drive(code),
        })
    }
}
