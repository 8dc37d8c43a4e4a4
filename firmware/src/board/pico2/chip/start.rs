//! From reset to running peripherals.

use rp235x_hal::block::ImageDef;
use rp235x_hal::clocks::init_clocks_and_plls;
use rp235x_hal::pac;
use rp235x_hal::usb::UsbBus;
use rp235x_hal::watchdog::Watchdog;

use super::bridge::bridge;
use super::clock::Microseconds;
use super::encoder::Quadrature;
use super::flash::SettingsFlash;
use super::protection::Guard;
use super::registers::resets;
use super::serial::Serial;
use super::ticks::TickTimer;
use super::{Pico2, stop};
use crate::board::RetainedRam;
use crate::board::pico2::constants::CRYSTAL_HZ;

/// Tells the boot ROM what this is: a program for the Arm cores of an RP2350 (RP2350, boot ROM, minimum image
/// definition). link.x puts it where the boot ROM looks.
#[unsafe(link_section = ".image_definition")]
#[unsafe(no_mangle)]
pub static IMAGE_DEFINITION: ImageDef = ImageDef::secure_exe();

/// The board, in the parts that go different ways.
pub struct Parts {
    /// For the tick.
    pub board: Pico2,
    /// What calls the tick.
    pub ticks: TickTimer,
    /// For the application.
    pub serial: Serial,
    /// For settings and model.
    pub flash: SettingsFlash,
}

/// Starts the board; once. The power stage is off. The watchdog starts with the ticks: what is kept in flash is read
/// before, and may take longer than its time.
///
/// Core 1 stays where the boot ROM left it, asleep: one core does what is to be done, and what it does needs no lock.
///
/// # Panics
/// On a second call; or if the clocks do not come up. Where the crystal does not start, nothing starts: the lamp stays
/// dark and the port does not appear.
pub fn start() -> Parts {
    let (Some(p), Some(core)) = (pac::Peripherals::take(), cortex_m::Peripherals::take()) else {
        panic!("started twice");
    };
    bring_up();
    // Pins first: until here the pads' pull-downs hold the bridge off.
    let bridge = bridge();
    let mut resets = p.RESETS;
    let mut watchdog = Watchdog::new(p.WATCHDOG);
    let (xosc, plls) = (p.XOSC, (p.PLL_SYS, p.PLL_USB));
    // It starts the microseconds of timer and watchdog as well.
    let Ok(clocks) = init_clocks_and_plls(CRYSTAL_HZ, xosc, p.CLOCKS, plls.0, plls.1, &mut resets, &mut watchdog)
    else {
        panic!("the clocks do not come up");
    };
    stop::watch();
    let serial = Serial::start(UsbBus::new(p.USB, p.USB_DPRAM, clocks.usb_clock, true, &mut resets));
    Parts {
        board: Pico2 {
            encoder: Quadrature::start(),
            bridge,
            clock: Microseconds(()),
            guard: Guard::new(),
            retained: RetainedRam,
        },
        ticks: TickTimer(core.NVIC),
        serial,
        flash: SettingsFlash::new(),
    }
}

/// Takes the peripherals that are driven on their registers out of their reset.
fn bring_up() {
    resets().reset().modify(|_, held| {
        held.io_bank0().clear_bit().pads_bank0().clear_bit();
        held.pwm().clear_bit().pio0().clear_bit().timer0().clear_bit()
    });
    loop {
        let done = resets().reset_done().read();
        let pins = done.io_bank0().bit() && done.pads_bank0().bit();
        if pins && done.pwm().bit() && done.pio0().bit() && done.timer0().bit() {
            return;
        }
    }
}
