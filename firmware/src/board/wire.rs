//! The bytes of the link.

/// A byte pipe in both directions that never blocks: a UART with DMA or interrupt buffers behind it.
pub trait Wire {
    /// Takes up to `buffer.len()` received bytes and says how many.
    fn read(&mut self, buffer: &mut [u8]) -> usize;

    /// Takes up to `bytes.len()` bytes to send and says how many; the caller keeps the rest.
    fn write(&mut self, bytes: &[u8]) -> usize;

    /// Moves what is buffered on, as far as it goes without waiting. Called in every round of the thread.
    fn flush(&mut self) {}

    /// Whether everything that was taken has gone out: only then may the board be reset by command.
    fn idle(&self) -> bool {
        true
    }
}
