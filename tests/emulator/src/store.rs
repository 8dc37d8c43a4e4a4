//! What is written in the registers, and what a reset leaves there.

use std::collections::HashMap;

use crate::registers::address;

/// Registers that are not 0 after a reset (RM0440).
const AFTER_RESET: [(&str, u32); 27] = [
    ("RCC.CR", 0x0000_0500),
    ("RCC.ICSCR", 0x4000_0000),
    ("RCC.CFGR", 0x0000_0001),
    ("RCC.PLLCFGR", 0x0000_1000),
    ("RCC.AHB1ENR", 0x0000_0100),
    ("RCC.AHB1SMENR", 0x0000_130f),
    ("PWR.CR1", 0x0000_0200),
    ("PWR.CR3", 0x0000_8000),
    ("PWR.CR5", 0x0000_0100),
    ("FLASH.ACR", 0x0004_0600),
    ("FLASH.CR", 0xc000_0000),
    ("FLASH.OPTR", 0xffef_f8aa),
    ("GPIOA.MODER", 0xabff_ffff),
    ("GPIOA.OSPEEDR", 0x0c00_0000),
    ("GPIOA.PUPDR", 0x6400_0000),
    ("GPIOB.MODER", 0xffff_febf),
    ("GPIOB.PUPDR", 0x0000_0100),
    ("GPIOC.MODER", 0xffff_ffff),
    ("IWDG.RLR", 0x0000_0fff),
    ("IWDG.WINR", 0x0000_0fff),
    ("TIM1.ARR", 0x0000_ffff),
    ("TIM2.ARR", 0xffff_ffff),
    ("TIM6.ARR", 0x0000_ffff),
    ("TIM1.AF1", 0x0000_0001),
    ("TIM1.AF2", 0x0000_0001),
    ("ADC1.CR", 0x2000_0000),
    ("ADC1.CFGR", 0x8000_0000),
];

/// The registers' content.
#[derive(Debug)]
pub struct Store {
    values: HashMap<u32, u32>,
    after_reset: HashMap<u32, u32>,
}

impl Store {
    /// As after power-on.
    pub fn new() -> Self {
        let after_reset = AFTER_RESET.iter().map(|(name, value)| (address(name), *value)).collect();
        Self { values: HashMap::new(), after_reset }
    }

    /// A system reset.
    pub fn reset(&mut self) {
        self.values.clear();
    }

    /// What a reset leaves in a register.
    pub fn after_reset(&self, address: u32) -> u32 {
        self.after_reset.get(&address).copied().unwrap_or(0)
    }

    /// A register's content.
    pub fn get(&self, address: u32) -> u32 {
        self.values.get(&address).copied().unwrap_or_else(|| self.after_reset(address))
    }

    /// Writes a register.
    pub fn set(&mut self, address: u32, value: u32) {
        self.values.insert(address, value);
    }

    /// Sets or clears bits.
    pub fn put(&mut self, address: u32, bits: u32, on: bool) {
        let value = self.get(address);
        self.set(address, if on { value | bits } else { value & !bits });
    }
}

impl Default for Store {
    fn default() -> Self {
        Self::new()
    }
}
