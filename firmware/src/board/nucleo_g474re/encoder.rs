//! The quadrature encoder on TIM2 in encoder mode: 32 bits, four counts per line.

use core::convert::Infallible;

use embassy_stm32::pac;
use embassy_stm32::peripherals::TIM2;
use embassy_stm32::timer::qei::Qei;

use super::constants::ENCODER_FILTER;
use crate::board::Encoder;

/// The counter.
pub struct Quadrature(());

impl Quadrature {
    /// Takes the timer, counting.
    pub fn new(timer: Qei<'static, TIM2>) -> Self {
        pac::TIM2.ccmr_input(0).modify(|inputs| {
            inputs.set_icf(0, ENCODER_FILTER);
            inputs.set_icf(1, ENCODER_FILTER);
        });
        // All 32 bits; the driver knows of 16.
        pac::TIM2.arr().write_value(u32::MAX);
        // Stays as it is until the next reset; dropped, it would be switched off.
        core::mem::forget(timer);
        Self(())
    }
}

impl Encoder for Quadrature {
    type Error = Infallible;

    fn count(&mut self) -> Result<i32, Infallible> {
        Ok(pac::TIM2.cnt().read().cast_signed())
    }
}
