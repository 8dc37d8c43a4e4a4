//! The Lomb–Scargle periodogram of the windows' residual, with a phase for each recording. A window counts by how much of
//! a ripple it passes.

use rayon::prelude::*;
use wide::f32x4;

use super::attenuation::{attenuation, audible};

/// Position or time of a window, its rate, and its residual.
pub(super) struct Point {
    pub group: usize,
    pub at: f64,
    pub rate: f64,
    pub residual: f64,
    pub weight: f64,
    pub h_s: f64,
}

/// Lines at one distance from each other.
#[derive(Clone, Copy)]
pub(super) struct Lines {
    /// Wave number or angular frequency of the first, > 0 or 0.
    pub first: f64,
    pub spacing: f64,
    pub count: usize,
}

impl Lines {
    /// The line at an index.
    pub(super) fn at(&self, index: usize) -> f64 {
        self.first + index as f64 * self.spacing
    }
}

/// Turn of a ripple between two samples above which it is not seen, rad.
pub(super) const FASTEST_TURN: f64 = 1.5;
/// Lines whose waves are turned on in one go, and lines for which a window passes one share of a ripple.
const CHUNK: usize = 256;
const ONE_SHARE: usize = 4;
/// Entries of the attenuation's table, and the turn at its end, rad. Beyond it a window passes less than 1 % of a ripple.
const TABLE: usize = 4096;
const TABLE_TURN: f64 = 12.0;
/// Sums that run side by side, because a processor adds them at once.
const LANES: usize = 4;

/// Sum of squares that a sine and a cosine explain at every line. The waves are turned on from line to line, which saves
/// their sines. Single precision tells which lines are the strongest; [`Near`] gives their places.
pub(super) fn spectrum(points: &[Point], lines: Lines, half_width_s: f64) -> Vec<f64> {
    let table: Vec<f32> = (0..=TABLE).map(|i| attenuation(TABLE_TURN * i as f64 / TABLE as f64) as f32).collect();
    let count = points.iter().map(|p| p.group).max().map_or(0, |group| group + 1);
    let groups: Vec<Group> = (0..count).map(|group| Group::of(points, group, half_width_s)).collect();
    let chunks: Vec<usize> = (0..lines.count).step_by(CHUNK).collect();
    let power = chunks.into_par_iter().flat_map_iter(|from| {
        let own = Lines { first: lines.at(from), count: CHUNK.min(lines.count - from), ..lines };
        let mut powers = vec![0.0; own.count];
        for group in &groups {
            group.explain(own, &table, &mut powers);
        }
        powers
    });
    power.collect()
}

/// The points of one recording. Those that show the highest lines come first, so that a line looks at those before one.
/// Points without weight fill the last lanes.
struct Group {
    /// The highest line that a point shows.
    highest: Vec<f64>,
    at: Vec<f64>,
    /// Turn from the middle of a window to its edge at a wave number of 1, rad.
    turn: Vec<f64>,
    residual: Vec<f32>,
    weight: Vec<f32>,
}

impl Group {
    fn of(points: &[Point], group: usize, half_width_s: f64) -> Self {
        let highest = |p: &Point| {
            (TABLE_TURN / (p.rate * half_width_s).abs().max(f64::MIN_POSITIVE))
                .min(FASTEST_TURN / (p.rate * p.h_s).abs().max(f64::MIN_POSITIVE))
        };
        let mut own: Vec<(f64, &Point)> = points.iter().filter(|p| p.group == group).map(|p| (highest(p), p)).collect();
        own.sort_by(|a, b| b.0.total_cmp(&a.0));
        let padded = own.len().next_multiple_of(LANES);
        let of = |f: &dyn Fn(&Point) -> f64| -> Vec<f64> {
            own.iter().map(|(_, p)| f(p)).chain(std::iter::repeat(0.0)).take(padded).collect()
        };
        let single = |f: &dyn Fn(&Point) -> f64| of(f).into_iter().map(|value| value as f32).collect();
        Self {
            highest: own.iter().map(|(highest, _)| *highest).collect(),
            at: of(&|p| p.at),
            turn: of(&|p| (p.rate * half_width_s).abs()),
            residual: single(&|p| p.residual),
            weight: single(&|p| p.weight),
        }
    }

    /// Adds what the group explains at every line.
    fn explain(&self, lines: Lines, table: &[f32], powers: &mut [f64]) {
        let showing = |line: f64| self.highest.partition_point(|highest| *highest > line);
        let most = showing(lines.first).next_multiple_of(LANES);
        let wave = |k: f64| -> (Vec<f32>, Vec<f32>) {
            let each = self.at[..most].iter().map(|at| (k * at).sin_cos());
            each.map(|(sin, cos)| (sin as f32, cos as f32)).unzip()
        };
        let ((mut sin, mut cos), (turn_sin, turn_cos)) = (wave(lines.first), wave(lines.spacing));
        let mut left = vec![0.0_f32; most];
        for (i, power) in powers.iter_mut().enumerate() {
            if i.is_multiple_of(ONE_SHARE) {
                let middle = lines.at(i) + 0.5 * (ONE_SHARE - 1) as f64 * lines.spacing;
                let entries = middle * (TABLE as f64 / TABLE_TURN);
                for ((left, turn), weight) in left.iter_mut().zip(&self.turn).zip(&self.weight) {
                    *left = weight * table[((entries * turn) as u32 as usize).min(TABLE)];
                }
            }
            let n = showing(lines.at(i)).next_multiple_of(LANES);
            let turned = [&mut sin[..n], &mut cos[..n]];
            let sums = sums_and_turn(turned, [&turn_sin[..n], &turn_cos[..n]], &left[..n], &self.residual[..n]);
            *power += explained_by(&sums);
        }
    }
}

/// Sums of the products of the waves with the residual and with each other; the waves are then turned on by one line.
fn sums_and_turn(
    [sin, cos]: [&mut [f32]; 2],
    [turn_sin, turn_cos]: [&[f32]; 2],
    left: &[f32],
    residual: &[f32],
) -> [f64; 5] {
    let mut sums = [f32x4::ZERO; 5];
    let waves = sin.as_chunks_mut::<LANES>().0.iter_mut().zip(cos.as_chunks_mut::<LANES>().0);
    let turns = turn_sin.as_chunks::<LANES>().0.iter().zip(turn_cos.as_chunks::<LANES>().0);
    let points = left.as_chunks::<LANES>().0.iter().zip(residual.as_chunks::<LANES>().0);
    for (((sin, cos), (turn_sin, turn_cos)), (left, residual)) in waves.zip(turns).zip(points) {
        // Each is written out. The compiler may leave `map` of an array as a call.
        let (sine, cosine) = (f32x4::new(*sin), f32x4::new(*cos));
        let (turn_sin, turn_cos) = (f32x4::new(*turn_sin), f32x4::new(*turn_cos));
        let (left, residual) = (f32x4::new(*left), f32x4::new(*residual));
        let (s, c) = (left * sine, left * cosine);
        sums[0] += s * residual;
        sums[1] += c * residual;
        sums[2] += s * s;
        sums[3] += c * c;
        sums[4] += s * c;
        *sin = (sine * turn_cos + cosine * turn_sin).to_array();
        *cos = (cosine * turn_cos - sine * turn_sin).to_array();
    }
    sums.map(|lanes| lanes.to_array().into_iter().map(f64::from).sum())
}

/// Sum of squares that a sine and a cosine explain; 0 where the windows do not tell them apart.
fn explained_by([s, c, ss, cc, sc]: &[f64; 5]) -> f64 {
    let determinant = ss * cc - sc * sc;
    if determinant > 1e-3 * (ss + cc).powi(2) && ss + cc > 4.0 {
        (s * s * cc - 2.0 * s * c * sc + c * c * ss) / determinant
    } else {
        0.0
    }
}

/// What every window passes of the lines near one.
pub(super) struct Near<'a> {
    points: &'a [Point],
    left: Vec<f64>,
    groups: usize,
}

impl<'a> Near<'a> {
    /// The lines near `k`.
    pub(super) fn new(points: &'a [Point], k: f64, half_width_s: f64) -> Self {
        let left = |p: &Point| p.weight * attenuation(k * p.rate * half_width_s) * audible(k * p.rate * p.h_s);
        let groups = points.iter().map(|p| p.group).max().map_or(0, |group| group + 1);
        Self { points, left: points.iter().map(left).collect(), groups }
    }

    /// Sum of squares that sine and cosine of wave number `k` explain.
    pub(super) fn explained(&self, k: f64) -> f64 {
        let mut sums = vec![[0.0; 5]; self.groups];
        for (p, left) in self.points.iter().zip(&self.left) {
            let (sin, cos) = (k * p.at).sin_cos();
            let (s, c, sum) = (left * sin, left * cos, &mut sums[p.group]);
            let own = [s * p.residual, c * p.residual, s * s, c * c, s * c];
            sum.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        }
        sums.iter().map(explained_by).sum()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// Two recordings of 300 windows over 40 rad at up to 2 rad/s. They have a ripple of 3.3 waves in a radian with a phase
    /// each.
    fn points() -> Vec<Point> {
        let point = |i: usize| {
            let (group, k) = (i % 2, (i / 2) as f64);
            let at = 40.0 * (k * 0.61803).fract();
            let residual = (3.3 * at + group as f64).sin() + 0.1 * (k * 0.37).sin();
            Point { group, at, rate: 2.0 * (k * 0.41421).fract(), residual, weight: 1.0, h_s: 1e-3 }
        };
        (0..600).map(point).collect()
    }

    /// The turned waves in single precision give the power of sines in double precision, to a thousandth of the
    /// strongest line. The attenuation is that of a line within two, which makes most of it.
    #[test]
    fn turned_waves_give_the_power_of_sines() {
        let (points, half_width_s) = (points(), 0.05);
        let lines = Lines { first: 0.5, spacing: TAU / 40.0 / 4.0, count: 700 };
        let power = spectrum(&points, lines, half_width_s);
        let exact: Vec<f64> =
            (0..lines.count).map(|i| Near::new(&points, lines.at(i), half_width_s).explained(lines.at(i))).collect();
        let most = exact.iter().copied().fold(0.0, f64::max);
        let worst = power.iter().zip(&exact).map(|(a, b)| (a - b).abs() / most).fold(0.0, f64::max);
        assert!(worst < 1e-3, "{worst}");
        let strongest = (0..lines.count).max_by(|a, b| power[*a].total_cmp(&power[*b])).unwrap();
        assert!((lines.at(strongest) - 3.3).abs() < lines.spacing, "{}", lines.at(strongest));
    }
}
