//! Excitations of the experiments, in integers: they run on cores without an FPU.

use breakaway_core::excite::relay::{DualRelay, DualRelayState};
use breakaway_core::excite::waveform::Table;
use breakaway_core::link::{Mode, OpenLoop, Reference};

use super::guard::Guards;

/// What is applied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Excitation {
    /// Dual relay feedback around a reference.
    Relay {
        /// In drive codes and counts.
        relay: DualRelay<i32>,
        /// What the error is taken against.
        reference: Reference,
    },
    /// A drive that does not look at the position, but for a pull towards the start.
    Drive(OpenLoop),
    /// A constant drive, drive codes; against a stop, where the count is then said.
    Push {
        /// The drive.
        drive_code: i16,
        /// The count at the stop.
        stop_at: Option<i32>,
    },
}

impl Excitation {
    pub(super) fn mode(&self) -> Mode {
        match self {
            Self::Relay { .. } => Mode::Relay,
            Self::Drive(_) | Self::Push { .. } => Mode::Drive,
        }
    }

    /// The travel limits of it, counts: a push may leave them while they mean nothing, and may lead back between them.
    pub(super) fn travel(&self, guards: &Guards) -> (i32, i32) {
        match *self {
            Self::Push { stop_at: None, drive_code } if !guards.zero_needed && drive_code > 0 => {
                (i32::MIN, guards.travel_max)
            }
            Self::Push { stop_at: None, .. } if !guards.zero_needed => (guards.travel_min, i32::MAX),
            Self::Push { .. } => (i32::MIN, i32::MAX),
            _ => (guards.travel_min, guards.travel_max),
        }
    }

    /// What the count is at the stop that it runs against.
    pub(super) fn stop_at(&self) -> Option<i32> {
        match self {
            Self::Push { stop_at, .. } => *stop_at,
            _ => None,
        }
    }

    /// The drive it holds when nothing moves, drive codes, where there is one.
    pub(super) fn peak(&self) -> Option<i32> {
        match self {
            // Both relays come to the same sign when the error stays.
            Self::Relay { relay, .. } => Some(relay.h1().saturating_add(relay.h2())),
            Self::Drive(_) => None,
            Self::Push { drive_code, .. } => Some(i32::from(*drive_code).abs()),
        }
    }
}

/// An excitation under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Exciter {
    excitation: Excitation,
    relay: DualRelayState,
    phase: u32,
}

impl Exciter {
    pub(super) fn new(excitation: Excitation) -> Self {
        Self { excitation, relay: DualRelayState::new(), phase: 0 }
    }

    /// The drive at `distance` counts from the start, and the reference relative to it.
    #[inline]
    pub(super) fn tick(&mut self, distance: i32, table: &Table) -> (i32, i32) {
        match &self.excitation {
            Excitation::Push { drive_code, .. } => (i32::from(*drive_code), 0),
            Excitation::Relay { relay, reference } => {
                let target = match reference.amplitude_counts {
                    0 => 0,
                    amplitude => reference.shape.scaled(amplitude, self.phase, table),
                };
                self.phase = self.phase.wrapping_add(reference.phase_step);
                (relay.tick(&mut self.relay, target.saturating_sub(distance)), target)
            }
            Excitation::Drive(drive) => {
                let wave = drive.shape.scaled(i32::from(drive.amplitude_code), self.phase, table);
                let pull = (i64::from(drive.centring_q16) * i64::from(distance)) >> 16;
                self.phase = self.phase.wrapping_add(drive.phase_step);
                // The drive is cut later; here only the type must hold it.
                ((i64::from(wave) - pull).clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32, 0)
            }
        }
    }
}
