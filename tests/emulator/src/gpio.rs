//! Pins: which are given to which peripheral, and the levels of those that the program sets.

use crate::store::Store;

/// Where port A is; the others follow, 0x400 apart.
pub const GPIOA: u32 = 0x4800_0000;
const SPAN: u32 = 0x400;
const MODER: u32 = 0x00;
const ODR: u32 = 0x14;
const BSRR: u32 = 0x18;
const IDR: u32 = 0x10;
const AFRL: u32 = 0x20;
const OUTPUT: u32 = 1;
const ALTERNATE: u32 = 2;
const ANALOG: u32 = 3;

/// A pin: port and number.
type Pin = (u32, u32);
/// Enable of the power stage.
pub const ENABLE: Pin = (1, 5);
/// Pins of TIM1, with its alternate function (DS12288).
const BRIDGE: [(Pin, &str); 5] = [((0, 8), "PA8"), ((0, 7), "PA7"), ((0, 9), "PA9"), ((1, 0), "PB0"), ((0, 6), "PA6")];
const TIM1_FUNCTION: u32 = 6;

fn port(pin: Pin) -> u32 {
    GPIOA + SPAN * pin.0
}

fn mode(pin: Pin, store: &Store) -> u32 {
    (store.get(port(pin) + MODER) >> (2 * pin.1)) & 3
}

/// Whether a pin is given to a peripheral by that number.
pub fn given(pin: Pin, function: u32, store: &Store) -> bool {
    let number = store.get(port(pin) + AFRL + 4 * (pin.1 / 8)) >> (4 * (pin.1 % 8)) & 0xf;
    mode(pin, store) == ALTERNATE && number == function
}

/// The first pin of the bridge that TIM1 does not have.
pub fn not_given(store: &Store) -> Option<&'static str> {
    BRIDGE.into_iter().find(|(pin, _)| !given(*pin, TIM1_FUNCTION, store)).map(|(_, name)| name)
}

/// Whether a pin is analog.
pub fn analog(pin: Pin, store: &Store) -> bool {
    mode(pin, store) == ANALOG
}

/// Whether the program drives a pin high.
pub fn high(pin: Pin, store: &Store) -> bool {
    mode(pin, store) == OUTPUT && store.get(port(pin) + ODR) >> pin.1 & 1 != 0
}

/// A read: the levels of outputs.
pub fn read(address: u32, store: &Store) -> u32 {
    if address % SPAN == IDR { store.get(address - IDR + ODR) } else { store.get(address) }
}

/// A write.
///
/// # Errors
/// The power stage is enabled while TIM1's outputs are off.
pub fn write(address: u32, value: u32, bridge_on: bool, store: &mut Store) -> Result<(), String> {
    let was_high = high(ENABLE, store);
    if address % SPAN == BSRR {
        let odr = address - BSRR + ODR;
        store.set(odr, store.get(odr) & !(value >> 16) | value & 0xffff);
    } else {
        store.set(address, value);
    }
    let floating = store.get(crate::bridge::TIM1 + 0x44) & 3 << 10 == 0;
    if high(ENABLE, store) && !was_high && !bridge_on && floating {
        return Err("the power stage is enabled before TIM1 holds its inputs".into());
    }
    Ok(())
}
