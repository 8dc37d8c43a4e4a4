//! The quadrature encoder on a state machine of PIO0: 32 bits, four counts per line (see
//! [`program`](super::super::program)).

use super::pins::{self, Function, Pull};
use super::registers::pio;
use crate::board::Encoder;
use crate::board::pico2::constants::ENCODER_PIN;
use crate::board::pico2::program::{ERROR_FLAG, LAST, PROGRAM, ROUND, START};

/// The state machine.
const MACHINE: usize = 0;

/// Both channels have changed at once: a count was lost or added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TransitionError;

/// The counter.
pub struct Quadrature(());

impl Quadrature {
    /// Loads and starts it; once. PIO0 is out of reset.
    pub(super) fn start() -> Self {
        // Pulled up for open-collector encoders.
        pins::connect(ENCODER_PIN, Function::Pio0, Pull::Up);
        pins::connect(ENCODER_PIN + 1, Function::Pio0, Pull::Up);
        let machine = pio().sm(MACHINE);
        // SAFETY: the fields' widths hold these values; instructions are those of the program's file.
        unsafe {
            for (at, instruction) in PROGRAM.into_iter().enumerate() {
                pio().instr_mem(at).write(|word| word.bits(u32::from(instruction)));
            }
            // One instruction per clock.
            machine.sm_clkdiv().write(|divider| divider.int().bits(1));
            machine.sm_execctrl().write(|control| control.wrap_top().bits(LAST).wrap_bottom().bits(ROUND));
            // Samples are shifted in from the right. The receive FIFO is storage that the program puts the count into.
            machine.sm_shiftctrl().write(|control| control.in_shiftdir().clear_bit().fjoin_rx_put().set_bit());
            machine.sm_pinctrl().write(|pins| pins.in_base().bits(ENCODER_PIN as u8));
            for instruction in START.into_iter().chain([u16::from(ROUND)]) {
                // The last is a jump: its code is its target.
                machine.sm_instr().write(|word| word.bits(u32::from(instruction)));
            }
            pio().ctrl().write(|control| control.sm_enable().bits(1 << MACHINE));
        }
        Self(())
    }
}

impl Encoder for Quadrature {
    type Error = TransitionError;

    fn count(&mut self) -> Result<i32, TransitionError> {
        if pio().irq().read().bits() >> ERROR_FLAG & 1 != 0 {
            // SAFETY: writing 1 clears a flag.
            pio().irq().write(|flags| unsafe { flags.bits(1 << ERROR_FLAG) });
            return Err(TransitionError);
        }
        Ok(pio().rxf0_putget(0).read().bits().cast_signed())
    }
}
