//! The timers without outputs: TIM2 counts the encoder, TIM5 microseconds, TIM6 makes the ticks.

use crate::gpio::given;
use crate::store::Store;

/// Where TIM2 is.
pub const TIM2: u32 = 0x4000_0000;
/// Where TIM5 is.
pub const TIM5: u32 = 0x4000_0c00;
/// Where TIM6 is.
pub const TIM6: u32 = 0x4000_1000;
const CR1: u32 = 0x00;
const SMCR: u32 = 0x08;
const DIER: u32 = 0x0c;
const SR: u32 = 0x10;
const EGR: u32 = 0x14;
const CCMR1: u32 = 0x18;
const CNT: u32 = 0x24;
const PSC: u32 = 0x28;
const ARR: u32 = 0x2c;
/// TIM2: both channels have changed at once.
pub const TRANSITION_ERROR: u32 = 1 << 23;
const TIM2_FUNCTION: u32 = 1;

/// A counter that goes up with the core's clock.
#[derive(Debug, Default)]
pub struct Counter {
    started: Option<u64>,
    divided_by: u64,
}

impl Counter {
    /// Its count.
    pub fn count(&self, now: u64) -> u64 {
        self.started.map_or(0, |start| (now - start) / self.divided_by.max(1))
    }
}

/// The three.
#[derive(Debug, Default)]
pub struct Timers {
    /// TIM5.
    pub microseconds: Counter,
    /// When TIM6 overflows next, cycles.
    pub tick_at: Option<u64>,
    /// The ticks' timer stands still: something has broken it.
    pub stuck: bool,
}

impl Timers {
    /// A write to one of them, `base` its address.
    ///
    /// # Errors
    /// The rule that it breaks.
    pub fn write(&mut self, base: u32, offset: u32, value: u32, now: u64, store: &mut Store) -> Result<(), String> {
        let before = store.get(base + offset);
        match (base, offset) {
            // Flags are cleared by 0.
            (_, SR) => store.set(base + SR, before & value),
            (TIM5, EGR) => self.microseconds.divided_by = u64::from(store.get(base + PSC)) + 1,
            (TIM5, CR1) if value & 1 != 0 && before & 1 == 0 => {
                if self.microseconds.divided_by != u64::from(store.get(base + PSC)) + 1 {
                    return Err("TIM5 is started before an update has taken over its prescaler".into());
                }
                self.microseconds.started = Some(now);
                store.set(base + offset, value);
            }
            (TIM2, CR1) if value & 1 != 0 && before & 1 == 0 => {
                counts_an_encoder(store)?;
                store.set(base + offset, value);
            }
            (TIM2, SMCR | CCMR1) if store.get(TIM2 + CR1) & 1 != 0 => {
                return Err("the encoder's inputs are set while it counts".into());
            }
            (TIM6, CR1) if value & 1 != 0 && before & 1 == 0 => {
                self.tick_at = Some(now + period(store));
                store.set(base + offset, value);
            }
            _ => store.set(base + offset, value),
        }
        Ok(())
    }

    /// A read; `encoder` is its count.
    pub fn read(&self, base: u32, offset: u32, now: u64, encoder: impl FnOnce() -> i32, store: &Store) -> u32 {
        match (base, offset) {
            (TIM2, CNT) if store.get(TIM2 + CR1) & 1 != 0 => encoder().cast_unsigned(),
            (TIM5, CNT) => self.microseconds.count(now) as u32,
            _ => store.get(base + offset),
        }
    }

    /// Whether TIM6 has overflowed by now. Sets its flag, and says whether it asks for an interrupt.
    pub fn overflow(&mut self, now: u64, store: &mut Store) -> bool {
        let Some(at) = self.tick_at.filter(|at| *at <= now) else { return false };
        self.tick_at = Some(at + period(store));
        if self.stuck {
            return false;
        }
        store.put(TIM6 + SR, 1, true);
        store.get(TIM6 + DIER) & 1 != 0
    }

    /// Whether TIM6 still asks for its interrupt.
    pub fn asks(store: &Store) -> bool {
        store.get(TIM6 + SR) & store.get(TIM6 + DIER) & 1 != 0
    }
}

fn period(store: &Store) -> u64 {
    (u64::from(store.get(TIM6 + ARR) & 0xffff) + 1) * (u64::from(store.get(TIM6 + PSC)) + 1)
}

/// Encoder mode 3 on both channels from their own pins, and all 32 bits.
fn counts_an_encoder(store: &Store) -> Result<(), String> {
    let inputs = store.get(TIM2 + CCMR1);
    if store.get(TIM2 + SMCR) & 7 != 3 || inputs & 3 != 1 || (inputs >> 8) & 3 != 1 {
        return Err("it counts something other than an encoder's four edges".into());
    }
    if store.get(TIM2 + ARR) != u32::MAX {
        return Err("the encoder's count has fewer than 32 bits".into());
    }
    if !given((0, 0), TIM2_FUNCTION, store) || !given((0, 1), TIM2_FUNCTION, store) {
        return Err("PA0 or PA1 is not given to TIM2".into());
    }
    Ok(())
}
