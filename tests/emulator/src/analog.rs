//! ADC1, the DACs and the comparators, with the shunt amplifier before them (RM0440, ADC, DAC, COMP).

use crate::bus::CORE_HZ;
use crate::store::Store;

/// Where ADC1 is; what it shares with ADC2 follows.
pub const ADC1: u32 = 0x5000_0000;
/// Where DAC1 is.
pub const DAC1: u32 = 0x5000_0800;
/// Where DAC3 is.
pub const DAC3: u32 = 0x5000_1000;
/// The comparators' registers.
pub const COMPARATORS: std::ops::Range<u32> = 0x4001_0200..0x4001_021c;
const COMP1: u32 = 0x4001_0200;
const COMP3: u32 = 0x4001_0208;
const ISR: u32 = 0x00;
const CR: u32 = 0x08;
const CFGR: u32 = 0x0c;
const SMPR1: u32 = 0x14;
const SMPR2: u32 = 0x18;
const JSQR: u32 = 0x4c;
const JDR1: u32 = 0x80;
const COMMON_CCR: u32 = 0x308;
/// Its clock's source; 0 is an asynchronous one.
const CKMODE: u32 = 3 << 16;
const ADEN: u32 = 1;
const JADSTART: u32 = 1 << 3;
const ADVREGEN: u32 = 1 << 28;
const DEEPPWD: u32 = 1 << 29;
const ADCAL: u32 = 1 << 31;
const ADRDY: u32 = 1;
/// End of a conversion, and of the sequence, of the injected group.
const JEOC: u32 = 1 << 5 | 1 << 6;
/// Start-up of the regulator, cycles (DS12288: 20 µs).
const REGULATOR: u64 = 20 * CORE_HZ / 1_000_000;
/// A calibration, cycles: 116 clocks of the ADC, at a quarter of the core's.
const CALIBRATION: u64 = 4 * 116;
/// Four clocks of the ADC after it.
const AFTER_CALIBRATION: u64 = 4 * 4;
const DAC_CR: u32 = 0x00;
const DAC_DHR12R1: u32 = 0x08;
const DAC_DOR1: u32 = 0x2c;
const DAC_MCR: u32 = 0x3c;
const LOCK: u32 = 1 << 31;
/// Of the supply and the reference.
const REFERENCE: f64 = 3.3;
/// Of the amplifier: V without a current, and V/A (50 · 10 mΩ).
const MIDDLE: f64 = REFERENCE / 2.0;
const GAIN: f64 = 0.5;
/// Channels with the pins that they are.
const PINS: [(u32, (u32, u32), &str); 2] = [(7, (2, 1), "PC1"), (12, (1, 1), "PB1")];

/// What is analog.
#[derive(Debug, Default)]
pub struct Analog {
    /// Wires from the amplifier to PC1 and PB1 that are off.
    pub cut: [bool; 2],
    /// Added to both pins, V: what the amplifier's reference is off by.
    pub offset: f64,
    regulator_at: u64,
    calibrated_at: Option<u64>,
}

impl Analog {
    /// What the amplifier gives to both pins at a current, V. A pin that is connected to nothing is near 0.
    pub fn pins(&self, current: Option<f64>) -> [f64; 2] {
        let output = current.map(|amperes| (MIDDLE + self.offset + GAIN * amperes).clamp(0.05, REFERENCE - 0.05));
        self.cut.map(|cut| if cut { 0.02 } else { output.unwrap_or(0.02) })
    }

    /// A system reset.
    pub fn reset(&mut self) {
        (self.regulator_at, self.calibrated_at) = (0, None);
    }

    /// A read of ADC1.
    pub fn read(&self, offset: u32, now: u64, store: &Store) -> u32 {
        let value = store.get(ADC1 + offset);
        let calibrating = self.calibrated_at.is_some_and(|at| now < at);
        if offset == CR && !calibrating { value & !ADCAL } else { value }
    }

    /// A write to ADC1, or to what it shares.
    ///
    /// # Errors
    /// The rule that it breaks.
    pub fn write(&mut self, offset: u32, value: u32, now: u64, store: &mut Store) -> Result<(), String> {
        let before = store.get(ADC1 + CR);
        match offset {
            // Flags are cleared by 1.
            ISR => store.set(ADC1 + ISR, store.get(ADC1 + ISR) & !value),
            CR => self.control(before, value, now, store)?,
            CFGR | SMPR1 | SMPR2 | JSQR if before & JADSTART != 0 => {
                return Err("it is written while conversions are under way (JADSTART)".into());
            }
            COMMON_CCR if before & (ADEN | JADSTART) != 0 => {
                return Err("the ADC's clock is changed while it is on".into());
            }
            _ => store.set(ADC1 + offset, value),
        }
        Ok(())
    }

    fn control(&mut self, before: u32, value: u32, now: u64, store: &mut Store) -> Result<(), String> {
        // Set by the program, cleared by the hardware.
        let stays = before & (ADEN | JADSTART);
        let risen = value & !before;
        let rule = if risen & ADVREGEN != 0 && before & DEEPPWD != 0 {
            "the regulator is switched on in deep power-down"
        } else if risen & (ADCAL | ADEN) != 0 && (before & ADVREGEN == 0 || now < self.regulator_at) {
            "it is used before its regulator is up (20 µs)"
        } else if risen & (ADCAL | ADEN) != 0 && store.get(ADC1 + COMMON_CCR) & CKMODE == 0 {
            "it is used without the synchronous clock"
        } else if value & ADCAL != 0 && (before | risen) & ADEN != 0 {
            "it is calibrated while it is on"
        } else if risen & ADEN != 0 && self.calibrated_at.is_none_or(|at| now < at + AFTER_CALIBRATION) {
            "it is switched on without a calibration, or within four of its clocks after it"
        } else if risen & JADSTART != 0 && (before & ADEN == 0 || store.get(ADC1 + ISR) & ADRDY == 0) {
            "conversions are started before it is ready"
        } else if value & 0x36 != 0 {
            "it is stopped or started in a way that has no model"
        } else {
            if risen & ADVREGEN != 0 {
                self.regulator_at = now + REGULATOR;
            }
            if value & ADCAL != 0 {
                self.calibrated_at = Some(now + CALIBRATION);
            }
            if risen & ADEN != 0 {
                store.put(ADC1 + ISR, ADRDY, true);
            }
            store.set(ADC1 + CR, value | stays);
            return Ok(());
        };
        Err(rule.into())
    }

    /// A write to a DAC at `base`.
    ///
    /// # Errors
    /// The rule that it breaks.
    pub fn write_dac(base: u32, offset: u32, value: u32, store: &mut Store) -> Result<(), String> {
        let on = store.get(base + DAC_CR) & 1 != 0;
        match offset {
            DAC_MCR if on => return Err("its mode is changed while it is on".into()),
            DAC_CR if value & 1 != 0 && !on && store.get(base + DAC_MCR) >> 14 & 3 != 2 => {
                return Err("it is switched on without the interface for more than 160 MHz (HFSEL)".into());
            }
            DAC_CR if value & 1 != 0 && !on && store.get(base + DAC_MCR) & 7 != 3 => {
                return Err("it is switched on, and is not for the comparators alone (MODE1)".into());
            }
            // Without a trigger the output follows.
            DAC_DHR12R1 => store.set(base + DAC_DOR1, value & 0xfff),
            _ => {}
        }
        store.set(base + offset, value);
        Ok(())
    }

    /// A write to a comparator.
    ///
    /// # Errors
    /// The rule that it breaks.
    pub fn write_comparator(address: u32, value: u32, store: &mut Store) -> Result<(), String> {
        if store.get(address) & LOCK != 0 {
            return Err("it is locked until the next reset".into());
        }
        let dac = match value >> 4 & 7 {
            4 => DAC3,
            5 => DAC1,
            _ => return Err("it compares with something that has no model".into()),
        };
        if value & 1 != 0 && store.get(dac + DAC_CR) & 1 == 0 {
            return Err("it is switched on, and the DAC that it compares with is off".into());
        }
        store.set(address, value);
        Ok(())
    }

    /// TIM1 has triggered the injected channels: both pins are converted.
    ///
    /// # Errors
    /// A pin is not analog, or a channel has no model.
    pub fn convert(&self, current: Option<f64>, store: &mut Store) -> Result<(), String> {
        let sequence = store.get(ADC1 + JSQR);
        let pins = self.pins(current);
        for rank in 0..=(sequence & 3) {
            let channel = sequence >> (9 + 6 * rank) & 0x1f;
            let Some(at) = PINS.iter().position(|(number, ..)| *number == channel) else {
                return Err(format!("channel {channel} has no model"));
            };
            let (_, pin, name) = PINS[at];
            if !crate::gpio::analog(pin, store) {
                return Err(format!("{name} is converted, and is not analog"));
            }
            let code = (pins[at] / REFERENCE * 4096.0).round().clamp(0.0, 4095.0) as u32;
            store.set(ADC1 + JDR1 + 4 * rank, code);
        }
        store.put(ADC1 + ISR, JEOC, true);
        Ok(())
    }

    /// Whether TIM1's TRGO2 (`trigger`: it rises once per period) starts conversions.
    pub fn triggered(store: &Store) -> bool {
        let sequence = store.get(ADC1 + JSQR);
        store.get(ADC1 + CR) & JADSTART != 0 && sequence >> 7 & 3 == 1 && sequence >> 2 & 0x1f == 8
    }

    /// Comparators whose output is high, as TIM1's bits of them (1: COMP1).
    pub fn comparators(&self, current: Option<f64>, store: &Store) -> u32 {
        let [first, second] = self.pins(current);
        let high = |address: u32, pin: f64| {
            let set = store.get(address);
            let dac = if set >> 4 & 7 == 4 { DAC3 } else { DAC1 };
            let level = f64::from(store.get(dac + DAC_DOR1)) / 4096.0 * REFERENCE;
            set & 1 != 0 && set & 1 << 8 != 0 && (pin > level) != (set & 1 << 15 != 0)
        };
        u32::from(high(COMP1, second)) << 1 | u32::from(high(COMP3, first)) << 3
    }
}
