//! The motor's current, from a shunt amplifier in the motor's lead on two pins (RM0440, ADC). ADC1 converts both when
//! TIM1's counter is lowest, once per period of the PWM.
//!
//! That is the middle of the pulse, where the ripple of the current is at its mean. The two pins are joined: what the
//! comparators see is what is measured, and a wire that is off shows as a difference.

use embassy_stm32::pac;
use embassy_stm32::pac::adc::vals::{Exten, SampleTime};
use embassy_stm32::pac::adccommon::vals::Ckmode;

use super::constants::{
    CORE_HZ, CURRENT_CHANNELS, CURRENT_MIDDLE, CURRENT_OFFSET, CURRENT_PAIR, CURRENT_PAIR_TICKS, CURRENT_SAMPLES,
    CURRENT_SPREAD, MA_PER_CODE_Q16,
};

/// TIM1_TRGO2 starts the injected channels (RM0440, ADC1/2, injected external triggers).
const TIM1_TRGO2: u8 = 8;
/// Start-up of the voltage regulator (DS12288, ADC characteristics), µs.
const REGULATOR_US: u32 = 20;
/// Looks at a flag until something is broken: more than a period of the PWM, or a calibration.
const LOOKS: u32 = 10_000;

/// The measured current.
pub struct Current {
    /// What the ADC reads without a current, codes.
    offset: u16,
    /// Ticks in a row in which both pins differed.
    apart: u8,
}

impl Current {
    /// Sets up ADC1, and reads what it finds without a current; once. TIM1 counts with its outputs off, and the clocks are on. `None`
    /// where no amplifier is connected to both pins.
    pub(super) fn start() -> Option<Self> {
        convert()?;
        let (mut sums, mut least, mut most) = ([0_u32; 2], u16::MAX, 0);
        for _ in 0..CURRENT_SAMPLES {
            wait_for_sample()?;
            let codes = read();
            for (sum, code) in sums.iter_mut().zip(codes) {
                *sum += u32::from(code);
                (least, most) = (code.min(least), code.max(most));
            }
        }
        let [offset, other] = sums.map(|sum| (sum / CURRENT_SAMPLES) as u16);
        let plausible = offset.abs_diff(CURRENT_MIDDLE) <= CURRENT_OFFSET
            && offset.abs_diff(other) <= CURRENT_PAIR
            && most - least <= CURRENT_SPREAD;
        plausible.then_some(Self { offset, apart: 0 })
    }

    /// What the ADC reads without a current, codes.
    pub(super) fn offset(&self) -> u16 {
        self.offset
    }

    /// The current in the middle of the last pulse, mA; `None` while the two pins differ for longer than a disturbance.
    #[inline]
    pub(super) fn milliamperes(&mut self) -> Option<i32> {
        let [code, other] = read();
        self.apart = if code.abs_diff(other) > CURRENT_PAIR { self.apart.saturating_add(1) } else { 0 };
        let codes = i32::from(code) - i32::from(self.offset);
        // 2¹² codes of less than 2¹⁸.
        (self.apart < CURRENT_PAIR_TICKS).then_some((codes * MA_PER_CODE_Q16) >> 16)
    }
}

/// The last codes of both pins.
#[inline]
fn read() -> [u16; 2] {
    [pac::ADC1.jdr(0).read().jdata(), pac::ADC1.jdr(1).read().jdata()]
}

/// Waits for the end of the next conversion; `None` where none comes.
pub(super) fn wait_for_sample() -> Option<()> {
    // Its flag is cleared by 1.
    pac::ADC1.isr().write(|flags| flags.set_jeos(true));
    within(|| pac::ADC1.isr().read().jeos())
}

fn within(mut done: impl FnMut() -> bool) -> Option<()> {
    (0..LOOKS).any(|_| done()).then_some(())
}

/// From deep power-down to conversions with every period of the PWM, in the manual's order (RM0440, ADC: voltage regulator,
/// calibration, on-off control, injected channels).
fn convert() -> Option<()> {
    let adc = pac::ADC1;
    // Out of deep power-down first.
    adc.cr().write(|_| {});
    adc.cr().modify(|control| control.set_advregen(true));
    cortex_m::asm::delay(REGULATOR_US * (CORE_HZ / 1_000_000));
    // From the core's clock, so that the time from trigger to sample is the same each time: 42.5 MHz (60 at the most).
    pac::ADC12_COMMON.ccr().write(|common| common.set_ckmode(Ckmode::SYNC_DIV4));
    adc.cr().modify(|control| control.set_adcal(true));
    within(|| !adc.cr().read().adcal())?;
    // Four clocks of the ADC pass before it may be switched on.
    cortex_m::asm::delay(16);
    adc.isr().write(|flags| flags.set_adrdy(true));
    adc.cr().modify(|control| control.set_aden(true));
    within(|| adc.isr().read().adrdy())?;
    let [first, second] = CURRENT_CHANNELS;
    // Channels 0 to 9, and 10 to 18.
    adc.smpr().write(|times| times.set_smp(usize::from(first), SampleTime::CYCLES24_5));
    adc.smpr2().write(|times| times.set_smp(usize::from(second) - 10, SampleTime::CYCLES24_5));
    adc.jsqr().write(|sequence| {
        sequence.set_jl(1);
        sequence.set_jextsel(TIM1_TRGO2);
        sequence.set_jexten(Exten::RISING_EDGE);
        sequence.set_jsq(0, first);
        sequence.set_jsq(1, second);
    });
    adc.cr().modify(|control| control.set_jadstart(true));
    Some(())
}
