//! Pads and functions of the pins. A pad is isolated after a reset until it is told otherwise (RP2350, pads, isolation).

use super::registers::{io, pads, sio};

/// The pull of an input.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Pull {
    Up,
    Down,
}

/// What is connected to a pin, beside the PWM (RP2350, GPIO functions).
#[derive(Clone, Copy)]
pub(super) enum Function {
    Sio,
    Pio0,
}

/// Sets a pin up: what is connected to it first, then the pad.
pub(super) fn connect(pin: usize, function: Function, pull: Pull) {
    io().gpio(pin).gpio_ctrl().write(|control| match function {
        Function::Sio => control.funcsel().sio(),
        Function::Pio0 => control.funcsel().pio0(),
    });
    pad(pin, pull);
}

/// Sets a pin up as the PWM's output, held low until [`release`].
pub(super) fn connect_low(pin: usize) {
    hold_low(pin);
    pad(pin, Pull::Down);
}

/// Holds an output of the PWM low, whatever the slice says.
#[inline]
pub(super) fn hold_low(pin: usize) {
    io().gpio(pin).gpio_ctrl().write(|control| control.funcsel().pwm().outover().low());
}

/// Lets the slice say what the output is.
#[inline]
pub(super) fn release(pin: usize) {
    io().gpio(pin).gpio_ctrl().write(|control| control.funcsel().pwm());
}

fn pad(pin: usize, pull: Pull) {
    pads().gpio(pin).write(|pad| {
        pad.ie().set_bit().schmitt().set_bit();
        pad.pue().bit(pull == Pull::Up).pde().bit(pull == Pull::Down);
        pad.iso().clear_bit()
    });
}

/// Whether a pin is high.
#[inline]
pub(super) fn is_high(pin: usize) -> bool {
    sio().gpio_in().read().bits() >> pin & 1 != 0
}

/// Makes a pin an output of the program, low.
pub(super) fn drive(pin: usize) {
    set(pin, false);
    // SAFETY: a bit per pin.
    sio().gpio_oe_set().write(|pins| unsafe { pins.bits(1 << pin) });
}

/// Sets an output of the program.
#[inline]
pub(super) fn set(pin: usize, high: bool) {
    // SAFETY: a bit per pin; both registers change no other.
    if high {
        sio().gpio_out_set().write(|pins| unsafe { pins.bits(1 << pin) });
    } else {
        sio().gpio_out_clr().write(|pins| unsafe { pins.bits(1 << pin) });
    }
}
