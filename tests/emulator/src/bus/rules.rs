//! The rules that every register has.

use super::Bus;
use crate::registers::{Register, registers};

/// Peripherals that have a model, or none but their registers (PWR, SYSCFG, DBGMCU).
const KNOWN: [&str; 26] = [
    "RCC",
    "PWR",
    "FLASH",
    "GPIOA",
    "GPIOB",
    "GPIOC",
    "GPIOD",
    "GPIOE",
    "GPIOF",
    "GPIOG",
    "TIM1",
    "TIM2",
    "TIM5",
    "TIM6",
    "LPUART1",
    "DMA1",
    "DMAMUX1",
    "IWDG",
    "SYSCFG",
    "DBGMCU",
    "ADC1",
    "ADC12_COMMON",
    "DAC1",
    "DAC3",
    "COMP1",
    "COMP3",
];
/// Those of the core.
const CORE: [&str; 3] = ["NVIC", "SCB", "DCB"];

/// A rule that the image has broken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Broken {
    /// The register, or the address where there is none.
    pub register: String,
    /// The rule.
    pub rule: String,
}

impl Bus {
    /// Whether a register may be used so; `written` is what is to be written.
    pub(super) fn allowed(&self, address: u32, bytes: u32, written: Option<u32>) -> Result<&'static Register, Broken> {
        let broken = |register: &str, rule: &str| Broken { register: register.to_owned(), rule: rule.to_owned() };
        let Some(register) = registers().get(&address) else {
            return Err(broken(&format!("{address:#010x}"), "no register is there"));
        };
        let name = register.name.as_str();
        let peripheral = name.split('.').next().unwrap_or_default();
        if !KNOWN.contains(&peripheral) && !CORE.contains(&peripheral) {
            return Err(broken(name, "the emulation has no model of this peripheral"));
        }
        if let Some((enable, bit)) = register.clock
            && self.store.get(enable) >> bit & 1 == 0
        {
            return Err(broken(name, "it is used while the peripheral's clock is off"));
        }
        // Timers take half words too (RM0440).
        if 8 * bytes != register.width && bytes != 4 && !(peripheral.starts_with("TIM") && bytes == 2) {
            return Err(broken(name, &format!("it is used in parts of {bytes} bytes")));
        }
        match written {
            None if !register.readable => Err(broken(name, "it is read, and is for writing only")),
            Some(_) if !register.writable => Err(broken(name, "it is written, and is for reading only")),
            Some(value) if (value ^ self.store.after_reset(address)) & !register.bits & !high_part(bytes) != 0 => {
                let reserved = (value ^ self.store.after_reset(address)) & !register.bits;
                Err(broken(name, &format!("{value:#010x} is written, which changes reserved bits ({reserved:#010x})")))
            }
            _ => Ok(register),
        }
    }
}

/// The bits that an access of so many bytes does not reach.
fn high_part(bytes: u32) -> u32 {
    if bytes == 4 { 0 } else { u32::MAX << (8 * bytes) }
}
