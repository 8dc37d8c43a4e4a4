//! The drive as the tick sees it.

/// The drive code of full supply voltage; codes run from `-FULL_SCALE` to `FULL_SCALE`.
///
/// Symmetric, so that `-code` is always a code: a relay of ±`FULL_SCALE` has no offset.
pub const FULL_SCALE: i16 = i16::MAX;

/// What a [`Drive`] did with a command.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Applied {
    /// The drive the motor gets, in drive codes (1/[`FULL_SCALE`] of the supply), after limit, dead time and
    /// quantisation. This is what is logged and what estimators are given, never the command.
    pub code: i16,
    /// The command was beyond the limit. A limit is not a fault; an experiment may still want to know.
    pub limited: bool,
}

/// A signed drive that saturates.
pub trait Drive {
    /// Why the drive could not be set.
    type Error;

    /// Lets commands through from the next [`Drive::apply`] on. A drive starts switched off.
    ///
    /// # Errors
    /// The power stage could not be set; it is then switched off as far as it can be.
    fn enable(&mut self) -> Result<(), Self::Error>;

    /// Applies a command in drive codes and says what the motor gets. Any command is valid: beyond the limit it
    /// saturates, and while the drive is off it comes to 0. Called once per tick: it must not block.
    ///
    /// # Errors
    /// The power stage could not be set; it is then switched off as far as it can be.
    fn apply(&mut self, command: i32) -> Result<Applied, Self::Error>;

    /// Holds both ends of the motor together until [`Drive::enable`] or [`Drive::off`], where the stage can: it brakes by its own
    /// current. Where it cannot, the same as [`Drive::off`].
    ///
    /// # Errors
    /// As of [`Drive::off`].
    fn brake(&mut self) -> Result<(), Self::Error> {
        self.off()
    }

    /// Switches the power stage off: the motor coasts until [`Drive::enable`].
    ///
    /// # Errors
    /// Some part could not be set; the others have been.
    fn off(&mut self) -> Result<(), Self::Error>;
}
