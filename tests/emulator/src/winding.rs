//! The motor's winding between bridge and axis: L·di/dt = u − R·i − Ke·ω, and the drive of the axis is R·i.
//!
//! The axis of the papers has its drive in V, with the back-EMF inside of c. With a winding c is c − Ke, and what drives is
//! R·i: in steady motion the same axis.

/// A winding.
#[derive(Clone, Copy, Debug)]
pub struct Winding {
    /// Resistance, Ω.
    pub resistance: f64,
    /// Inductance, H.
    pub inductance: f64,
    /// Back-EMF, V per position unit and second.
    pub back_emf: f64,
    /// The bridge's supply, V.
    pub supply: f64,
    /// Current, A.
    pub current: f64,
}

impl Winding {
    /// Goes on for so many seconds under a voltage, at a speed. `None`: all switches are open, and what flows goes back to the supply
    /// through the diodes until it is 0. The mean current.
    pub fn advance(&mut self, volts: Option<f64>, speed: f64, seconds: f64) -> f64 {
        let before = self.current;
        let open = volts.is_none();
        if seconds <= 0.0 || open && before == 0.0 {
            return before;
        }
        let volts = volts.unwrap_or_else(|| -self.supply * before.signum());
        let tau = self.inductance / self.resistance;
        let end = (volts - self.back_emf * speed) / self.resistance;
        let after = end + (before - end) * (-seconds / tau).exp();
        if open && after * before <= 0.0 {
            self.current = 0.0;
            return before / 2.0;
        }
        self.current = after;
        // The mean of an exponential.
        end + (before - after) * tau / seconds
    }
}
