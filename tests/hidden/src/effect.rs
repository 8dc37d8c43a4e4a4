//! The names that can be hidden: the catalogue of the discovery specification, and what is outside it.

use crate::machine::stream;
use rand::{RngExt, seq::IndexedRandom};
use std::fmt;

/// The catalogue's names, exactly as in the table of effects (its `dahl, lugre` row is two names).
pub const CATALOGUE: [&str; 25] = [
    "constant_load",
    "asymmetric_viscous",
    "stribeck",
    "stiction",
    "dahl",
    "lugre",
    "quadratic_drag",
    "load_friction",
    "position_friction",
    "cogging",
    "gravity_load",
    "spring",
    "time_periodic",
    "backlash",
    "flexible_coupling",
    "dead_zone",
    "saturation",
    "pwm_dead_time",
    "delay",
    "electrical_lag",
    "encoder_eccentricity",
    "friction_drift",
    "gain_drift",
    "inertia_step",
    "end_stop",
];

/// So many names of [`CATALOGUE`] are drawn by seed, alone and in pairs. Later ones are asked for by name, so that each seed
/// keeps the effects that it had.
pub const DRAWN: usize = 24;

/// Effects that no catalogue entry describes: the right verdict is "unknown" or "partly explained".
pub const OUTSIDE: [&str; 4] = ["force_well", "torque_bursts", "velocity_ripple", "position_gain"];

/// Of these at most one can be in a plant: there is one second body, and one bristle.
const EXCLUSIVE: [[&str; 2]; 2] = [["backlash", "flexible_coupling"], ["dahl", "lugre"]];
/// First of the random streams from which effects are drawn.
const FIRST_STREAM: u64 = 256;

/// One, two or three effects of the catalogue that a plant can have together, by seed. Half of the draws have one, a
/// third have two. The draws of one seed are numbered by `index`.
pub fn drawn(seed: u64, index: u64) -> Vec<&'static str> {
    let mut rng = stream(seed, FIRST_STREAM + index);
    let count = match rng.random_range(0..6) {
        0..3 => 1,
        3..5 => 2,
        _ => 3,
    };
    let mut names: Vec<&'static str> = Vec::new();
    while names.len() < count {
        let Some(name) = CATALOGUE[..DRAWN].choose(&mut rng).copied() else { break };
        let excluded = EXCLUSIVE.iter().any(|two| two.contains(&name) && names.iter().any(|n| two.contains(n)));
        if !excluded && !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// What is hidden in the plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hidden {
    /// Nothing: the base model is the whole truth.
    None,
    /// One of [`CATALOGUE`].
    Catalogue(&'static str),
    /// One of [`OUTSIDE`].
    Outside(&'static str),
}

/// A name that is neither in [`CATALOGUE`] nor in [`OUTSIDE`] (nor `none`).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownEffect(pub String);

impl fmt::Display for UnknownEffect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no effect is called `{}`", self.0)
    }
}

impl std::error::Error for UnknownEffect {}

impl Hidden {
    /// The effect of that name; `none` is [`Hidden::None`].
    ///
    /// # Errors
    /// [`UnknownEffect`] with the name, when it is in neither list.
    pub fn named(name: &str) -> Result<Self, UnknownEffect> {
        let find = |list: &[&'static str]| list.iter().copied().find(|n| *n == name);
        if name == "none" {
            return Ok(Self::None);
        }
        find(&CATALOGUE)
            .map(Self::Catalogue)
            .or_else(|| find(&OUTSIDE).map(Self::Outside))
            .ok_or_else(|| UnknownEffect(name.to_owned()))
    }

    /// The effect's name, `none` for [`Hidden::None`].
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Catalogue(name) | Self::Outside(name) => name,
        }
    }

    /// The coordinate along which the effect lives, as the report should name it.
    pub fn coordinate(self) -> &'static str {
        match self.name() {
            "constant_load" => "direction",
            "asymmetric_viscous" | "stribeck" | "quadratic_drag" | "velocity_ripple" => "velocity",
            "stiction" => "rest",
            "dahl" | "lugre" | "backlash" => "distance since reversal",
            "flexible_coupling" => "frequency",
            "load_friction" | "dead_zone" | "saturation" => "drive level",
            "pwm_dead_time" => "drive level and velocity",
            "delay" | "electrical_lag" => "time since drive edge",
            "position_friction" => "position and direction",
            "cogging" | "gravity_load" | "spring" | "end_stop" | "force_well" | "encoder_eccentricity" => "position",
            "position_gain" => "position and drive level",
            "time_periodic" | "torque_bursts" | "friction_drift" | "gain_drift" | "inertia_step" => "session time",
            _ => "none",
        }
    }

    /// The effect's place in the two lists (catalogue first), used to give each its own random stream.
    pub(crate) fn index(self) -> u64 {
        CATALOGUE[..DRAWN]
            .iter()
            .chain(&OUTSIDE)
            .chain(&CATALOGUE[DRAWN..])
            .position(|n| *n == self.name())
            .map_or(0, |i| i as u64 + 1)
    }
}
