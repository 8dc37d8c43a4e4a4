//! What protects the machine besides the application: hardware trips, the watchdog, memory that outlives a reset.

/// A hardware protection that has switched the power stage off, or wants it off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trip {
    /// A protection of the power stage or of the controller (clock, supply). The number is the board's own.
    Break(i32),
    /// The board's own comparator found more current than this, mA.
    OverCurrent(u32),
    /// The emergency stop.
    EmergencyStop,
    /// The supply is missing or outside its range; its voltage in millivolts.
    Supply(i32),
}

/// Inputs and outputs that protect the machine. All are called from the tick: they must not block.
pub trait Protection {
    /// What is tripped now, if anything.
    fn tripped(&mut self) -> Option<Trip>;

    /// The motor's current now, mA, above 0 where a positive drive makes it; `None` where none is measured, or where what measures it
    /// contradicts itself. Called once per tick.
    fn current_ma(&mut self) -> Option<i32> {
        None
    }

    /// The settings limit the current to so many mA (0: no limit). What switches off by itself is set to its own level above it.
    fn limit_current(&mut self, _limit_ma: u32) {}

    /// The last reset came from the watchdog.
    fn watchdog_reset(&self) -> bool {
        false
    }

    /// Feeds the watchdog. Called only at the end of a tick that was completed in time. Where ticks stop, the
    /// watchdog resets the board, and a reset switches the power stage off.
    fn feed_watchdog(&mut self);
}

/// Words of [`Retained`].
pub const RETAINED_WORDS: usize = 8;

/// Memory that outlives a reset (but need not outlive the supply): RAM outside of what start-up code initialises.
/// What is read after power-on may be anything; the application checks it.
pub trait Retained {
    /// The words as last written.
    fn read(&self) -> [u32; RETAINED_WORDS];

    /// Writes all words. Called from the tick: must not block.
    fn write(&mut self, words: [u32; RETAINED_WORDS]);
}
