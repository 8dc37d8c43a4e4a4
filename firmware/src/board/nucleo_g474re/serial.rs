//! The link on the ST-LINK's virtual COM port: LPUART1, DMA both ways.

use core::cell::RefCell;
use core::future::{Future, poll_fn};
use core::pin::pin;
use core::task::{Context, Poll, Waker};

use embassy_stm32::mode::Async;
use embassy_stm32::usart::{RingBufferedUartRx, UartTx};
use heapless::Vec;

use super::constants::SEND_BYTES;
use crate::board::Wire;

/// Bytes that wait for the next transfer. Used by the thread only.
pub type Outgoing = RefCell<Vec<u8, SEND_BYTES>>;

/// The link's bytes.
pub struct Serial {
    receiver: RingBufferedUartRx<'static>,
    outgoing: &'static Outgoing,
}

impl Serial {
    /// Receives by `receiver`; what it sends is taken from `outgoing` by [`send`].
    pub fn new(receiver: RingBufferedUartRx<'static>, outgoing: &'static Outgoing) -> Self {
        Self { receiver, outgoing }
    }
}

impl Wire for Serial {
    fn read(&mut self, buffer: &mut [u8]) -> usize {
        // Bytes that were lost (noise, overrun) cost the frames they were in; the receiver starts anew by itself.
        match poll_once(self.receiver.read(buffer)) {
            Poll::Ready(Ok(read)) => read,
            Poll::Ready(Err(_)) | Poll::Pending => 0,
        }
    }

    fn write(&mut self, bytes: &[u8]) -> usize {
        let mut outgoing = self.outgoing.borrow_mut();
        let room = bytes.len().min(outgoing.capacity() - outgoing.len());
        let (taken, _) = bytes.split_at(room);
        // There is room.
        let _ = outgoing.extend_from_slice(taken);
        room
    }
}

/// Sends what waits, one transfer after the other. To be polled as often as the application.
pub async fn send(mut transmitter: UartTx<'static, Async>, outgoing: &'static Outgoing) {
    loop {
        let burst = outgoing.take();
        if burst.is_empty() {
            next_poll().await;
        } else {
            // The transmitter has no way to fail that the bytes would tell.
            let _ = transmitter.write(&burst).await;
        }
    }
}

/// Ready when polled again.
async fn next_poll() {
    let mut again = false;
    poll_fn(|_| if core::mem::replace(&mut again, true) { Poll::Ready(()) } else { Poll::Pending }).await;
}

/// Polls a future that may be dropped half-way.
fn poll_once<T>(future: impl Future<Output = T>) -> Poll<T> {
    pin!(future).poll(&mut Context::from_waker(Waker::noop()))
}
