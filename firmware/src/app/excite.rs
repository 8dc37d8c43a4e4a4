//! Excitations of the experiments, in integers: they run on cores without an FPU.

use breakaway_core::excite::relay::{DualRelay, DualRelayState};
use breakaway_core::excite::waveform::Table;
use breakaway_core::link::{Mode, OpenLoop, Reference};

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
}

impl Excitation {
    pub(super) fn mode(&self) -> Mode {
        match self {
            Self::Relay { .. } => Mode::Relay,
            Self::Drive(_) => Mode::Drive,
        }
    }

    /// The drive it holds when nothing moves, drive codes, where there is one.
    pub(super) fn peak(&self) -> Option<i32> {
        match self {
            // Both relays come to the same sign when the error stays.
            Self::Relay { relay, .. } => Some(relay.h1().saturating_add(relay.h2())),
            Self::Drive(_) => None,
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
