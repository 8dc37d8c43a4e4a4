//! A board in memory for the application: a mass on a drive, whose link is two queues.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use breakaway_firmware::board::{Applied, Clock, Drive, Encoder, Protection, RETAINED_WORDS, Retained, Trip, Wire};

/// Control ticks per second.
pub const TICK_HZ: u32 = 1000;

/// What is outside of the microcontroller.
#[derive(Debug, Default)]
pub struct World {
    /// Position, 1/256 count.
    position: i64,
    /// 1/256 count per tick.
    speed: i64,
    /// Applied drive, drive codes.
    pub drive: i16,
    enabled: bool,
    now_us: u32,
    retained: [u32; RETAINED_WORDS],
    /// Bytes on their way to the board.
    pub to_board: VecDeque<u8>,
    /// Bytes that the board has sent.
    pub from_board: Vec<u8>,
    /// Largest drive that was asked for since this was last set, drive codes.
    pub asked: u32,
}

impl World {
    /// The mass for one tick: an eighth of a count per tick² at full drive, with friction.
    pub fn advance(&mut self) {
        self.speed += i64::from(self.drive) / 1024 - self.speed / 64;
        self.position += self.speed;
        self.now_us = self.now_us.wrapping_add(1_000_000 / TICK_HZ);
    }
}

/// The world as the board's parts.
#[derive(Clone, Debug, Default)]
pub struct Shared(pub Rc<RefCell<World>>);

impl Encoder for Shared {
    type Error = ();
    fn count(&mut self) -> Result<i32, ()> {
        Ok((self.0.borrow().position / 256) as i32)
    }
}

impl Drive for Shared {
    type Error = ();
    fn enable(&mut self) -> Result<(), ()> {
        self.0.borrow_mut().enabled = true;
        Ok(())
    }
    fn apply(&mut self, command: i32) -> Result<Applied, ()> {
        let mut world = self.0.borrow_mut();
        world.asked = world.asked.max(command.unsigned_abs());
        let code = command.clamp(-i32::from(i16::MAX), i32::from(i16::MAX)) as i16;
        world.drive = if world.enabled { code } else { 0 };
        Ok(Applied { code: world.drive, limited: i32::from(code) != command })
    }
    fn off(&mut self) -> Result<(), ()> {
        let mut world = self.0.borrow_mut();
        (world.enabled, world.drive) = (false, 0);
        Ok(())
    }
}

impl Clock for Shared {
    fn now_us(&self) -> u32 {
        self.0.borrow().now_us
    }
}

impl Protection for Shared {
    fn tripped(&mut self) -> Option<Trip> {
        None
    }
    fn feed_watchdog(&mut self) {}
}

impl Retained for Shared {
    fn read(&self) -> [u32; RETAINED_WORDS] {
        self.0.borrow().retained
    }
    fn write(&mut self, words: [u32; RETAINED_WORDS]) {
        self.0.borrow_mut().retained = words;
    }
}

impl Wire for Shared {
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
