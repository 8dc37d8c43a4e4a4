//! Frames: `COBS(message ‖ CRC-32 of the message, little endian) ‖ 0`.
//!
//! Zero bytes occur only at the end of frames, so a receiver that has lost bytes is in step again after the next one.
//! The CRC finds damaged bytes in between. Two zeros in a row are no frame and no error: a sender may put one in
//! front.

use crate::says::says;
use crc::{CRC_32_ISO_HDLC, Crc, NoTable};
use serde::Serialize;

/// Longest message, bytes: with its CRC it is one COBS block.
pub const MAX_MESSAGE: usize = 250;
const CRC_BYTES: usize = 4;
/// Longest frame, bytes: one of COBS overhead and the zero at the end.
pub const MAX_FRAME: usize = MAX_MESSAGE + CRC_BYTES + 2;

/// Without a table of 1 KiB: a frame of 256 bytes takes a Cortex-M4 about 15 000 cycles in the thread.
static CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// CRC-32 (ISO-HDLC) of bytes: that of the frames, and of what a board keeps.
#[must_use]
#[inline(never)]
pub fn checksum(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// A message that is longer than [`MAX_MESSAGE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncodeError;

says! { EncodeError:
    Self => "the message does not fit into a frame",
}

/// Why a frame was thrown away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameError {
    /// More than [`MAX_FRAME`] bytes without a zero.
    TooLong,
    /// Not COBS, or shorter than a CRC.
    Damaged,
    /// The CRC does not match.
    Crc,
}

says! { FrameError:
    Self::TooLong => "the frame is too long",
    Self::Damaged => "the frame is damaged",
    Self::Crc => "the frame's checksum does not match",
}

/// Writes `message` as a frame; returns the frame's length.
///
/// # Errors
/// [`EncodeError`] if the message does not fit.
pub fn encode<T: Serialize>(message: &T, frame: &mut [u8; MAX_FRAME]) -> Result<usize, EncodeError> {
    let mut raw = [0; MAX_MESSAGE + CRC_BYTES];
    let (body, _) = raw.split_at_mut(MAX_MESSAGE);
    let length = postcard::to_slice(message, body).map_err(|_| EncodeError)?.len();
    let crc = checksum(raw.get(..length).ok_or(EncodeError)?);
    let end = length + CRC_BYTES;
    raw.get_mut(length..end).ok_or(EncodeError)?.copy_from_slice(&crc.to_le_bytes());
    let source = raw.get(..end).ok_or(EncodeError)?;
    let used = cobs::try_encode(source, frame).map_err(|_| EncodeError)?;
    *frame.get_mut(used).ok_or(EncodeError)? = 0;
    Ok(used + 1)
}

/// Finds the frames in a stream of arbitrary bytes, in constant memory.
#[derive(Clone, Debug)]
pub struct Decoder {
    buffer: [u8; MAX_FRAME],
    length: usize,
    too_long: bool,
    good: u32,
    bad: u32,
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Decoder {
    /// A decoder at the start of a frame.
    #[must_use]
    pub const fn new() -> Self {
        Self { buffer: [0; MAX_FRAME], length: 0, too_long: false, good: 0, bad: 0 }
    }

    /// Frames that were whole, wraps.
    #[must_use]
    pub const fn good_frames(&self) -> u32 {
        self.good
    }

    /// Frames that were thrown away, wraps.
    #[must_use]
    pub const fn bad_frames(&self) -> u32 {
        self.bad
    }

    /// Takes one byte; at the end of a frame, its message or what was wrong with it.
    pub fn push(&mut self, byte: u8) -> Option<Result<&[u8], FrameError>> {
        if byte != 0 {
            match self.buffer.get_mut(self.length) {
                Some(slot) => {
                    *slot = byte;
                    self.length += 1;
                }
                None => self.too_long = true,
            }
            return None;
        }
        let length = core::mem::take(&mut self.length);
        let too_long = core::mem::take(&mut self.too_long);
        if length == 0 {
            return None;
        }
        let message = if too_long { Err(FrameError::TooLong) } else { self.unpack(length) };
        match message {
            Ok(length) => {
                self.good = self.good.wrapping_add(1);
                self.buffer.get(..length).map(Ok)
            }
            Err(error) => {
                self.bad = self.bad.wrapping_add(1);
                Some(Err(error))
            }
        }
    }

    /// Unpacks the frame in the buffer in place; the message's length.
    fn unpack(&mut self, length: usize) -> Result<usize, FrameError> {
        let frame = self.buffer.get_mut(..length).ok_or(FrameError::TooLong)?;
        let raw = cobs::decode_in_place(frame).map_err(|_| FrameError::Damaged)?;
        let raw = frame.get(..raw).ok_or(FrameError::Damaged)?;
        let (message, crc) = raw.split_last_chunk::<CRC_BYTES>().ok_or(FrameError::Damaged)?;
        if checksum(message) == u32::from_le_bytes(*crc) { Ok(message.len()) } else { Err(FrameError::Crc) }
    }
}
