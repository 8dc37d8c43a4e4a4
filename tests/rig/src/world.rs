//! What is outside of the microcontroller, and what is wrong with it.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use breakaway_core::link::FULL_SCALE_CODE;
use breakaway_firmware::board::{Applied, Clock, Drive, Encoder, Protection, RETAINED_WORDS, Retained, Trip, Wire};

use crate::TICK_HZ;

/// What the drive moves.
pub trait Motion {
    /// Position, counts.
    fn counts(&self) -> i32;
    /// One tick under a drive, drive codes.
    fn advance(&mut self, code: i16);
}

/// What is outside of the microcontroller, and what is wrong with it.
#[allow(clippy::struct_excessive_bools, reason = "independent things that break")]
#[derive(Debug, Default)]
pub struct World<P> {
    /// What the drive moves.
    pub plant: P,
    /// Largest drive that the power stage gives, drive codes; all of it where there is none.
    pub stage_limit: Option<i16>,
    /// Applied drive, drive codes.
    pub drive: i16,
    /// Whether the bridge is on.
    pub enabled: bool,
    /// Whether the bridge holds the motor's ends together.
    pub braking: bool,
    /// Largest drive that was asked for since this was last set, drive codes.
    pub asked: u32,
    /// The free-running clock, µs.
    pub now_us: u32,
    /// The count at which the encoder stands still.
    pub frozen: Option<i32>,
    /// One channel of the encoder is dead: the count toggles between this and the next.
    pub dead_channel: Option<i32>,
    /// Largest count added to the encoder's or taken from it, at random; 0: none.
    pub noise_counts: i32,
    /// State of the noise.
    pub noise: u32,
    /// Added to the encoder's count.
    pub jump: i32,
    /// The encoder fails.
    pub dead_encoder: bool,
    /// The encoder counts backwards.
    pub reversed: bool,
    /// The hardware has switched the drive off.
    pub trip: Option<Trip>,
    /// What is measured of the motor's current, mA.
    pub current_ma: Option<i32>,
    /// Largest that can be measured, mA; 0: none is.
    pub current_range_ma: u32,
    /// Level at which the board itself switches off, mA, as the application has set it.
    pub current_limit_ma: u32,
    /// The drive is what the settings say.
    pub simulated: bool,
    /// By how much each tick comes late, µs.
    pub late_us: u32,
    /// The drive fails.
    pub broken_drive: bool,
    /// The last reset was the watchdog's.
    pub watchdog_reset: bool,
    /// How often the watchdog was fed.
    pub fed: u32,
    /// Memory that a reset leaves.
    pub retained: [u32; RETAINED_WORDS],
    /// Bytes on their way to the board.
    pub to_board: VecDeque<u8>,
    /// Bytes that the board has sent.
    pub from_board: Vec<u8>,
}

impl<P: Motion> World<P> {
    /// One tick of the plant and the clock.
    pub fn advance(&mut self) {
        self.plant.advance(self.drive);
        self.now_us = self.now_us.wrapping_add(1_000_000 / TICK_HZ + self.late_us);
    }
}

/// The world as the board's parts.
#[derive(Debug, Default)]
pub struct Shared<P>(pub Rc<RefCell<World<P>>>);

impl<P> Clone for Shared<P> {
    fn clone(&self) -> Self {
        Self(Rc::clone(&self.0))
    }
}

impl<P: Motion> Encoder for Shared<P> {
    type Error = ();
    fn count(&mut self) -> Result<i32, ()> {
        let mut world = self.0.borrow_mut();
        let count = world.plant.counts() * if world.reversed { -1 } else { 1 };
        // Of the four states in a line, the live channel is high in two.
        let toggled = world.dead_channel.map(|at| at + i32::from(matches!(count.rem_euclid(4), 1 | 2)));
        let count = world.frozen.or(toggled).unwrap_or(count) + world.jump;
        let values = 2 * world.noise_counts.unsigned_abs() + 1;
        world.noise = world.noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let noise = ((u64::from(world.noise) * u64::from(values)) >> 32) as i32 - world.noise_counts;
        if world.dead_encoder { Err(()) } else { Ok(count + noise) }
    }
}

impl<P> Drive for Shared<P> {
    type Error = ();
    fn enable(&mut self) -> Result<(), ()> {
        let mut world = self.0.borrow_mut();
        (world.enabled, world.braking) = (true, false);
        Ok(())
    }
    fn apply(&mut self, command: i32) -> Result<Applied, ()> {
        let mut world = self.0.borrow_mut();
        if world.broken_drive {
            return Err(());
        }
        world.asked = world.asked.max(command.unsigned_abs());
        let limit = i32::from(world.stage_limit.unwrap_or(FULL_SCALE_CODE));
        let code = command.clamp(-limit, limit) as i16;
        world.drive = if world.enabled { code } else { 0 };
        Ok(Applied { code: world.drive, limited: i32::from(code) != command })
    }
    fn brake(&mut self) -> Result<(), ()> {
        self.off()?;
        self.0.borrow_mut().braking = true;
        Ok(())
    }
    fn off(&mut self) -> Result<(), ()> {
        let mut world = self.0.borrow_mut();
        (world.enabled, world.braking, world.drive) = (false, false, 0);
        Ok(())
    }
}

impl<P> Clock for Shared<P> {
    fn now_us(&self) -> u32 {
        self.0.borrow().now_us
    }
}

impl<P> Protection for Shared<P> {
    fn tripped(&mut self) -> Option<Trip> {
        self.0.borrow().trip
    }
    fn current_ma(&mut self) -> Option<i32> {
        self.0.borrow().current_ma
    }
    fn limit_current(&mut self, limit_ma: u32) {
        self.0.borrow_mut().current_limit_ma = limit_ma;
    }
    fn watchdog_reset(&self) -> bool {
        self.0.borrow().watchdog_reset
    }
    fn feed_watchdog(&mut self) {
        self.0.borrow_mut().fed += 1;
    }
}

impl<P> Retained for Shared<P> {
    fn read(&self) -> [u32; RETAINED_WORDS] {
        self.0.borrow().retained
    }
    fn write(&mut self, words: [u32; RETAINED_WORDS]) {
        self.0.borrow_mut().retained = words;
    }
}

impl<P> Wire for Shared<P> {
    fn read(&mut self, buffer: &mut [u8]) -> usize {
        let mut world = self.0.borrow_mut();
        let n = buffer.len().min(world.to_board.len());
        world.to_board.drain(..n).zip(buffer).for_each(|(byte, slot)| *slot = byte);
        n
    }
    fn write(&mut self, bytes: &[u8]) -> usize {
        self.0.borrow_mut().from_board.extend(bytes);
        bytes.len()
    }
}
