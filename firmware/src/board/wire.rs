//! The bytes of the link.

/// A byte pipe in both directions that never blocks: a UART with DMA or interrupt buffers behind it.
pub trait Wire {
    /// Takes up to `buffer.len()` received bytes and says how many.
    fn read(&mut self, buffer: &mut [u8]) -> usize;

    /// Takes up to `bytes.len()` bytes to send and says how many; the caller keeps the rest.
    fn write(&mut self, bytes: &[u8]) -> usize;
}
