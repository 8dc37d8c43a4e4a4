//! What a parameter is: from its role follow its unit and what a program may do with it, whatever its symbol.

/// Role of a parameter in its law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Amplitude of a periodic force. Unit U.
    Amplitude,
    /// Amplitude of a periodic error of the position. Unit X.
    Eccentricity,
    /// Phase of the amplitude that stands at `of` among the effect's parameters. Unit rad.
    Phase {
        /// Index of the amplitude.
        of: usize,
    },
    /// Wave number along the position: radians per position. Unit 1/X.
    WaveNumber,
    /// Angular frequency in time. Unit rad/s.
    AngularFrequency,
    /// Natural angular frequency of a body on a spring. Unit rad/s.
    NaturalFrequency,
    /// A force or friction level that neither position nor speed scales. Unit U.
    Level,
    /// Drive at which the law changes its form. Unit U.
    Threshold,
    /// Force per deflection, of a spring or of bristles. Unit U/X.
    Stiffness,
    /// Force per velocity. Unit U·s/X.
    Damping,
    /// Back-EMF constant of the motor. Unit U·s/X.
    BackEmf,
    /// Damping of a body on a spring over its critical damping. Unit 1.
    DampingRatio,
    /// Velocity at which the law changes its form. Unit X/s.
    Speed,
    /// Exponent. Unit 1.
    Exponent,
    /// Share of another quantity of the model (drive, friction, inertia). Unit 1.
    Ratio,
    /// Share of the inertia b that moves as a second body. Unit 1.
    InertiaShare,
    /// Closing speed left after an impact, as a share. Unit 1.
    Restitution,
    /// Relative change per second. Unit 1/s.
    Rate,
    /// Time by which the drive is late. Unit s.
    Delay,
    /// Time constant of an exponential. Unit s.
    TimeConstant,
    /// Instant on the clock of the session. Unit s.
    Instant,
    /// Width of the gap in which a second body is free. Unit X.
    Gap,
    /// Place on the scale of the position; it moves with the encoder's zero. Unit X.
    Position,
    /// A coefficient that no other role names, with its unit.
    Coefficient(&'static str),
}

impl Role {
    /// Unit of a parameter in that role, with `U` for the drive's and `X` for the position's.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Amplitude | Self::Level | Self::Threshold => "U",
            Self::Eccentricity | Self::Gap | Self::Position => "X",
            Self::Phase { .. } => "rad",
            Self::WaveNumber => "1/X",
            Self::AngularFrequency | Self::NaturalFrequency => "rad/s",
            Self::Stiffness => "U/X",
            Self::Damping | Self::BackEmf => "U·s/X",
            Self::Speed => "X/s",
            Self::DampingRatio | Self::Exponent | Self::Ratio | Self::InertiaShare | Self::Restitution => "1",
            Self::Rate => "1/s",
            Self::Delay | Self::TimeConstant | Self::Instant => "s",
            Self::Coefficient(unit) => unit,
        }
    }

    /// Its name, as JSON has it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Amplitude => "amplitude",
            Self::Eccentricity => "eccentricity",
            Self::Phase { .. } => "phase",
            Self::WaveNumber => "wave_number",
            Self::AngularFrequency => "angular_frequency",
            Self::NaturalFrequency => "natural_frequency",
            Self::Level => "level",
            Self::Threshold => "threshold",
            Self::Stiffness => "stiffness",
            Self::Damping => "damping",
            Self::BackEmf => "back_emf",
            Self::DampingRatio => "damping_ratio",
            Self::Speed => "speed",
            Self::Exponent => "exponent",
            Self::Ratio => "ratio",
            Self::InertiaShare => "inertia_share",
            Self::Restitution => "restitution",
            Self::Rate => "rate",
            Self::Delay => "delay",
            Self::TimeConstant => "time_constant",
            Self::Instant => "instant",
            Self::Gap => "gap",
            Self::Position => "position",
            Self::Coefficient(_) => "coefficient",
        }
    }
}
