//! Lines of set-points: `time_s,position[,velocity]`, or a position alone at a stated rate.

/// A line that is no set-point.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{name}, line {line}: {reason}")]
pub struct LineError {
    /// The file, or standard input.
    pub name: String,
    /// Line, counted from 1.
    pub line: u64,
    /// What is wrong, and what to do.
    pub reason: String,
}

/// A set-point as it was written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Line, counted from 1.
    pub line: u64,
    /// Time, s.
    pub t: f64,
    /// Position, position units.
    pub x: f64,
    /// Velocity, position units per second, where it is given.
    pub v: Option<f64>,
}

/// Reads set-points line by line.
#[derive(Clone, Debug)]
pub struct Lines {
    name: String,
    rate_hz: Option<f64>,
    line: u64,
    points: u64,
    last_t: f64,
}

impl Lines {
    /// A reader of what is called `name`. With `rate_hz` a line is a position alone, and time is counted.
    pub fn new(name: &str, rate_hz: Option<f64>) -> Self {
        Self { name: name.to_owned(), rate_hz, line: 0, points: 0, last_t: 0.0 }
    }

    /// Reads the next line; `None` for an empty one, a comment (`#`), and a header before the first set-point.
    ///
    /// # Errors
    /// [`LineError`]: a field that is no finite number, too many or too few fields, time that does not rise.
    pub fn next(&mut self, text: &str) -> Result<Option<Point>, LineError> {
        self.line += 1;
        let text = text.trim();
        if text.is_empty() || text.starts_with('#') {
            return Ok(None);
        }
        let fields: Vec<&str> = text.split(',').map(str::trim).collect();
        if self.points == 0 && fields.iter().all(|field| field.parse::<f64>().is_err()) {
            return Ok(None);
        }
        let mut numbers = [0.0; 3];
        for (field, number) in fields.iter().zip(&mut numbers) {
            *number = match field.parse::<f64>() {
                Ok(value) if value.is_finite() => value,
                _ => return Err(self.wrong(format!("`{field}` is not a finite number"))),
            };
        }
        let (t, x, v) = match (self.rate_hz, fields.len()) {
            (Some(rate), 1) => (self.points as f64 / rate, numbers[0], None),
            (Some(rate), 2) => (self.points as f64 / rate, numbers[0], Some(numbers[1])),
            (None, 2) => (numbers[0], numbers[1], None),
            (None, 3) => (numbers[0], numbers[1], Some(numbers[2])),
            (None, 1) => {
                return Err(
                    self.wrong("a position alone needs its rate: give --rate HZ, or write time,position".into())
                );
            }
            (Some(_), more) => {
                return Err(self.wrong(format!("{more} fields: with --rate a line is position or position,velocity")));
            }
            (None, more) => {
                return Err(self.wrong(format!("{more} fields: a line is time,position or time,position,velocity")));
            }
        };
        if self.points > 0 && t <= self.last_t {
            return Err(
                self.wrong(format!("the time {t} s is not after that of the set-point before, {} s", self.last_t))
            );
        }
        (self.points, self.last_t) = (self.points + 1, t);
        Ok(Some(Point { line: self.line, t, x, v }))
    }

    fn wrong(&self, reason: String) -> LineError {
        LineError { name: self.name.clone(), line: self.line, reason }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(rate: Option<f64>, text: &str) -> Result<Vec<Point>, String> {
        let mut lines = Lines::new("f.csv", rate);
        let points: Result<Vec<_>, _> = text.lines().map(|line| lines.next(line)).collect();
        Ok(points.map_err(|error| error.to_string())?.into_iter().flatten().collect())
    }

    #[test]
    fn times_positions_and_velocities() {
        let points = all(None, "# made by hand\ntime_s,position,velocity\n0, 0.5\n\n0.1,1e-1, -2\n").unwrap();
        let point = |line, t, x, v| Point { line, t, x, v };
        assert_eq!(points, [point(3, 0.0, 0.5, None), point(5, 0.1, 0.1, Some(-2.0))]);
        let points = all(Some(4.0), "x\n1\n2,0.5\n").unwrap();
        assert_eq!(points, [point(2, 0.0, 1.0, None), point(3, 0.25, 2.0, Some(0.5))]);
    }

    #[test]
    fn what_is_wrong_is_named_by_its_line() {
        for (rate, text, part) in [
            (None, "0,0\n0.1,NaN", "f.csv, line 2: `NaN` is not a finite number"),
            (None, "0,0\n0.1,inf", "line 2: `inf`"),
            (None, "0,0\n0.1,abc", "line 2: `abc`"),
            (None, "0,0\n0,1", "line 2: the time 0 s is not after that of the set-point before, 0 s"),
            (None, "1\n", "give --rate HZ"),
            (None, "0,1,2,3\n", "4 fields: a line is time,position or time,position,velocity"),
            (Some(10.0), "0,1,2\n", "3 fields: with --rate a line is position or position,velocity"),
            (None, "0,0\ntime,position\n", "line 2: `time`"),
        ] {
            let said = all(rate, text).unwrap_err();
            assert!(said.contains(part), "{text:?}: {said}");
        }
    }
}
