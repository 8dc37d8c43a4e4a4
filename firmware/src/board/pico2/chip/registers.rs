//! The registers, from wherever the program is: tick, emergency stop and panic handler write some of them without
//! owning the peripheral.

use rp235x_hal::pac;

macro_rules! registers {
    ($($name:ident: $peripheral:ident, $module:ident;)*) => {$(
        #[inline]
        pub(super) fn $name() -> &'static pac::$module::RegisterBlock {
            // SAFETY: the registers are there for ever. Accesses are volatile, of whole words; those that more than one
            // of tick, handlers and thread write are written whole, never read and changed.
            unsafe { &*pac::$peripheral::ptr() }
        }
    )*};
}

registers! {
    io: IO_BANK0, io_bank0;
    pads: PADS_BANK0, pads_bank0;
    pio: PIO0, pio0;
    psm: PSM, psm;
    pwm: PWM, pwm;
    resets: RESETS, resets;
    sio: SIO, sio;
    timer: TIMER0, timer0;
    watchdog: WATCHDOG, watchdog;
}
