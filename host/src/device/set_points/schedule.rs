//! From set-points in seconds to those of the board, in ticks from one to the next.

use breakaway_core::link::SetPoint;

use super::{LineError, Point};

/// Most ticks between two set-points (docs/link.md).
const MOST_TICKS: f64 = 16_777_216.0;

/// Makes the board's set-points. The first line is where the axis stands: positions and times count from it.
///
/// A velocity that is not given is the slope from the set-point before to the one after. So such a set-point waits for the
/// next line. The last one comes to rest.
#[derive(Clone, Debug)]
pub struct Schedule {
    name: String,
    tick_hz: f64,
    origin: Option<Point>,
    /// The set-point before the one that waits, and its tick.
    before: Option<(Point, u64)>,
    waiting: Option<Point>,
}

impl Schedule {
    /// Set-points of what is called `name`, for a board of `tick_hz` ticks per second.
    pub fn new(name: &str, tick_hz: f64) -> Self {
        Self { name: name.to_owned(), tick_hz, origin: None, before: None, waiting: None }
    }

    /// Takes a line; the set-point before it, with its line, which now has a velocity.
    ///
    /// # Errors
    /// [`LineError`]: closer to the one before than a tick, or farther than the board counts.
    pub fn push(&mut self, point: Point) -> Result<Option<(u64, SetPoint)>, LineError> {
        let Some(origin) = self.origin else {
            (self.origin, self.before) = (Some(point), Some((point, 0)));
            return Ok(None);
        };
        let point = Point { x: point.x - origin.x, t: point.t - origin.t, ..point };
        if self.before.is_some_and(|(before, _)| before.line == origin.line) {
            self.before = Some((Point { x: 0.0, t: 0.0, ..origin }, 0));
        }
        let made = self.make(Some(point))?;
        self.waiting = Some(point);
        Ok(made)
    }

    /// The set-point that waits for the next line, at rest: none comes, or none comes in time.
    ///
    /// # Errors
    /// As [`Schedule::push`].
    pub fn flush(&mut self) -> Result<Option<(u64, SetPoint)>, LineError> {
        self.make(None)
    }

    /// Time between the set-point that waits and the one before, s; `None` if none waits.
    pub fn interval_s(&self) -> Option<f64> {
        let (before, _) = self.before?;
        self.waiting.map(|waiting| waiting.t - before.t)
    }

    fn make(&mut self, after: Option<Point>) -> Result<Option<(u64, SetPoint)>, LineError> {
        let (Some(point), Some((before, tick))) = (self.waiting.take(), self.before) else { return Ok(None) };
        let slope = |to: Point| (to.x - before.x) / (to.t - before.t);
        let v = point.v.or_else(|| after.map(slope)).unwrap_or(0.0);
        // Counted from the first one, so that rounding does not add up.
        let at = (point.t * self.tick_hz).round();
        let ticks = at - tick as f64;
        if !(1.0..=MOST_TICKS).contains(&ticks) {
            let reason = format!(
                "it is {} s after the set-point before; the board's ticks are {} s, and it counts to 2²⁴ of them",
                point.t - before.t,
                1.0 / self.tick_hz
            );
            return Err(LineError { name: self.name.clone(), line: point.line, reason });
        }
        self.before = Some((point, at as u64));
        let set_point = SetPoint { ticks: ticks as u32, position: point.x as f32, velocity: v as f32 };
        Ok(Some((point.line, set_point)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(line: u64, t: f64, x: f64, v: Option<f64>) -> Point {
        Point { line, t, x, v }
    }

    /// Counted from the first line, with the slope between the neighbours, at rest at the end.
    #[test]
    fn lines_become_set_points() {
        let mut schedule = Schedule::new("f.csv", 1000.0);
        let made: Vec<_> = [(10.0, 3.0, None), (10.1, 3.5, None), (10.3, 5.0, None), (10.4, 5.0, Some(-1.0))]
            .into_iter()
            .enumerate()
            .filter_map(|(k, (t, x, v))| schedule.push(point(k as u64 + 1, t, x, v)).unwrap())
            .collect();
        let set = |ticks, position, velocity| SetPoint { ticks, position, velocity };
        // (5 − 3)/0.3 and (5 − 3.5)/0.3, to the rounding of 10.3 − 10.
        let near = |a: f32, b: f32| (a - b).abs() < 1e-5;
        assert!(made[0].0 == 2 && made[0].1.ticks == 100 && near(made[0].1.velocity, 2.0 / 0.3), "{made:?}");
        assert!(made[1].0 == 3 && made[1].1.ticks == 200 && near(made[1].1.velocity, 5.0), "{made:?}");
        assert_eq!(schedule.flush().unwrap(), Some((4, set(100, 2.0, -1.0))));
        assert_eq!(schedule.flush().unwrap(), None);
        let last = point(5, 10.5, 5.0, None);
        assert_eq!(schedule.push(last).unwrap(), None);
        assert_eq!(schedule.flush().unwrap(), Some((5, set(100, 2.0, 0.0))));
    }

    /// A third of a tick is rounded, and does not add up: after 3000 set-points of 1/3 ms at a tick of 0.1 ms it is 10 000 ticks.
    #[test]
    fn rounding_does_not_add_up() {
        let mut schedule = Schedule::new("f.csv", 10_000.0);
        let mut ticks = 0;
        for k in 0..=3000 {
            let made = schedule.push(point(k + 1, k as f64 / 3000.0, 0.0, None)).unwrap();
            ticks += made.map_or(0, |(_, point)| point.ticks);
        }
        ticks += schedule.flush().unwrap().unwrap().1.ticks;
        assert_eq!(ticks, 10_000);
    }

    #[test]
    fn set_points_closer_than_a_tick_are_refused() {
        let mut schedule = Schedule::new("f.csv", 1000.0);
        schedule.push(point(1, 0.0, 0.0, None)).unwrap();
        schedule.push(point(2, 0.0003, 1.0, None)).unwrap();
        let said = schedule.flush().unwrap_err().to_string();
        assert!(said.starts_with("f.csv, line 2: it is 0.0003 s after"), "{said}");
    }
}
