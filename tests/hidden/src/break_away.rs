//! The break-away force, found before the experiments, which are sized from it.

use crate::law::ForceLaw;
use std::f64::consts::{PI, TAU};

/// What a slow ramp of the drive in both directions finds, over one turn.
#[derive(Clone, Copy, Debug)]
pub struct BreakAway {
    /// Largest drive needed anywhere in either direction.
    pub largest: f64,
    /// Half the distance between the two directions' thresholds, the largest over the turn.
    pub half: f64,
    /// Middle between the two thresholds, mean over the turn.
    pub offset: f64,
}

impl BreakAway {
    /// Static search on the true plant at session time 0.
    pub fn find(law: &ForceLaw, limit: f64) -> Self {
        const PLACES: usize = 48;
        let mut found = Self { largest: 0.0, half: 0.0, offset: 0.0 };
        for i in 0..PLACES {
            let x = -PI + TAU * i as f64 / PLACES as f64;
            let up = threshold(law, x, limit, 1.0);
            let down = threshold(law, x, limit, -1.0);
            found.largest = found.largest.max(up).max(-down);
            found.half = found.half.max(0.5 * (up - down));
            found.offset += 0.5 * (up + down) / PLACES as f64;
        }
        found
    }
}

/// Drive at which the body at rest just moves in the given direction.
fn threshold(law: &ForceLaw, x: f64, limit: f64, side: f64) -> f64 {
    let moves = |u: f64| {
        let delivered = law.shape(u, 0.0);
        let force = law.drive_force(delivered, x, 0.0) + law.extra_force(x, 0.0, 0.0);
        side * force > law.rest_level(x, 0.0, delivered)
    };
    let (mut below, mut above) = (-side * limit, side * limit);
    for _ in 0..30 {
        let middle = 0.5 * (below + above);
        if moves(middle) {
            above = middle;
        } else {
            below = middle;
        }
    }
    above
}
