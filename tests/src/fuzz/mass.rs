//! What the fuzzed application moves: a mass, in integers.

use breakaway_rig::Motion;

/// A mass on a drive: an eighth of a count per tick² at full drive, with friction.
#[derive(Debug, Default)]
pub struct Mass {
    /// Position, 1/256 count.
    position: i64,
    /// 1/256 count per tick.
    speed: i64,
}

impl Motion for Mass {
    fn counts(&self) -> i32 {
        (self.position / 256) as i32
    }
    fn advance(&mut self, code: i16) {
        self.speed += i64::from(code) / 1024 - self.speed / 64;
        self.position += self.speed;
    }
}
