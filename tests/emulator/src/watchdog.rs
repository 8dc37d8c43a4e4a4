//! The independent watchdog (RM0440, IWDG).

use crate::store::Store;

/// Where it is.
pub const IWDG: u32 = 0x4000_3000;
const KR: u32 = 0x00;
const PR: u32 = 0x04;
const RLR: u32 = 0x08;
const ACCESS: u32 = 0x5555;
const START: u32 = 0xcccc;
const FEED: u32 = 0xaaaa;
/// Cycles of the core for one of the LSI, 32 kHz.
const LSI: u64 = 170_000_000 / 32_000;

/// The watchdog.
#[derive(Debug, Default)]
pub struct Watchdog {
    fed_at: Option<u64>,
    access: bool,
}

impl Watchdog {
    /// A write.
    ///
    /// # Errors
    /// The rule that it breaks.
    pub fn write(&mut self, offset: u32, value: u32, now: u64, store: &mut Store) -> Result<(), String> {
        match (offset, value) {
            (KR, ACCESS) => self.access = true,
            (KR, START) => (self.fed_at, self.access) = (Some(now), false),
            (KR, FEED) => {
                self.fed_at = self.fed_at.map(|_| now);
                self.access = false;
            }
            (KR, _) => return Err(format!("{value:#x} is no key")),
            (PR | RLR, _) if !self.access => return Err("it is written without the key 0x5555 before".into()),
            _ => store.set(IWDG + offset, value),
        }
        Ok(())
    }

    /// When it resets the board, cycles, if it runs.
    pub fn bites_at(&self, store: &Store) -> Option<u64> {
        let divider = 4 << store.get(IWDG + PR).min(6);
        self.fed_at.map(|fed| fed + (u64::from(store.get(IWDG + RLR)) + 1) * divider * LSI)
    }

    /// Time has passed while the core was halted, and the debugger had stopped it.
    pub fn resume(&mut self, stood: u64) {
        self.fed_at = self.fed_at.map(|fed| fed + stood);
    }
}
