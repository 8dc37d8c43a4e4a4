//! What protects the machine besides the application: hardware trips, the watchdog, memory that outlives a reset.

/// A hardware protection that has switched the power stage off, or wants it off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trip {
    /// A protection of the power stage or of the controller (overcurrent comparator, clock, supply). The number is the board's own.
    Break(i32),
    /// The emergency stop.
    EmergencyStop,
    /// The supply is missing or outside its range; its voltage in millivolts.
    Supply(i32),
}

/// Inputs and outputs that protect the machine. All are called from the tick: they must not block.
pub trait Protection {
    /// What is tripped now, if anything.
    fn tripped(&mut self) -> Option<Trip>;

    /// The motor's current in mA, where it is measured; looked at only if the settings limit it.
    fn current_ma(&mut self) -> Option<u32> {
        None
    }

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
