//! Positions in radians, in which the laws of an angle are written.

use super::Recording;

/// The unit in which gravity and eccentricity are laws of the position.
const RADIANS: &str = "rad";

impl Recording {
    /// The position in rad, where its unit is another angle. Returns the unit that it had.
    pub fn in_radians(&mut self) -> Option<String> {
        let radians = self.radians_per_unit().filter(|_| self.units.x != RADIANS)?;
        self.x.iter_mut().for_each(|x| *x *= radians);
        self.encoder_step = self.encoder_step.map(|step| step * radians);
        self.counts_per_turn = None;
        Some(std::mem::replace(&mut self.units.x, RADIANS.to_owned()))
    }
}
