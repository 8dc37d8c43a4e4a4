//! The reference of a run along set-points, in the tick.

use breakaway_core::control::{Cubic, Fast, Setpoint};
use breakaway_core::link::{Ending, Limit};

use super::set_points::SetPointOutlet;

/// A set-point in the tick's numbers: nothing is divided there.
#[derive(Clone, Copy, Debug)]
pub struct Knot<R> {
    /// Position from the start, position units, and velocity, position units per second.
    pub to: [R; 2],
    /// Ticks from the one before, ≥ 1.
    pub ticks: u32,
    /// 1/ticks.
    pub per_ticks: R,
    /// The same ticks, s.
    pub duration_s: R,
    /// 1/duration.
    pub per_s: R,
}

/// How set-points are followed.
#[derive(Clone, Copy, Debug)]
pub struct FollowRules {
    /// So many wait before it moves.
    pub ahead: u8,
    /// Ticks without any after which the run ends.
    pub hold_ticks: u32,
}

/// Where the reference is between two set-points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Follower<R> {
    /// The piece under way, and ticks since its start.
    piece: Option<(Cubic<R>, Knot<R>)>,
    k: u32,
    /// Position and velocity at the end of the last piece.
    from: [R; 2],
    /// Pieces follow each other.
    flowing: bool,
    /// Ticks since the last set-point came while it rests.
    held: u32,
    /// Set-points that waited in the tick before.
    waited: usize,
    /// The run is over.
    pub ending: Option<Ending>,
}

impl<R: Fast> Follower<R> {
    pub(super) fn new() -> Self {
        let from = [R::ZERO; 2];
        Self { piece: None, k: 0, from, flowing: false, held: 0, waited: 0, ending: None }
    }

    /// The reference of this tick; `None` after the end.
    // Its call is nothing beside it, and it stays out of the ticks of other references.
    #[inline(never)]
    pub(super) fn tick(&mut self, rules: FollowRules, points: &mut SetPointOutlet<'_, Knot<R>>) -> Option<Setpoint<R>> {
        if self.ending.is_some() {
            return None;
        }
        if let Some((cubic, knot)) = &self.piece {
            self.k += 1;
            if self.k < knot.ticks {
                // At most 2²⁴.
                return Some(cubic.at(R::from_i32(self.k as i32) * knot.per_ticks));
            }
            self.from = knot.to;
            self.piece = None;
        }
        // Read before the queue: what is complete has nothing added.
        let complete = points.is_complete();
        if (self.flowing || complete || points.waiting() >= usize::from(rules.ahead))
            && let Some(knot) = points.take()
        {
            let cubic = Cubic::new(self.from, knot.to, knot.duration_s, knot.per_s);
            (self.piece, self.k, self.flowing) = (Some((cubic, knot)), 0, true);
            return Some(cubic.at(R::ZERO));
        }
        if complete {
            self.ending = Some(Ending::TimeUp);
        } else {
            self.rest(rules, points);
        }
        Some(Setpoint { x: self.from[0], v: R::ZERO, a: R::ZERO })
    }

    /// There is no set-point: the reference stands still, and for how long is counted.
    #[cold]
    fn rest(&mut self, rules: FollowRules, points: &mut SetPointOutlet<'_, Knot<R>>) {
        if self.flowing {
            points.ran_dry();
            (self.flowing, self.held, self.waited) = (false, 0, 0);
        }
        self.from[1] = R::ZERO;
        let waiting = points.waiting();
        self.held = if waiting == self.waited { self.held.saturating_add(1) } else { 0 };
        self.waited = waiting;
        if self.held >= rules.hold_ticks {
            let value = i32::try_from(self.held).unwrap_or(i32::MAX);
            self.ending = Some(Ending::Limit { limit: Limit::SetPoints, value });
        }
    }
}
