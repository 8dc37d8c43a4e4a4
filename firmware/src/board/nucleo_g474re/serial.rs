//! The link on the ST-LINK's virtual COM port: LPUART1, DMA both ways, polled by the thread.
//!
//! On the registers, by RM0440 (LPUART; DMA; DMAMUX). It receives into a ring without an end and sends one burst
//! after the other, so it needs no interrupt and no waiting task. With the HAL's drivers for both the image is 4.4 KB
//! larger.

use core::sync::atomic::{AtomicU8, Ordering, fence};

use breakaway_core::link::BAUD;
use embassy_stm32::pac;
use embassy_stm32::pac::bdma::vals::Dir;
use heapless::Vec;

use super::constants::{CORE_HZ, RECEIVE_BYTES, SEND_BYTES};
use crate::board::Wire;

/// Channels of DMA1 and of its multiplexer, numbered from 0.
const SENDS: usize = 0;
const RECEIVES: usize = 1;
/// The multiplexer's inputs (RM0440, assignment of its inputs).
const LPUART1_RX: u8 = 34;
const LPUART1_TX: u8 = 35;
/// Divider of LPUART1's clock, in 256ths, to the nearest: 921 600 baud to 5 ppm.
const DIVIDER: u32 = ((256 * CORE_HZ as u64 + BAUD as u64 / 2) / BAUD as u64) as u32;

/// Received bytes, written by DMA without end. Atomic: they change under the program.
static RECEIVED: [AtomicU8; RECEIVE_BYTES] = [const { AtomicU8::new(0) }; RECEIVE_BYTES];
/// The burst that is being sent, read by DMA.
static BURST: [AtomicU8; SEND_BYTES] = [const { AtomicU8::new(0) }; SEND_BYTES];

/// The link's bytes.
pub struct Serial {
    /// Place of the next byte to be read.
    next: usize,
    /// Bytes that wait for the next burst.
    waiting: Vec<u8, SEND_BYTES>,
}

impl Serial {
    /// Starts to receive; once. LPUART1 has its clock (PCLK1 = CORE_HZ) and its pins, DMA1 and its multiplexer have their clocks.
    pub(super) fn start() -> Self {
        pac::DMAMUX1.ccr(SENDS).write(|input| input.set_dmareq_id(LPUART1_TX));
        pac::DMAMUX1.ccr(RECEIVES).write(|input| input.set_dmareq_id(LPUART1_RX));
        let (send, receive) = (pac::DMA1.ch(SENDS), pac::DMA1.ch(RECEIVES));
        send.par().write_value(pac::LPUART1.tdr().as_ptr() as u32);
        send.mar().write_value(BURST.as_ptr() as u32);
        receive.par().write_value(pac::LPUART1.rdr().as_ptr() as u32);
        receive.mar().write_value(RECEIVED.as_ptr() as u32);
        receive.ndtr().write(|left| left.set_ndt(RECEIVE_BYTES as u16));
        receive.cr().write(|control| {
            control.set_dir(Dir::FROM_PERIPHERAL);
            control.set_minc(true);
            control.set_circ(true);
            control.set_en(true);
        });
        pac::LPUART1.brr().write_value(pac::usart::regs::Brr(DIVIDER));
        pac::LPUART1.cr3().write(|control| {
            control.set_dmat(true);
            control.set_dmar(true);
        });
        // 8 bits, no parity, one stop bit. The FIFO goes on sending while the next burst is set up.
        pac::LPUART1.cr1().write(|control| control.set_fifoen(true));
        pac::LPUART1.cr1().modify(|control| control.set_ue(true));
        pac::LPUART1.cr1().modify(|control| {
            control.set_te(true);
            control.set_re(true);
        });
        Self { next: 0, waiting: Vec::new() }
    }
}

/// Whether a burst is on its way to the transmitter.
fn sending() -> bool {
    let send = pac::DMA1.ch(SENDS);
    send.cr().read().en() && send.ndtr().read().ndt() != 0
}

impl Wire for Serial {
    fn read(&mut self, buffer: &mut [u8]) -> usize {
        // Bytes that are lost (noise; or this ring not read for 1.4 ms) cost the frames they were in. Errors hold nothing up
        // (DMA goes on), but an overrun is cleared for the next to be received.
        pac::LPUART1.icr().write(|clear| {
            clear.set_fe(true);
            clear.set_ne(true);
            clear.set_ore(true);
        });
        let left = usize::from(pac::DMA1.ch(RECEIVES).ndtr().read().ndt());
        let end = RECEIVE_BYTES.wrapping_sub(left) % RECEIVE_BYTES;
        // What DMA counts it has written.
        fence(Ordering::SeqCst);
        let mut read = 0;
        for byte in buffer {
            let (false, Some(received)) = (self.next == end, RECEIVED.get(self.next)) else {
                break;
            };
            *byte = received.load(Ordering::Relaxed);
            self.next = (self.next + 1) % RECEIVE_BYTES;
            read += 1;
        }
        read
    }

    fn write(&mut self, bytes: &[u8]) -> usize {
        let room = bytes.len().min(SEND_BYTES - self.waiting.len());
        let (taken, _) = bytes.split_at(room);
        // There is room.
        let _ = self.waiting.extend_from_slice(taken);
        room
    }

    fn flush(&mut self) {
        if self.waiting.is_empty() || sending() {
            return;
        }
        for (sent, byte) in BURST.iter().zip(&self.waiting) {
            sent.store(*byte, Ordering::Relaxed);
        }
        let send = pac::DMA1.ch(SENDS);
        // Its length is written while it is off.
        send.cr().write(|_| {});
        send.ndtr().write(|left| left.set_ndt(self.waiting.len() as u16));
        // Before DMA reads them.
        fence(Ordering::SeqCst);
        send.cr().write(|control| {
            control.set_dir(Dir::FROM_MEMORY);
            control.set_minc(true);
            control.set_en(true);
        });
        self.waiting.clear();
    }

    fn idle(&self) -> bool {
        self.waiting.is_empty() && !sending() && pac::LPUART1.isr().read().tc()
    }
}
