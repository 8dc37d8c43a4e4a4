//! Set-points from the link: checked here, handed to the tick.

use breakaway_core::control::CubicRange;
use breakaway_core::link::{
    Bounds, CommandError, Field, Following, Mode, Reply, Sample, SetPoint, SetPoints, Settings, Track, Trajectory,
};

use super::{App, Planner};
use crate::board::Wire;
use crate::storage::Store;

/// A run along set-points.
pub(super) struct Follow {
    /// Number of the next set-point.
    next: u32,
    /// Position and velocity of the one before, position units.
    last: [f32; 2],
    /// Where it started, counts; known with its first sample.
    start: Option<i32>,
    bounds: Bounds,
    complete: bool,
}

/// What the way between two set-points may be, position units and seconds.
struct Room {
    low: f32,
    high: f32,
    speed: f32,
    tick_s: f32,
}

impl Follow {
    /// The state at the start of a run, if it is one along set-points.
    pub(super) fn start(track: &Track) -> Option<Self> {
        matches!(track.trajectory, Trajectory::Follow { .. }).then(|| Self {
            next: 0,
            last: [0.0; 2],
            start: None,
            bounds: track.bounds,
            complete: false,
        })
    }

    /// Takes a sample, of any mode. Until a set-point is taken the reference is the start, and none is before it is known.
    pub(super) fn push(&mut self, sample: &Sample) {
        if self.start.is_none() && sample.mode == Mode::Track {
            self.start = Some(sample.reference);
        }
    }

    fn room(&self, start: i32, settings: &Settings, tick_hz: u32) -> Room {
        let step = settings.position_per_count;
        // Differences of counts need more than 32 bits; their products are good to 2⁻²³.
        let way = |to: i32| (i64::from(to) - i64::from(start)) as f32 * step;
        let bound = match self.bounds.travel_counts {
            0 => f32::INFINITY,
            counts => counts as f32 * step,
        };
        Room {
            low: way(settings.travel_min_counts).max(-bound),
            high: way(settings.travel_max_counts).min(bound),
            speed: settings.speed_max_counts_per_s as f32 * step,
            tick_s: 1.0 / tick_hz.max(1) as f32,
        }
    }
}

impl Room {
    /// Whether a set-point can be reached from the one before within travel and speed.
    fn check(&self, from: [f32; 2], point: &SetPoint) -> Result<(), CommandError> {
        let to = [point.position, point.velocity];
        let range = CubicRange::new(from, to, point.ticks as f32 * self.tick_s);
        // Comparisons that are false for what has overflowed.
        if !(range.low >= self.low && range.high <= self.high) {
            return Err(CommandError::Range(Field::SetPointPosition));
        }
        if range.speed <= self.speed { Ok(()) } else { Err(CommandError::Range(Field::SetPointVelocity)) }
    }
}

impl<P: Planner, W: Wire, S: Store> App<'_, '_, P, W, S> {
    /// Takes as many as there is room for, all of them or none.
    #[inline(never)]
    pub(super) fn set_points(&mut self, id: u16, sent: &SetPoints) -> Result<(), CommandError> {
        let follow = self.follow.as_mut().ok_or(CommandError::NotFollowing)?;
        let tick_hz = self.identity.tick_hz;
        let known = follow.next.checked_sub(sent.sequence).ok_or(CommandError::Range(Field::SetPointSequence))?;
        let new = sent.points.get(known as usize..).unwrap_or_default();
        if follow.complete && !new.is_empty() {
            return Err(CommandError::Range(Field::SetPointSequence));
        }
        let mut room = 0;
        if let Some(start) = follow.start {
            let taken = new.get(..self.channels.set_points.room().min(new.len())).unwrap_or_default();
            let limits = follow.room(start, &self.settings, tick_hz);
            let mut from = follow.last;
            for point in taken {
                limits.check(from, point)?;
                from = [point.position, point.velocity];
            }
            for point in taken {
                if let Some(knot) = self.planner.knot(point, tick_hz) {
                    self.channels.set_points.put(knot);
                }
            }
            follow.last = from;
            follow.next = follow.next.wrapping_add(taken.len() as u32);
            if sent.last && taken.len() == new.len() && known as usize <= sent.points.len() {
                follow.complete = true;
                self.channels.set_points.complete();
            }
            room = self.channels.set_points.room();
        }
        let following = Following { next: follow.next, room: room as u8, dry: self.channels.set_points.dry() };
        self.outbox.reply(id, Reply::Following(following));
        Ok(())
    }
}
