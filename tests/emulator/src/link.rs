//! LPUART1 with channels 1 and 2 of DMA1 (RM0440: LPUART, DMA, DMAMUX): bytes in and out, at the rate that is set.

use std::collections::VecDeque;

use crate::gpio::given;
use crate::store::Store;
use crate::unicorn::Cpu;

/// Where LPUART1 is.
pub const LPUART1: u32 = 0x4000_8000;
/// Where DMA1 is.
pub const DMA1: u32 = 0x4002_0000;
/// Where the multiplexer is.
pub const DMAMUX1: u32 = 0x4002_0800;
const CR1: u32 = 0x00;
const CR3: u32 = 0x08;
const BRR: u32 = 0x0c;
const ISR: u32 = 0x1c;
const ICR: u32 = 0x20;
const RDR: u32 = 0x24;
const TDR: u32 = 0x28;
const ENABLED: u32 = 1;
const RECEIVES: u32 = 1 << 2;
const TRANSMITS: u32 = 1 << 3;
const COMPLETE: u32 = 1 << 6;
const DMA_RECEIVES: u32 = 1 << 6;
const DMA_TRANSMITS: u32 = 1 << 7;
/// DMA channels from 0, and the requests that they are for.
const SEND: u32 = 0;
const RECEIVE: u32 = 1;
const REQUESTS: [(u32, u32); 2] = [(SEND, 35), (RECEIVE, 34)];
/// Start bit, eight bits, stop bit.
const BITS: u64 = 10;
const FUNCTION: u32 = 12;

const fn channel(number: u32) -> u32 {
    DMA1 + 0x08 + 0x14 * number
}

/// The link.
#[derive(Debug, Default)]
pub struct Link {
    /// Bytes on their way to the board.
    pub to_board: VecDeque<u8>,
    /// Bytes that the board has sent.
    pub from_board: VecDeque<u8>,
    /// A burst that is being sent: where it lies, what it is, when it started.
    burst: Option<(u32, Vec<u8>, u64)>,
    /// When the last byte that was received was there.
    received_at: u64,
    /// Place of the next byte in the ring.
    place: u32,
    /// Bytes of the ring.
    ring: u32,
}

impl Link {
    /// Cycles of a byte.
    fn byte_cycles(store: &Store) -> u64 {
        u64::from(store.get(LPUART1 + BRR)) * BITS / 256
    }

    /// Moves what has had its time by now.
    ///
    /// # Errors
    /// The program has changed a burst while it was being sent.
    pub fn pass(&mut self, cpu: Cpu, now: u64, store: &mut Store) -> Result<(), String> {
        self.send(cpu, now, store)?;
        let on = store.get(LPUART1 + CR1);
        let ready = on & (ENABLED | RECEIVES) == ENABLED | RECEIVES
            && store.get(LPUART1 + CR3) & DMA_RECEIVES != 0
            && store.get(channel(RECEIVE)) & 1 != 0;
        if !ready {
            self.received_at = now;
            return Ok(());
        }
        let cycles = Self::byte_cycles(store);
        while self.received_at + cycles <= now {
            let Some(byte) = self.to_board.pop_front() else {
                self.received_at = now;
                return Ok(());
            };
            self.received_at += cycles;
            cpu.write(store.get(channel(RECEIVE) + 0x0c) + self.place, &[byte]);
            self.place = (self.place + 1) % self.ring;
            store.set(channel(RECEIVE) + 0x04, self.ring - self.place);
        }
        Ok(())
    }

    fn send(&mut self, cpu: Cpu, now: u64, store: &mut Store) -> Result<(), String> {
        let Some((address, bytes, start)) = &self.burst else { return Ok(()) };
        let sent = (now - start) / Self::byte_cycles(store);
        let left = (bytes.len() as u64).saturating_sub(sent);
        store.set(channel(SEND) + 0x04, left as u32);
        if left > 0 {
            return Ok(());
        }
        let mut there = vec![0; bytes.len()];
        cpu.read(*address, &mut there);
        if there != *bytes {
            return Err(format!("the {} bytes at {address:#010x} are changed while DMA sends them", bytes.len()));
        }
        self.from_board.extend(bytes);
        self.burst = None;
        Ok(())
    }

    /// A read of LPUART1, DMA1 or the multiplexer.
    pub fn read(&self, address: u32, store: &Store) -> u32 {
        if address == LPUART1 + ISR {
            return if self.burst.is_none() { COMPLETE } else { 0 };
        }
        store.get(address)
    }

    /// A write to one of them.
    ///
    /// # Errors
    /// The rule that it breaks.
    pub fn write(&mut self, cpu: Cpu, address: u32, value: u32, now: u64, store: &mut Store) -> Result<(), String> {
        let before = store.get(address);
        let running = store.get(LPUART1 + CR1) & ENABLED != 0;
        if address == LPUART1 + ICR {
            return Ok(());
        }
        if (address == LPUART1 + BRR || address == LPUART1 + CR3) && running {
            return Err("it is set while the LPUART is on (UE)".into());
        }
        if address == LPUART1 + BRR && !(0x300..=0xf_ffff).contains(&value) {
            return Err(format!("{value:#x} is outside of what the divider may be, 0x300 to 0xfffff"));
        }
        if address == LPUART1 + CR1 && value & ENABLED != 0 && before & ENABLED == 0 {
            if store.get(LPUART1 + BRR) == 0 || value & (TRANSMITS | RECEIVES) != 0 && before & ENABLED == 0 {
                return Err("UE comes after the divider, and before TE and RE".into());
            }
            if !given((0, 2), FUNCTION, store) || !given((0, 3), FUNCTION, store) {
                return Err("PA2 or PA3 is not given to LPUART1".into());
            }
        }
        for number in [SEND, RECEIVE] {
            let own = channel(number);
            if (own + 0x04..own + 0x10).contains(&address) && store.get(own) & 1 != 0 {
                return Err(format!("it is set while channel {} is on", number + 1));
            }
            if address == own && value & 1 != 0 && before & 1 == 0 {
                store.set(own, value);
                return self.start(cpu, number, value, now, store);
            }
            if address == own && number == SEND && value & 1 == 0 && self.burst.is_some() {
                return Err("the channel is switched off while it sends".into());
            }
        }
        store.set(address, value);
        Ok(())
    }

    fn start(&mut self, cpu: Cpu, number: u32, control: u32, now: u64, store: &mut Store) -> Result<(), String> {
        let own = channel(number);
        let (length, peripheral, memory) = (store.get(own + 0x04), store.get(own + 0x08), store.get(own + 0x0c));
        let request = REQUESTS.iter().find(|(channel, _)| *channel == number).map_or(0, |(_, request)| *request);
        if store.get(DMAMUX1 + 4 * number) & 0x7f != request {
            return Err("the multiplexer gives the channel another request".into());
        }
        // Direction, circular, peripheral stays, memory goes on, bytes.
        let (register, form) = if number == SEND { (TDR, 0x90) } else { (RDR, 0xa0) };
        if peripheral != LPUART1 + register || control & 0x7ff0 != form || length == 0 {
            return Err(format!("channel {} does not carry bytes of LPUART1", number + 1));
        }
        if !(0x2000_0000..0x2001_8000).contains(&memory) {
            return Err(format!("DMA is given {memory:#010x}, which is not in SRAM"));
        }
        if number == RECEIVE {
            (self.ring, self.place, self.received_at) = (length, 0, now);
            return Ok(());
        }
        if store.get(LPUART1 + CR1) & (ENABLED | TRANSMITS) != ENABLED | TRANSMITS
            || store.get(LPUART1 + CR3) & DMA_TRANSMITS == 0
        {
            return Err("a burst is started before the LPUART sends".into());
        }
        let mut bytes = vec![0; length as usize];
        cpu.read(memory, &mut bytes);
        self.burst = Some((memory, bytes, now));
        Ok(())
    }

    /// A system reset: what was on its way is lost.
    pub fn reset(&mut self) {
        let from_board = std::mem::take(&mut self.from_board);
        *self = Self { from_board, ..Self::default() };
    }
}
