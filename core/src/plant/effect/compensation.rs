//! What a controller does about an effect, as the effect's own file says it: a shape, with numbers in the law's units.
//! The compensator (`control`) prepares the shapes for its tick; it names no effect.

/// A shape of compensation. Forces and levels are in drive units; `x` is the position and `v` the velocity of the
/// reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Compensation<R> {
    /// A force to apply: `constant + stiffness·x`.
    Linear {
        /// Drive units.
        constant: R,
        /// Drive per position.
        stiffness: R,
    },
    /// A force to apply: `by_speed·|v| + by_square·v·|v|`.
    Drag {
        /// Drive per velocity.
        by_speed: R,
        /// Drive per velocity squared.
        by_square: R,
    },
    /// A force to apply: `first[0]·sin(n·x + first[1]) + second[0]·sin(2n·x + second[1])`.
    Ripple {
        /// n, rad per position.
        wave_number: R,
        /// Amplitude in drive units and phase in rad.
        first: [R; 2],
        /// The same of the second harmonic; amplitude 0 where there is none.
        second: [R; 2],
    },
    /// Added to the friction level: `rise·e^(−(|v|/speed)^exponent)`.
    Stribeck {
        /// At rest, drive units.
        rise: R,
        /// Above 0, velocity units.
        speed: R,
        /// Above 0.
        exponent: R,
    },
    /// Added to the friction level: `amplitude·sin(n·x + phase)`.
    LevelRipple {
        /// Drive units.
        amplitude: R,
        /// n, rad per position.
        wave_number: R,
        /// rad.
        phase: R,
    },
    /// Added to the friction level: `ratio·|u|`. At most one sum of ratios acts in a controller.
    LevelOfDrive {
        /// Friction per drive.
        ratio: R,
    },
    /// The inverse of a dead zone in the drive's path: `u + loss·sat(u/band)`.
    DeadZone {
        /// Drive units.
        loss: R,
        /// Above 0, drive units.
        band: R,
    },
    /// The inverse of a bridge's dead time in the drive's path: `u + loss·sat(i/edge)`, `i = u − back_emf·v`.
    DeadTime {
        /// Drive units.
        loss: R,
        /// Above 0, drive units.
        edge: R,
        /// Drive per velocity.
        back_emf: R,
    },
}
