//! The quadrature encoder on TIM2 in encoder mode: 32 bits, four counts per line.

use embassy_stm32::pac;
use embassy_stm32::pac::timer::vals::{CcmrInputCcs, Sms};

use super::constants::ENCODER_FILTER;
use crate::board::Encoder;

/// TIM2_SR, TERRF: both channels have changed at once, so that the count is off (RM0440, TIM2, encoder error management). The crate
/// of the registers does not name it.
const TRANSITION_ERROR: u32 = 1 << 23;

/// The bits of TIM2_SR that are flags (RM0440).
const FLAGS: u32 = 0x00f0_1e5f;

/// Both channels have changed at once: a count was lost or added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TransitionError;

/// The counter.
pub struct Quadrature(());

impl Quadrature {
    /// Starts it; once. TIM2 has its clock and its pins.
    pub(super) fn start() -> Self {
        pac::TIM2.ccmr_input(0).write(|inputs| {
            for input in [0, 1] {
                // Each channel from its own pin (the register's 01).
                inputs.set_ccs(input, CcmrInputCcs::TI4);
                inputs.set_icf(input, ENCODER_FILTER);
            }
        });
        pac::TIM2.smcr().write(|mode| mode.set_sms(Sms::ENCODER_MODE_3));
        pac::TIM2.arr().write_value(u32::MAX);
        pac::TIM2.cr1().write(|control| control.set_cen(true));
        Self(())
    }
}

impl Encoder for Quadrature {
    type Error = TransitionError;

    fn count(&mut self) -> Result<i32, TransitionError> {
        if pac::TIM2.sr().read().0 & TRANSITION_ERROR != 0 {
            // Flags written as 1 keep their value; what is no flag takes 0.
            pac::TIM2.sr().write(|flags| flags.0 = FLAGS & !TRANSITION_ERROR);
            return Err(TransitionError);
        }
        Ok(pac::TIM2.cnt().read().cast_signed())
    }
}
