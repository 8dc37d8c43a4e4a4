//! TIM1 as a full bridge: when which switch is on (RM0440, advanced-control timers).

use crate::store::Store;

/// Where its registers are.
pub const TIM1: u32 = 0x4001_2c00;
const CR1: u32 = 0x00;
const CR2: u32 = 0x04;
/// Status.
pub const SR: u32 = 0x10;
const EGR: u32 = 0x14;
const CCMR1: u32 = 0x18;
const CCER: u32 = 0x20;
const ARR: u32 = 0x2c;
const CCR1: u32 = 0x34;
const BDTR: u32 = 0x44;
const AF1: u32 = 0x60;
const AF2: u32 = 0x64;
const CCMR2: u32 = 0x1c;
const CCR4: u32 = 0x40;
const MOE: u32 = 1 << 15;
/// Break, second break, and break of the system.
pub const BREAKS: u32 = PIN_BREAK | SECOND_BREAK | SYSTEM_BREAK;
/// Flag of the second break input.
pub const SECOND_BREAK: u32 = 1 << 8;
/// Flag of the break input.
pub const PIN_BREAK: u32 = 1 << 7;
/// Flag of the system's breaks.
pub const SYSTEM_BREAK: u32 = 1 << 13;
const PWM_MODE_1: u32 = 6;

/// The timer's outputs.
#[derive(Debug, Default)]
#[allow(clippy::struct_excessive_bools, reason = "four signals, each by itself")]
pub struct Bridge {
    /// Compare values in force; those written come with the next update.
    shadow: [u32; 2],
    /// Reload value in force: PWM counts of half a period.
    half_period: u32,
    /// When the present half period ends, cycles; 0 before it starts.
    half_ends: u64,
    /// What was found good last: compare values and registers.
    seen: Option<([u32; 2], [u32; 4])>,
    /// The break input is at its active level.
    pub pin_active: bool,
    /// Comparators whose outputs are high, as bits of AF2.
    pub comparators: u32,
    /// The counter goes up.
    pub rising: bool,
    /// A break of the system lasts.
    pub system_active: bool,
    /// The core is halted and the timer with it.
    pub frozen: bool,
}

/// Clocks of dead time (RM0440, DTG).
fn dead_clocks(code: u32) -> u32 {
    match code {
        0..=0x7f => code,
        0x80..=0xbf => 2 * (64 + (code & 0x3f)),
        0xc0..=0xdf => 8 * (32 + (code & 0x1f)),
        _ => 16 * (32 + (code & 0x1f)),
    }
}

impl Bridge {
    /// A write of a register.
    ///
    /// # Errors
    /// The rule that it breaks.
    pub fn write(&mut self, offset: u32, value: u32, now: u64, store: &mut Store) -> Result<(), String> {
        let before = store.get(TIM1 + offset);
        let value = match offset {
            // Flags are cleared by 0, and set again while their cause lasts.
            SR => {
                store.set(TIM1 + SR, before & value);
                self.breaks(store);
                return Ok(());
            }
            EGR if value & 1 != 0 => {
                self.update(store);
                return Ok(());
            }
            BDTR if value & MOE != 0 && before & MOE == 0 => {
                self.may_be_on(value, store)?;
                // A break that lasts keeps it off (RM0440, using the break function).
                let second = self.second(store);
                if store.get(TIM1 + SR) & BREAKS != 0 || self.pin_active || second || self.system_active {
                    value & !MOE
                } else {
                    value
                }
            }
            BDTR if before & MOE != 0 && (value ^ before) & !MOE != 0 => {
                return Err("dead time and break are changed while the outputs are on".into());
            }
            _ => value,
        };
        store.set(TIM1 + offset, value);
        if offset == CR1 && value & 1 != 0 && before & 1 == 0 {
            if self.half_period == 0 {
                return Err("it is started before an update has taken over the period".into());
            }
            self.half_ends = now + u64::from(self.half_period);
            self.rising = true;
        }
        if store.get(TIM1 + BDTR) & MOE != 0 { self.legs(store) } else { Ok(()) }
    }

    /// Takes over what was written.
    fn update(&mut self, store: &Store) {
        self.half_period = store.get(TIM1 + ARR) & 0xffff;
        self.shadow = [0, 1].map(|leg| store.get(TIM1 + CCR1 + 4 * leg));
    }

    /// The end of the present half period, cycles, if the timer runs.
    pub fn ends(&self, store: &Store) -> Option<u64> {
        (store.get(TIM1 + CR1) & 1 != 0 && !self.frozen).then_some(self.half_ends)
    }

    /// Goes on to the next half period.
    ///
    /// # Errors
    /// A leg's switches would both be on.
    pub fn next(&mut self, store: &Store) -> Result<(), String> {
        self.update(store);
        self.rising = !self.rising;
        self.half_ends += u64::from(self.half_period);
        if store.get(TIM1 + BDTR) & MOE != 0 { self.legs(store) } else { Ok(()) }
    }

    /// Time has passed while the timer stood still.
    pub fn resume(&mut self, stood: u64) {
        self.half_ends += stood;
    }

    /// Breaks that last set their flags and switch off.
    pub fn breaks(&mut self, store: &mut Store) {
        let bdtr = store.get(TIM1 + BDTR);
        let pin = self.pin_active && bdtr & 1 << 12 != 0 && store.get(TIM1 + AF1) & 1 != 0;
        if pin {
            store.put(TIM1 + SR, PIN_BREAK, true);
        }
        if self.system_active {
            store.put(TIM1 + SR, SYSTEM_BREAK, true);
        }
        let second = self.second(store);
        if second {
            store.put(TIM1 + SR, SECOND_BREAK, true);
        }
        if pin || second || self.system_active {
            store.put(TIM1 + BDTR, MOE, false);
        }
    }

    /// A comparator acts on the second break.
    fn second(&self, store: &Store) -> bool {
        store.get(TIM1 + BDTR) & 1 << 24 != 0 && store.get(TIM1 + AF2) & self.comparators != 0
    }

    /// Whether TRGO2 rises once per period, close to the counter's lowest: OC4REF, in PWM mode 1.
    pub fn triggers(&self, store: &Store) -> bool {
        let chosen = store.get(TIM1 + CR2) >> 20 & 0xf == 7 && store.get(TIM1 + CCMR2) >> 12 & 7 == PWM_MODE_1;
        chosen && (1..self.half_period / 10).contains(&(store.get(TIM1 + CCR4) & 0xffff))
    }

    /// What the bridge gives in the present half period: parts of the supply with their clocks, one after the other.
    pub fn pieces(&self, store: &Store) -> Vec<(f64, u32)> {
        let (half, dead) = (self.half_period, dead_clocks(store.get(TIM1 + BDTR) & 0xff));
        // Each pulse ends on the way up, and begins, later by the dead time, on the way down.
        let edges = self.shadow.map(|compare| {
            let compare = compare.min(half);
            if self.rising { compare } else { half - compare.saturating_sub(dead) }
        });
        let mut ends = vec![edges[0], edges[1], half];
        ends.sort_unstable();
        let high = |leg: usize, at: u32| f64::from(u8::from((at < edges[leg]) == self.rising));
        let mut from = 0;
        let mut pieces = Vec::new();
        for end in ends {
            if end > from {
                pieces.push((high(0, from) - high(1, from), end - from));
                from = end;
            }
        }
        pieces
    }

    /// Whether the outputs are on.
    pub fn on(&self, store: &Store) -> bool {
        store.get(TIM1 + BDTR) & MOE != 0 && !self.frozen
    }

    /// Mean of what the bridge gives in this half period, −1 to 1 of the supply.
    pub fn drive(&self, store: &Store) -> f64 {
        if !self.on(store) || self.half_period == 0 {
            return 0.0;
        }
        let dead = dead_clocks(store.get(TIM1 + BDTR) & 0xff);
        // Of a period of two halves each pulse loses the dead time once.
        let pulse = |leg: usize| f64::from((2 * self.shadow[leg].min(self.half_period)).saturating_sub(dead));
        (pulse(0) - pulse(1)) / f64::from(2 * self.half_period)
    }

    /// What must be in place before the outputs are switched on.
    fn may_be_on(&self, bdtr: u32, store: &Store) -> Result<(), String> {
        let cr1 = store.get(TIM1 + CR1);
        let rule = if cr1 & 1 == 0 || self.half_period == 0 {
            "before the counter runs"
        } else if store.get(TIM1 + CCER) & 0xff != 0x55 {
            "before both outputs of both legs are enabled, active high (CCER)"
        } else if dead_clocks(bdtr & 0xff) == 0 {
            "without a dead time (DTG)"
        } else if bdtr & (3 << 10) != 3 << 10 {
            "and off would leave them floating (OSSI, OSSR)"
        } else if bdtr & 1 << 12 == 0 || store.get(TIM1 + AF1) & 1 == 0 {
            "without the break input (BKE, AF1.BKINE)"
        } else if store.get(TIM1 + AF2) & 1 != 0 {
            "with a second break input that has no pin (AF2.BK2INE)"
        } else if store.get(TIM1 + AF2) & 0xfe != 0 && bdtr & 3 << 24 != 3 << 24 {
            "without the break of the comparators, active high (BK2E, BK2P)"
        } else if bdtr & 1 << 14 != 0 {
            "and would come on again by themselves after a break (AOE)"
        } else if store.get(TIM1 + CR2) & 0xf00 != 0 {
            "and off would be on (OISx)"
        } else if let Some(pin) = crate::gpio::not_given(store) {
            return Err(format!("the outputs are switched on, but {pin} is not given to TIM1"));
        } else {
            return Ok(());
        };
        Err(format!("the outputs are switched on {rule}"))
    }

    /// Both switches of a leg are never on, and one is off for the dead time before the other comes on.
    fn legs(&mut self, store: &Store) -> Result<(), String> {
        let known = (self.shadow, [CCER, CCMR1, BDTR, ARR].map(|offset| store.get(TIM1 + offset)));
        if self.seen == Some(known) {
            return Ok(());
        }
        let (ccer, ccmr) = (store.get(TIM1 + CCER), store.get(TIM1 + CCMR1));
        for leg in 0..2 {
            let name = ["A", "B"][leg];
            if (ccmr >> (4 + 8 * leg)) & 7 != PWM_MODE_1 || ccmr >> (3 + 8 * leg) & 1 == 0 {
                return Err(format!("leg {name} is in another mode than PWM 1 with preload"));
            }
            let levels = Leg {
                compare: self.shadow[leg].min(self.half_period),
                half_period: self.half_period,
                dead: dead_clocks(store.get(TIM1 + BDTR) & 0xff),
                bits: (ccer >> (4 * leg)) & 0xf,
            };
            if let Some(at) = levels.shoot_through() {
                return Err(format!("both switches of leg {name} are on, {at} clocks after the counter's lowest"));
            }
        }
        self.seen = Some(known);
        Ok(())
    }
}

/// One leg in one period.
#[derive(Clone, Copy, Debug)]
pub struct Leg {
    /// Compare value, counts.
    pub compare: u32,
    /// Counts of half a period.
    pub half_period: u32,
    /// Dead time, clocks.
    pub dead: u32,
    /// Its bits of CCER: enabled, inverted, complement enabled, complement inverted.
    pub bits: u32,
}

impl Leg {
    /// The reference at a clock after the counter's lowest: up to the reload value and down again.
    fn reference(&self, at: u32) -> bool {
        let period = 2 * self.half_period;
        let at = at % period;
        // Counting up it is on below the compare value; counting down, from there on (RM0440, PWM mode 1).
        if at < self.half_period { at < self.compare } else { period - at <= self.compare }
    }

    /// High side and low side at a clock.
    pub fn levels(&self, at: u32) -> (bool, bool) {
        let period = 2 * self.half_period;
        // Each comes on only when the reference has been for it all through the dead time.
        let steady = |wanted: bool| {
            let start = at + period - self.dead.min(period - 1);
            // It has two edges: looking at its ends and at them is looking at all of it.
            let edges = [self.compare, period - self.compare, period + self.compare, 2 * period - self.compare];
            let inside = edges.into_iter().flat_map(|edge| [edge.saturating_sub(1), edge, edge + 1]);
            let inside = inside.filter(|clock| (start..=at + period).contains(clock));
            [start, at + period].into_iter().chain(inside).all(|clock| self.reference(clock) == wanted)
        };
        let high = self.bits & 1 != 0 && (steady(true) ^ (self.bits & 2 != 0));
        let low = self.bits & 4 != 0 && (steady(false) ^ (self.bits & 8 != 0));
        (high, low)
    }

    /// The first clock at which both switches are on, or at which one comes on while the other has just been.
    pub fn shoot_through(&self) -> Option<u32> {
        let period = 2 * self.half_period;
        let edges = [0, self.compare, self.half_period, period - self.compare];
        let near = edges
            .into_iter()
            .flat_map(|edge| [edge + period - 1, edge, edge + 1, edge + self.dead, edge + self.dead + 1]);
        near.map(|clock| clock % period).find(|clock| {
            let (high, low) = self.levels(*clock);
            let (high_before, low_before) = self.levels((clock + period - 1) % period);
            high && (low || low_before) || low && high_before
        })
    }
}
