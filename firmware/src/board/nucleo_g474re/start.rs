//! From reset to running peripherals: clocks, pins, interrupts.

use embassy_stm32::gpio::{AfType, Flex, Level, Output, OutputType, Pull, Speed};
use embassy_stm32::interrupt::InterruptExt;
use embassy_stm32::mode::Async;
use embassy_stm32::rcc::{Hse, HseMode, Pll, PllMul, PllPreDiv, PllRDiv, PllSource, Sysclk};
use embassy_stm32::time::Hertz;
use embassy_stm32::timer::complementary_pwm::{ComplementaryPwm, ComplementaryPwmPin};
use embassy_stm32::timer::low_level::{CountingMode, Timer};
use embassy_stm32::timer::qei::{self, Qei};
use embassy_stm32::timer::simple_pwm::PwmPin;
use embassy_stm32::usart::{self, Uart, UartTx};
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_stm32::{Config, bind_interrupts, dma, flash, interrupt, pac, peripherals};

use super::Nucleo;
use super::bridge::bridge;
use super::clock::Microseconds;
use super::constants::{BREAK_FUNCTION, CRYSTAL_HZ, OTHER_PRIORITY, PWM_HZ, RECEIVE_BYTES, WATCHDOG_US};
use super::encoder::Quadrature;
use super::flash::SettingsFlash;
use super::protection::Guard;
use super::retained::RetainedRam;
use super::serial::{Outgoing, Serial};
use super::ticks::TickTimer;

bind_interrupts!(struct Interrupts {
    LPUART1 => usart::InterruptHandler<peripherals::LPUART1>;
    DMA1_CHANNEL1 => dma::InterruptHandler<peripherals::DMA1_CH1>;
    DMA1_CHANNEL2 => dma::InterruptHandler<peripherals::DMA1_CH2>;
    FLASH => flash::InterruptHandler;
});

/// The board, in the parts that go different ways.
pub struct Parts {
    /// For the tick.
    pub board: Nucleo,
    /// What calls the tick.
    pub ticks: TickTimer,
    /// For the application.
    pub serial: Serial,
    /// Sends what the application has written: see [`super::send`].
    pub transmitter: UartTx<'static, Async>,
    /// What the application has written.
    pub outgoing: &'static Outgoing,
    /// For settings and model.
    pub flash: SettingsFlash,
}

/// Starts the board; once. The power stage is off and the watchdog runs: ticks must come within its time.
///
/// # Panics
/// On a second call; or if the constants ask of the hardware what it cannot do.
pub fn start() -> Parts {
    let p = embassy_stm32::init(config());
    // A core halted by the debugger must not leave the motor driven: the timer stops and takes its outputs off (RM0440,
    // debug mode of the advanced timers). And the watchdog must not bark at a breakpoint.
    pac::DBGMCU.apb2fzr().modify(|freeze| freeze.set_tim1(true));
    pac::DBGMCU.apb1lfzr().modify(|freeze| freeze.set_iwdg(true));
    for other in [interrupt::LPUART1, interrupt::DMA1_CHANNEL1, interrupt::DMA1_CHANNEL2, interrupt::FLASH] {
        other.set_priority(OTHER_PRIORITY);
    }

    // PA6, D12: break input.
    let mut break_input = Flex::new(p.PA6);
    break_input.set_as_af_unchecked(BREAK_FUNCTION, AfType::input(Pull::Up));
    // Stays as it is until the next reset.
    core::mem::forget(break_input);
    let pwm = ComplementaryPwm::new(
        p.TIM1,
        // PA8, D7: leg A high side. PA7, D11: its low side.
        Some(PwmPin::new(p.PA8, OutputType::PushPull)),
        Some(ComplementaryPwmPin::new(p.PA7, OutputType::PushPull)),
        // PA9, D8: leg B high side. PB0, A3: its low side.
        Some(PwmPin::new(p.PA9, OutputType::PushPull)),
        Some(ComplementaryPwmPin::new(p.PB0, OutputType::PushPull)),
        None,
        None,
        None,
        None,
        Hertz(PWM_HZ),
        CountingMode::CenterAlignedBothInterrupts,
    );
    // PB5, D4: enable of the power stage. PA5, D13: the lamp LD2.
    let enable = Output::new(p.PB5, Level::Low, Speed::Low);
    let lamp = Output::new(p.PA5, Level::Low, Speed::Low);

    // PA0, A0: encoder A. PA1, A1: encoder B. Pulled up for open-collector encoders.
    let inputs = qei::Config { ch1_pull: Pull::Up, ch2_pull: Pull::Up, ..qei::Config::default() };
    let encoder = Qei::new(p.TIM2, p.PA0, p.PA1, inputs);

    // PA2, PA3: to the ST-LINK.
    let mut line = usart::Config::default();
    line.baudrate = breakaway_core::link::BAUD;
    let uart = Uart::new(p.LPUART1, p.PA3, p.PA2, p.DMA1_CH1, p.DMA1_CH2, Interrupts, line);
    let (Ok(uart), Some(received), Some(outgoing)) = (
        uart,
        cortex_m::singleton!(: [u8; RECEIVE_BYTES] = [0; RECEIVE_BYTES]),
        cortex_m::singleton!(: Outgoing = Outgoing::new(heapless::Vec::new())),
    ) else {
        panic!("started twice, or a baud rate out of reach");
    };
    let (transmitter, receiver) = uart.split();
    Parts {
        board: Nucleo {
            encoder: Quadrature::new(encoder),
            bridge: bridge(pwm, enable, lamp),
            clock: Microseconds::start(p.TIM5),
            guard: Guard::start(IndependentWatchdog::new(p.IWDG, WATCHDOG_US)),
            retained: RetainedRam,
        },
        ticks: TickTimer(Timer::new(p.TIM6)),
        serial: Serial::new(receiver.into_ring_buffered(received), outgoing),
        transmitter,
        outgoing,
        flash: SettingsFlash::new(flash::Flash::new(p.FLASH, Interrupts)),
    }
}

/// 170 MHz from the crystal. Where the crystal does not start, nothing starts: LD2 stays dark and the link silent.
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
    // Above 150 MHz (RM0440, voltage scaling).
    config.rcc.boost = true;
    config
}
