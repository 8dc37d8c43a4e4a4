//! All numbers of this board, with unit and reason. RM0440: reference manual of the STM32G4; DS12288: data sheet of the
//! STM32G474; UM2505: the NUCLEO-64 boards. Pins are in `start.rs`, and in docs/board-nucleo-g474re.md with the wiring.

use embassy_stm32::interrupt::Priority;
use embassy_stm32::pac::timer::vals::{Bkp, FilterValue};

use crate::board::{FULL_SCALE, Trip};

/// What the board calls itself on the link.
pub const NAME: &str = "nucleo-g474re";

/// Crystal X3, Hz (UM2505). Not the RC oscillator: 1 % of its time would be 2 % of every inertia.
pub const CRYSTAL_HZ: u32 = 24_000_000;
/// Core, buses and timers, Hz: the most there is (DS12288, general operating conditions). 24 MHz / 6 · 85 / 2.
pub const CORE_HZ: u32 = 170_000_000;

/// Control ticks, Hz. An integer number of core clocks (17 000), so that a tick has no jitter from rounding.
pub const TICK_HZ: u32 = 10_000;
/// The clock behind [`crate::board::Clock`], Hz: it counts microseconds.
pub const CLOCK_HZ: u32 = 1_000_000;

/// PWM, Hz: above hearing, and two whole periods per tick, so that every drive code is held equally long.
pub const PWM_HZ: u32 = 20_000;
/// PWM counts of full duty: the timer counts up to them and down again in one period.
pub const PWM_COUNTS: u16 = (CORE_HZ / PWM_HZ / 2) as u16;
/// Dead time between the two switches of a leg, core clocks: 494 ns. Longer than the turn-off of common 30 A bridges
/// (under 300 ns). For yours, take the turn-off delay plus fall time from its data sheet and add half. Even, so that
/// [`DEAD_TIME_COUNTS`] is exact.
pub const DEAD_TIME_CLOCKS: u16 = 84;
/// The dead time as TIM1 takes it (RM0440, DTG): in steps of 1, 2 or 8 clocks, the longer the coarser. One that does not lie on a
/// step does not compile.
pub const DEAD_TIME_CODE: u8 = match DEAD_TIME_CLOCKS {
    clocks @ 0..=127 => clocks as u8,
    clocks @ 128..=254 if clocks.is_multiple_of(2) => 0x80 | (clocks / 2 - 64) as u8,
    clocks @ 256..=504 if clocks.is_multiple_of(8) => 0xc0 | (clocks / 8 - 32) as u8,
    _ => panic!("no such dead time"),
};
/// What the dead time takes from each pulse, PWM counts: a pulse of a centre-aligned PWM is two counts per clock long.
pub const DEAD_TIME_COUNTS: u16 = DEAD_TIME_CLOCKS / 2;
/// Largest drive, drive codes: 95 % of the supply. The high side's bootstrap capacitor is charged in the rest.
pub const DRIVE_MAX_CODE: i16 = (FULL_SCALE as i32 * 95 / 100) as i16;

/// The level at which the break input switches off. High with a pull-up: a cut wire and a missing plug switch off. For
/// a power stage whose fault output is low when tripped (open drain), `ACTIVE_LOW`; then a cut wire is not noticed.
pub const BREAK_LEVEL: Bkp = Bkp::ACTIVE_HIGH;
/// The break input must stay for 8 samples at 1/8 of the core clock, 0.38 µs. That is longer than the spikes of a
/// switching leg, and a tenth of what a short circuit takes to destroy a transistor.
pub const BREAK_FILTER: FilterValue = FilterValue::FDTS_DIV8_N8;
/// What is wired to the break input (D12). Where that is the fault output of the power stage: `Trip::Break(1)`.
pub const BREAK_PIN: Trip = Trip::EmergencyStop;
/// What the controller's own breaks are called in the fault record: clock failure, lock-up of the core, supply.
pub const SYSTEM_BREAK: Trip = Trip::Break(2);
/// The supply of the controller below which TIM1 switches off (RM0440, programmable voltage detector, PLS): about 2.8 V. Below the
/// 3.3 V of the board with its tolerance, above the 1.7 V at which the reset comes.
pub const SUPPLY_LEVEL: u8 = 0b101;
/// The alternate function that is TIM1 on PA6 to PA9 and PB0 (DS12288, alternate function mapping).
pub const TIM1_FUNCTION: u8 = 6;
/// That which is TIM2 on PA0 and PA1.
pub const TIM2_FUNCTION: u8 = 1;

/// The second break input, which the comparators of the over-current act on, is filtered as the first.
pub const OVER_CURRENT_FILTER: FilterValue = BREAK_FILTER;

/// Shunt in the motor's lead, µΩ. A property of *your* stage, as the next one: 10 mΩ is 0.1 W at 3 A.
pub const SHUNT_MICRO_OHM: u64 = 10_000;
/// Gain of the shunt amplifier, V/V: an INA240A2 (data sheet SBOS662), which rejects the steps of the PWM on the motor's lead. Its
/// output is half of the 3.3 V without a current, and rises with a current from leg A to leg B.
pub const AMPLIFIER_GAIN: u64 = 50;
/// Reference of ADC and DAC, mV: VREF+ is the board's 3.3 V (UM2505).
pub const REFERENCE_MV: u64 = 3_300;
/// mA per code of the ADC, times 2¹⁶: 1.611 mA. 3.3 V / 4096 / (50 · 10 mΩ).
pub const MA_PER_CODE_Q16: i32 = (REFERENCE_MV * 1_000_000 * 65_536 / (4096 * AMPLIFIER_GAIN * SHUNT_MICRO_OHM)) as i32;
/// Largest current that is measured either way, codes: 1.45 V. The amplifier's output comes to within 0.2 V of its supplies.
pub const CURRENT_RANGE_CODES: u32 = 1_800;
/// The same, mA: 2900.
pub const CURRENT_RANGE_MA: u32 = (CURRENT_RANGE_CODES as u64 * MA_PER_CODE_Q16 as u64 / 65_536) as u32;
/// ADC1's channels of the amplifier's output: IN7 is PC1 (A4), IN12 is PB1. The first is an input of COMP3, the second of COMP1
/// (DS12288, pin definitions; RM0440, COMP, input assignment).
pub const CURRENT_CHANNELS: [u8; 2] = [7, 12];
/// TIM1's channel 4 triggers the ADC so many counts before the counter is lowest. That is the first sample's time, 24.5
/// clocks of 42.5 MHz. The value at its end is held, in the middle of the pulse. The source may have some 5 kΩ (DS12288).
pub const CURRENT_TRIGGER: u16 = 98;
/// What the ADC should read without a current, codes.
pub const CURRENT_MIDDLE: u16 = 2_048;
/// By how much it may be off, codes: 3 % of the 3.3 V, for a divider of 1 % and the offset of amplifier and ADC.
pub const CURRENT_OFFSET: u16 = 123;
/// By how much both pins may differ, codes: 64 mA. They are sampled 0.9 µs apart. The current of a winding of 0.5 mH
/// changes by 42 mA in that time at 24 V; the rest is noise.
pub const CURRENT_PAIR: u16 = 40;
/// Ticks in a row in which they differ by more before the measurement counts as broken.
pub const CURRENT_PAIR_TICKS: u8 = 3;
/// Periods of the PWM over which the offset is a mean: 3.2 ms. The noise of the mean is then below a code.
pub const CURRENT_SAMPLES: u32 = 64;
/// Largest difference among these samples, codes: noise. A pin to which nothing is connected picks up more, or floats to a supply.
pub const CURRENT_SPREAD: u16 = 48;
/// Level of the comparators, percent of `current_max_ma`. The ripple of the PWM, and the time that the limit of the program allows,
/// are below it.
pub const TRIP_PERCENT: u32 = 150;

/// An encoder edge must stay for 8 samples at 1/4 of the core clock, 0.19 µs. Bounce and cross-talk are shorter. A
/// quarter of a line at the fastest motor is longer (10 000 lines at 6000 rpm: 0.25 µs).
pub const ENCODER_FILTER: FilterValue = FilterValue::FDTS_DIV4_N8;

/// The watchdog resets the board after this many µs without a good tick. That is 50 ticks, more than a run tolerates
/// late ones ([`breakaway_core::link::Settings::overrun_limit`]), so that the fault with its cause comes first.
pub const WATCHDOG_US: u32 = 5_000;
/// The watchdog's reload value: steps of 4 periods of the LSI, 32 kHz.
pub const WATCHDOG_RELOAD: u16 = (WATCHDOG_US / 4 * 32 / 1000 - 1) as u16;

/// The tick is above everything else.
pub const TICK_PRIORITY: Priority = Priority::P0;
/// The alternate function that is LPUART1 on PA2 and PA3 (DS12288, alternate function mapping).
pub const LINK_FUNCTION: u8 = 12;
/// Received bytes that wait: 1.4 ms at 921 600 baud, many polls. A host that waits for each answer has no more than
/// one request on the way.
pub const RECEIVE_BYTES: usize = 128;
/// Most bytes in one DMA transfer to the host, 1.4 ms; while one is sent the next is collected.
pub const SEND_BYTES: usize = 128;

/// Bytes of flash before the settings: the last two pages of bank 2. Code is in bank 1 (memory.x), so that the core
/// goes on fetching from there while bank 2 is erased (RM0440, read while write). So a save does not delay ticks.
pub const SETTINGS_AT: u32 = (512 - 4) * 1024;
/// Bytes for the settings: two erase pages of 2 KiB (RM0440, dual-bank organisation).
pub const SETTINGS_BYTES: u32 = 2 * SETTINGS_PAGE_BYTES;
/// An erase page, bytes.
pub const SETTINGS_PAGE_BYTES: u32 = 2 * 1024;
/// Number of the first of them in bank 2, which starts at 256 KiB.
pub const SETTINGS_PAGE: u8 = ((SETTINGS_AT - 256 * 1024) / SETTINGS_PAGE_BYTES) as u8;
