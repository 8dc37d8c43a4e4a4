use super::*;
use core::cell::Cell as Counter;

const PLAIN: SineModel = SineModel { offset: false, drift: false, third: false, fifth: false };

/// Times of `n` samples in −1..1.
fn times(n: u32) -> impl Iterator<Item = f64> + Clone {
    (0..n).map(move |k| (2.0 * f64::from(k) + 1.0) / f64::from(n) - 1.0)
}

/// Every segment has a phase of its own. A sine becomes a cosine in the middle. Two or four segments explain all of
/// it, one explains half (the mean of the two has half the power). Three, the middle one with the jump in it, explain
/// 1 − 1/3·1/2. To the leakage of 20 cycles.
#[test]
fn each_segment_has_its_own_phase() {
    let omega = 20.0 * PI;
    let samples = times(2400).map(|tau| (tau, if tau < 0.0 { libm::sin(omega * tau) } else { libm::cos(omega * tau) }));
    let power: f64 = samples.clone().map(|(_, y)| y * y).sum();
    let share = |segments| explain::<2>(&samples, PLAIN, omega, 0.1, segments)[0] / power;
    for (segments, explained) in [(1.0, 0.5), (2.0, 1.0), (3.0, 1.0 - 1.0 / 6.0), (4.0, 1.0)] {
        assert!((share(segments) - explained).abs() < 1e-3, "{segments}: {}", share(segments));
    }
}

/// The frequencies of one pass: `omega + k·step`, each as if it were alone. To the rounding of the rotations.
#[test]
fn a_pass_is_of_frequencies_a_step_apart() {
    let samples = times(600).map(|tau| (tau, libm::sin(63.0 * tau + 0.3)));
    let together = explain::<2>(&samples, PLAIN, 60.0, 0.9, 2.0);
    for (k, explained) in (0..8).zip(together) {
        let alone = explain::<2>(&samples, PLAIN, 60.0 + 0.9 * f64::from(k), 0.0, 2.0)[0];
        assert!((explained - alone).abs() < 1e-11 * alone, "{k}: {explained} {alone}");
    }
}

/// Samples that count how often they are passed over.
#[derive(Debug)]
struct Counted<'a, I> {
    samples: I,
    passes: &'a Counter<u32>,
}

impl<I: Clone> Clone for Counted<'_, I> {
    fn clone(&self) -> Self {
        self.passes.set(self.passes.get() + 1);
        Self { samples: self.samples.clone(), passes: self.passes }
    }
}

impl<I: Iterator> Iterator for Counted<'_, I> {
    type Item = I::Item;
    fn next(&mut self) -> Option<I::Item> {
        self.samples.next()
    }
}

/// The best frequency within a cell, and the passes it took.
fn searched(cycles: f64, low: f64, high: f64) -> (Cell, u32) {
    let omega = PI * cycles;
    let passes = Counter::new(0);
    let samples = times(libm::ceil(6.3 * cycles) as u32).map(|tau| (tau, libm::sin(omega * tau + 0.7)));
    let cell = search::<2>(&Counted { samples, passes: &passes }, PLAIN, low * omega, high * omega).unwrap();
    (cell, passes.get())
}

/// The work of the search: 8 frequencies in a pass, on a grid of 1/(4T) with T of at most 16 cycles at first. With 6
/// points a cycle from half to twice the frequency that is 96 cells, 13 passes. Then T is 8 times as long, within two
/// cells either way: 32 cells, 5 passes, and fewer where the segments are rounded up.
#[test]
fn the_work_grows_by_five_passes_for_eight_times_the_cycles() {
    // The longer ones take many minutes in Miri.
    let rows = if cfg!(miri) { 2 } else { 5 };
    let all = [(2.0, 2), (15.9, 13), (127.0, 13 + 5), (1023.0, 13 + 5 + 5), (8191.0, 13 + 5 + 5 + 5)];
    for (cycles, passes) in all.into_iter().take(rows) {
        let (cell, counted) = searched(cycles, 0.5, 2.0);
        assert_eq!(counted, passes, "{cycles} cycles");
        let omega = PI * cycles;
        assert!(cell.low < omega && omega < cell.high, "{cycles}: {cell:?}");
        // A step of at most 1/(4T) hertz, T = 2, and the truth nearest to the best of the three.
        assert!(cell.high - cell.low <= 0.5 * PI * 1.000_001, "{cell:?}");
        assert!((omega - cell.best).abs() <= 0.125 * PI * 1.1, "{cycles}: {cell:?} {omega}");
    }
}

/// The cell never reaches out of what was asked for.
#[test]
fn the_cell_stays_in_the_range() {
    for (low, high) in [(0.995, 1.4), (0.7, 1.005)] {
        let (cell, _) = searched(40.0, low, high);
        let omega = PI * 40.0;
        assert!(low * omega <= cell.low && cell.high <= high * omega, "{cell:?}");
    }
}
