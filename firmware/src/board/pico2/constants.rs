//! All numbers of this board, with unit and reason. RP2350: its data sheet, build 2024-08 and later; DRV8871: data sheet
//! SLVSCY9. Pins are those of the chip (GP numbers); docs/board-pico2.md has the wiring.

use crate::board::FULL_SCALE;

/// What the board calls itself on the link.
pub const NAME: &str = "pico2";

/// Crystal, Hz (Pico 2 data sheet). Not the ring oscillator, whose time would be off by tens of per cent.
pub const CRYSTAL_HZ: u32 = 12_000_000;
/// Core, PWM and PIO, Hz: what the chip is specified for. The HAL sets 12 MHz · 125 / 5 / 2.
pub const CORE_HZ: u32 = 150_000_000;

/// Control ticks, Hz: those of the NUCLEO, so that its gains and budgets hold here.
pub const TICK_HZ: u32 = 10_000;
/// PWM, Hz: above hearing, and two whole periods per tick, so that every drive code is held equally long.
pub const PWM_HZ: u32 = 20_000;
/// PWM counts of full duty: the slice counts up to them and down again in one period.
pub const PWM_COUNTS: u16 = (CORE_HZ / PWM_HZ / 2) as u16;
/// Counts from one tick to the next.
pub const TICK_COUNTS: u16 = (CORE_HZ / TICK_HZ) as u16;
/// Dead time of the DRV8871, ns: typical; its data sheet gives no limits.
pub const DEAD_TIME_NS: u32 = 220;
/// What the dead time takes from each pulse, PWM counts: a pulse is two counts per clock long.
pub const DEAD_TIME_COUNTS: u16 = (DEAD_TIME_NS as u64 * CORE_HZ as u64 / 2 / 1_000_000_000) as u16;
/// Largest drive, drive codes: all of the supply. The DRV8871 has a charge pump, so that its high side may stay on.
pub const DRIVE_MAX_CODE: i16 = FULL_SCALE;
/// Supply of the bridge that the settings start with, V: the parts list's. The board does not measure it.
pub const SUPPLY_V: f32 = 12.0;

/// The bridge's IN1, on channel A of [`PWM_SLICE`]. Pads are pulled down by a reset, and the DRV8871 pulls its inputs down.
pub const IN1_PIN: usize = 2;
/// The bridge's IN2, on channel B of the same slice: one write changes both.
pub const IN2_PIN: usize = 3;
/// The slice of these two pins (RP2350, PWM, GPIO to slice mapping).
pub const PWM_SLICE: usize = 1;
/// The slice of the tick: the first of those that have no pins on this package.
pub const TICK_SLICE: usize = 8;
/// Encoder A; B is the next pin, as the PIO reads neighbours.
pub const ENCODER_PIN: usize = 6;
/// Emergency stop, closed to GND when all is well: pulled up, so that a cut wire and a missing plug switch off.
pub const STOP_PIN: usize = 8;
/// The lamp on the board: lit while the bridge is enabled.
pub const LAMP_PIN: usize = 25;

/// The watchdog resets the board after this many µs without a good tick. That is 50 ticks, more than a run tolerates
/// late ones ([`breakaway_core::link::Settings::overrun_limit`]), so that the fault with its cause comes first.
pub const WATCHDOG_US: u32 = 5_000;

/// Priority of the emergency stop's interrupt: above everything (RP2350: 4 bits, in the upper half).
pub const STOP_PRIORITY: u8 = 0;
/// Priority of the tick: above everything else.
pub const TICK_PRIORITY: u8 = 1 << 4;

/// USB vendor and product. These are the test numbers of pid.codes, for boards that stay with their maker: Breakaway
/// opens a port by its name. Who hands boards out takes a number of their own.
pub const USB_ID: (u16, u16) = (0x1209, 0x0001);
/// Bytes to the host that wait: 5 ms of samples at 10 kHz.
pub const SEND_BYTES: usize = 512;
/// Bytes from the host that wait: two packets of USB.
pub const RECEIVE_BYTES: usize = 128;
/// Polls after which what was sent has reached the host: ten frames of USB, 1 ms each. The tick wakes the thread.
pub const SENT_POLLS: u32 = 10 * TICK_HZ / 1000;

/// Flash, bytes (Pico 2 data sheet).
pub const FLASH_BYTES: u32 = 4 * 1024 * 1024;
/// A sector, the flash's erase page, bytes.
pub const SECTOR_BYTES: u32 = 4 * 1024;
/// Bytes that are programmed at once, at most.
pub const PAGE_BYTES: usize = 256;
/// Bytes for the settings: two sectors that take turns.
pub const SETTINGS_BYTES: u32 = 2 * SECTOR_BYTES;
/// Bytes of flash before the settings. The last sector is left alone: UF2 files of other tools write a block there
/// (RP2350, erratum E10).
pub const SETTINGS_AT: u32 = FLASH_BYTES - SECTOR_BYTES - SETTINGS_BYTES;

// Two periods of the PWM in a tick, whole clocks in both, and neighbours on one slice.
const _: () = assert!(PWM_HZ.is_multiple_of(TICK_HZ) && CORE_HZ.is_multiple_of(2 * PWM_HZ));
const _: () = assert!(CORE_HZ / TICK_HZ <= u16::MAX as u32);
const _: () = assert!(IN1_PIN / 2 % 8 == PWM_SLICE && IN1_PIN.is_multiple_of(2) && IN2_PIN == IN1_PIN + 1);
