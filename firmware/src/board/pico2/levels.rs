//! The levels of the bridge's two inputs, as the PWM slice takes them.
//!
//! | IN1 | IN2 | DRV8871 | |
//! |---|---|---|---|
//! | 0 | 0 | all switches open | coasts; sleeps after 1 ms |
//! | 1 | 0 | OUT1 high, OUT2 low | positive |
//! | 0 | 1 | OUT1 low, OUT2 high | negative |
//! | 1 | 1 | both outputs low | brakes; the current decays slowly |
//!
//! A positive drive holds IN1 high and lowers IN2 for the duty; a negative one the other way round. So the motor is
//! driven or braked in each period, and its mean voltage is the duty whatever its current is. Between drive and coast
//! it would not be. No duty is both high, which brakes.

/// The compare word of the slice for a duty of `counts`, of `full`. Channel A (IN1) is in the lower half, B (IN2) in
/// the upper one. A channel is high for so many counts of a period's `full`; all of them is high without a pulse.
#[must_use]
pub fn compare(positive: bool, counts: u16, full: u16) -> u32 {
    let pulsed = full.saturating_sub(counts);
    let (in1, in2) = if positive { (full, pulsed) } else { (pulsed, full) };
    u32::from(in2) << 16 | u32::from(in1)
}

#[cfg(test)]
mod tests;
