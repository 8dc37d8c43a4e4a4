//! From reset to running peripherals: clocks, pins, interrupts.

use embassy_stm32::gpio::{AfType, Flex, Level, Output, OutputType, Pin, Pull, Speed};
use embassy_stm32::rcc::{Hse, HseMode, Pll, PllMul, PllPreDiv, PllRDiv, PllSource, Sysclk};
use embassy_stm32::time::Hertz;
use embassy_stm32::{Config, Peri, pac};
use pac::flash::vals::Latency;
use pac::rcc::vals::Hpre;

use super::Nucleo;
use super::bridge::bridge;
use super::clock::Microseconds;
use super::constants::{CORE_HZ, CRYSTAL_HZ, CURRENT_RANGE_MA, LINK_FUNCTION, TIM1_FUNCTION, TIM2_FUNCTION};
use super::current::Current;
use super::encoder::Quadrature;
use super::flash::SettingsFlash;
use super::protection::{Guard, system_breaks};
use super::serial::Serial;
use super::ticks::TickTimer;
use crate::board::RetainedRam;

/// The board, in the parts that go different ways.
pub struct Parts {
    /// For the tick.
    pub board: Nucleo,
    /// What calls the tick.
    pub ticks: TickTimer,
    /// For the application.
    pub serial: Serial,
    /// For settings and model.
    pub flash: SettingsFlash,
    /// Largest current that is measured either way, mA; 0 where no amplifier was found.
    pub current_range_ma: u32,
}

/// Starts the board; once. The power stage is off and the watchdog runs: ticks must come within its time.
///
/// # Panics
/// On a second call; or if the constants ask of the hardware what it cannot do.
pub fn start() -> Parts {
    boost();
    let p = embassy_stm32::init(config());
    full_speed();
    // A core halted by the debugger must not leave the motor driven. The timer stops and takes its outputs off
    // (RM0440, debug mode of the advanced timers). And the watchdog must not bark at a breakpoint.
    pac::DBGMCU.apb2fzr().modify(|freeze| freeze.set_tim1(true));
    pac::DBGMCU.apb1lfzr().modify(|freeze| freeze.set_iwdg(true));

    clocks();
    system_breaks();

    // PA6, D12: break input.
    function(p.PA6, TIM1_FUNCTION, AfType::input(Pull::Up));
    let switch = AfType::output(OutputType::PushPull, Speed::VeryHigh);
    // PA8, D7: leg A high side. PA7, D11: its low side.
    function(p.PA8, TIM1_FUNCTION, switch);
    function(p.PA7, TIM1_FUNCTION, switch);
    // PA9, D8: leg B high side. PB0, A3: its low side.
    function(p.PA9, TIM1_FUNCTION, switch);
    function(p.PB0, TIM1_FUNCTION, switch);
    // PB5, D4: enable of the power stage. PA5, D13: the lamp LD2.
    let enable = Output::new(p.PB5, Level::Low, Speed::Low);
    let lamp = Output::new(p.PA5, Level::Low, Speed::Low);

    // PA0, A0: encoder A. PA1, A1: encoder B. Pulled up for open-collector encoders.
    function(p.PA0, TIM2_FUNCTION, AfType::input(Pull::Up));
    function(p.PA1, TIM2_FUNCTION, AfType::input(Pull::Up));

    // PA2, PA3: to the ST-LINK.
    function(p.PA2, LINK_FUNCTION, AfType::output(OutputType::PushPull, Speed::Medium));
    function(p.PA3, LINK_FUNCTION, AfType::input(Pull::None));
    // PC1, A4, and PB1: the shunt amplifier's output. Pins are analog after a reset.
    let bridge = bridge(enable, lamp);
    let current = Current::start();
    let current_range_ma = if current.is_some() { CURRENT_RANGE_MA } else { 0 };
    Parts {
        board: Nucleo {
            encoder: Quadrature::start(),
            bridge,
            clock: Microseconds::start(),
            guard: Guard::start(current),
            retained: RetainedRam,
        },
        ticks: TickTimer(()),
        serial: Serial::start(),
        flash: SettingsFlash::new(),
        current_range_ma,
    }
}

/// The core's voltage for more than 150 MHz, before the clock is (RM0440, PWR, range 1 boost mode). The HAL's `boost` alone does
/// not do it: its crate of the registers has R1MODE at bit 0, and it is bit 8.
fn boost() {
    const R1_MODE: u32 = 1 << 8;
    pac::RCC.apb1enr1().modify(|clocks| clocks.set_pwren(true));
    // Two clocks must pass before the first access.
    pac::RCC.apb1enr1().read();
    pac::PWR.cr5().modify(|range| range.0 &= !R1_MODE);
}

/// From half of [`CORE_HZ`], at which the HAL leaves the core, to all of it. A jump above 80 MHz in one step would dip
/// the core's voltage. So a microsecond at half of it comes first (RM0440, RCC, system clock selection). Prefetch is
/// on from here.
fn full_speed() {
    pac::FLASH.acr().modify(|access| {
        access.set_latency(Latency::WS4);
        access.set_prften(true);
    });
    while pac::FLASH.acr().read().latency() != Latency::WS4 {}
    cortex_m::asm::delay(CORE_HZ / 1_000_000);
    pac::RCC.cfgr().modify(|clocks| clocks.set_hpre(Hpre::DIV1));
}

/// Clocks of the peripherals that are driven on their registers. All are as a reset leaves them.
fn clocks() {
    pac::RCC.apb1enr1().modify(|clocks| {
        clocks.set_tim2en(true);
        clocks.set_tim5en(true);
        clocks.set_tim6en(true);
    });
    pac::RCC.ahb2enr().modify(|clocks| {
        clocks.set_adc12en(true);
        clocks.set_dac1en(true);
        clocks.set_dac3en(true);
    });
    pac::RCC.apb1enr2().modify(|clocks| clocks.set_lpuart1en(true));
    pac::RCC.apb2enr().modify(|clocks| {
        clocks.set_tim1en(true);
        clocks.set_syscfgen(true);
    });
    pac::RCC.apb1enr1().modify(|clocks| clocks.set_pwren(true));
    // Two clocks must pass before the first access (RM0440, peripheral clock enable).
    pac::RCC.apb2enr().read();
}

/// Gives a pin to a peripheral, until the next reset.
fn function(pin: Peri<'static, impl Pin>, number: u8, kind: AfType) {
    let mut pin = Flex::new(pin);
    pin.set_as_af_unchecked(number, kind);
    core::mem::forget(pin);
}

/// Half of 170 MHz from the crystal. Where the crystal does not start, nothing starts: LD2 stays dark and the link silent.
fn config() -> Config {
    let mut config = Config::default();
    config.rcc.hse = Some(Hse { freq: Hertz(CRYSTAL_HZ), mode: HseMode::Oscillator });
    config.rcc.pll = Some(Pll {
        source: PllSource::HSE,
        prediv: PllPreDiv::DIV6,
        mul: PllMul::MUL85,
        divp: None,
        divq: None,
        divr: Some(PllRDiv::DIV2),
    });
    config.rcc.sys = Sysclk::PLL1_R;
    config.rcc.boost = true;
    // Until `full_speed`.
    config.rcc.ahb_pre = Hpre::DIV2;
    config
}
