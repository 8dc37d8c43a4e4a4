//! A CMSDK APB UART (Arm DDI 0479, chapter 4.3), polled.

use crate::board::Wire;

const DATA: usize = 0x0;
const STATE: usize = 0x4;
const CTRL: usize = 0x8;
const BAUDDIV: usize = 0x10;

const TX_FULL: u32 = 1;
const RX_FULL: u32 = 2;

/// One UART.
#[derive(Debug)]
pub struct Uart {
    base: usize,
}

impl Uart {
    /// UART0: the link.
    #[must_use]
    pub fn link() -> Self {
        Self::at(0x4000_4000)
    }

    /// UART1: the plant.
    #[must_use]
    pub fn plant() -> Self {
        Self::at(0x4000_5000)
    }

    fn at(base: usize) -> Self {
        let mut uart = Self { base };
        // The smallest divider it accepts; QEMU is not slowed by it.
        uart.write_register(BAUDDIV, 16);
        // Transmitter and receiver on.
        uart.write_register(CTRL, 3);
        // A byte from before the reset is nobody's; and QEMU listens to its end of the line only once it was read here.
        uart.read_register(DATA);
        uart
    }

    fn read_register(&self, offset: usize) -> u32 {
        // SAFETY: a register of the UART at `base`, one of the two that `link` and `plant` name.
        unsafe { ((self.base + offset) as *const u32).read_volatile() }
    }

    fn write_register(&mut self, offset: usize, value: u32) {
        // SAFETY: as in `read_register`.
        unsafe { ((self.base + offset) as *mut u32).write_volatile(value) }
    }

    /// A received byte, if there is one.
    pub fn receive(&mut self) -> Option<u8> {
        (self.read_register(STATE) & RX_FULL != 0).then(|| self.read_register(DATA) as u8)
    }

    /// Sends a byte, waiting for room.
    pub fn send(&mut self, byte: u8) {
        while self.read_register(STATE) & TX_FULL != 0 {}
        self.write_register(DATA, u32::from(byte));
    }
}

impl Wire for Uart {
    fn read(&mut self, buffer: &mut [u8]) -> usize {
        let mut read = 0;
        for slot in buffer {
            let Some(byte) = self.receive() else {
                break;
            };
            *slot = byte;
            read += 1;
        }
        read
    }

    fn write(&mut self, bytes: &[u8]) -> usize {
        let mut written = 0;
        for byte in bytes {
            if self.read_register(STATE) & TX_FULL != 0 {
                break;
            }
            self.write_register(DATA, u32::from(*byte));
            written += 1;
        }
        written
    }
}
