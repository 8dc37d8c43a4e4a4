//! Clocks: what must be ready before it is used (RM0440, RCC and PWR).

use crate::store::Store;

/// Offsets.
const CR: u32 = 0x00;
const CFGR: u32 = 0x08;
const PLLCFGR: u32 = 0x0c;
const CIFR: u32 = 0x1c;
const CSR: u32 = 0x94;
const CRRCR: u32 = 0x98;
/// Where it is.
pub const RCC: u32 = 0x4002_1000;
const FLASH_ACR: u32 = 0x4002_2000;
const PWR_CR5: u32 = 0x4000_7080;

const HSI: u32 = 1 << 8;
const HSE: u32 = 1 << 16;
const PLL: u32 = 1 << 24;
/// Flags and bits of `RCC.CSR`.
pub const WATCHDOG_RESET: u32 = 1 << 29;
/// Of a reset by the pin.
pub const PIN_RESET: u32 = 1 << 26;
/// Of a reset by the program.
pub const SOFTWARE_RESET: u32 = 1 << 28;
/// Of power-on.
pub const POWER_RESET: u32 = 1 << 27;
const REMOVE_FLAGS: u32 = 1 << 23;
/// The crystal of the board, Hz (UM2505).
const CRYSTAL_HZ: u64 = 24_000_000;

/// The most that the core may have (DS12288), and the jump that needs a step between (RM0440).
const MOST_HZ: u64 = 170_000_000;
const JUMP_HZ: u64 = 80_000_000;

/// What a read gives, where it is not what was written: what is switched on is ready.
pub fn read(offset: u32, store: &Store) -> u32 {
    let value = store.get(RCC + offset);
    match offset {
        CR => [HSI, HSE, PLL].into_iter().fold(value, |value, on| {
            let ready = if on == HSI { on << 2 } else { on << 1 };
            if value & on == 0 { value & !ready } else { value | ready }
        }),
        CFGR => value & !0xc | (value & 3) << 2,
        CIFR => 0,
        // HSI48 and LSI.
        CRRCR | CSR => value & !2 | (value & 1) << 1,
        _ => value,
    }
}

/// Hz of the PLL's output R, as it is set.
fn pll_hz(store: &Store) -> u64 {
    let config = store.get(RCC + PLLCFGR);
    let source = match config & 3 {
        3 => CRYSTAL_HZ,
        2 => 16_000_000,
        _ => 0,
    };
    let (divided, times) = (u64::from((config >> 4) & 0xf) + 1, u64::from((config >> 8) & 0x7f));
    source / divided * times / (2 * (u64::from((config >> 25) & 3) + 1))
}

/// A write.
///
/// # Errors
/// The rule that it breaks.
pub fn write(offset: u32, value: u32, store: &mut Store) -> Result<(), String> {
    let before = store.get(RCC + offset);
    let on = store.get(RCC + CR);
    match offset {
        CR => {
            if value & PLL != 0 && before & PLL == 0 && store.get(RCC + PLLCFGR) & 3 == 3 && before & HSE == 0 {
                return Err("the PLL is switched on before its source, the crystal, is ready".into());
            }
            let used = store.get(RCC + CFGR) & 3;
            if used == 3 && value & PLL == 0 || used == 2 && value & HSE == 0 || used == 1 && value & HSI == 0 {
                return Err("the clock that the core runs on is switched off".into());
            }
            // Flags of readiness are the hardware's.
        }
        PLLCFGR if on & PLL != 0 && (value ^ before) & 0x7ff3 != 0 => {
            return Err("the PLL is set while it runs".into());
        }
        CFGR => {
            let (old, new) = (before & 3, value & 3);
            let ready = [false, on & HSI != 0, on & HSE != 0, on & PLL != 0][new as usize];
            if !ready {
                return Err("the core is switched to a clock that is not ready".into());
            }
            if (old, divided(before)) != (new, divided(value)) {
                step_up(before, value, store)?;
            }
        }
        CSR if value & REMOVE_FLAGS != 0 => {
            store.set(RCC + CSR, value & 1);
            return Ok(());
        }
        _ => {}
    }
    store.set(RCC + offset, value);
    Ok(())
}

/// Divider of the buses, as `HPRE` has it.
fn divided(config: u32) -> u64 {
    match (config >> 4) & 0xf {
        exponent @ 8..=11 => 2 << (exponent - 8),
        exponent @ 12.. => 64 << (exponent - 12),
        _ => 1,
    }
}

/// A step of the core's frequency (RM0440: system clock selection; number of wait states; PWR, range 1 boost mode).
fn step_up(before: u32, after: u32, store: &Store) -> Result<(), String> {
    let source = |config: u32| if config & 3 == 3 { pll_hz(store) } else { 24_000_000 };
    let (from, to) = (source(before) / divided(before), source(after) / divided(after));
    if after & 3 == 3 && store.get(RCC + PLLCFGR) & 1 << 24 == 0 {
        return Err("the PLL's output R is off".into());
    }
    let states = store.get(FLASH_ACR) & 0xf;
    if u64::from(states + 1) * 34_000_000 < to {
        return Err(format!("the flash has {states} wait states at {to} Hz"));
    }
    if to > MOST_HZ {
        return Err(format!("{to} Hz is more than the core may have"));
    }
    if source(after) > 150_000_000 && store.get(PWR_CR5) & 1 << 8 != 0 {
        return Err("above 150 MHz without the boost of the core's voltage (PWR.CR5, R1MODE)".into());
    }
    // From a slow clock in one step: half of the new one comes first.
    if to > 2 * JUMP_HZ.max(from) || to > JUMP_HZ && from <= JUMP_HZ && divided(after) == 1 {
        return Err(format!("from {from} Hz to {to} Hz in one step, without half of it first"));
    }
    Ok(())
}
