//! What the core brings: interrupts, reset by the program (PM0214).

use crate::store::Store;

const ISER: u32 = 0xe000_e100;
const VTOR: u32 = 0xe000_ed08;
const AIRCR: u32 = 0xe000_ed0c;
const CPACR: u32 = 0xe000_ed88;
const KEY: u32 = 0x05fa;
const RESET_REQUEST: u32 = 1 << 2;
/// Number of the exception of TIM6's interrupt: 16 more than its place (54, RM0440).
pub const TICK: u32 = 16 + 54;
/// Of the exceptions that are not masked.
pub const NMI: u32 = 2;
/// See [`NMI`].
pub const HARD_FAULT: u32 = 3;

/// The core's part of the interrupts.
#[derive(Debug, Default)]
pub struct Core {
    /// The program has asked for a reset.
    pub reset: bool,
    /// An exception that comes whatever is masked.
    pub urgent: Option<u32>,
}

impl Core {
    /// A write.
    ///
    /// # Errors
    /// The rule that it breaks.
    pub fn write(&mut self, address: u32, value: u32, store: &mut Store) -> Result<(), String> {
        match address {
            AIRCR => {
                if value >> 16 != KEY {
                    return Err("without its key nothing is written".into());
                }
                self.reset |= value & RESET_REQUEST != 0;
            }
            _ if (ISER..ISER + 0x80).contains(&address) => store.set(address, store.get(address) | value),
            _ => store.set(address, value),
        }
        Ok(())
    }

    /// Whether the interrupt of the tick is enabled.
    pub fn tick_enabled(store: &Store) -> bool {
        let number = TICK - 16;
        store.get(ISER + 4 * (number / 32)) >> (number % 32) & 1 != 0
    }

    /// Where the vectors are.
    pub fn vectors(store: &Store) -> u32 {
        match store.get(VTOR) {
            // At 0 the main flash shows, as BOOT0 has it.
            0 => 0x0800_0000,
            other => other,
        }
    }

    /// Whether the floating-point unit may be used.
    pub fn floating(store: &Store) -> bool {
        store.get(CPACR) & 0x00f0_0000 == 0x00f0_0000
    }
}
