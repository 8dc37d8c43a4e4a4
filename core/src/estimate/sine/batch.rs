//! Fits of a whole record, at a known or at a free frequency, on any increasing clock.

use super::columns::SineModel;
use super::grid;
use super::normal::Normal;
use super::refine::{Border, Point, Resolution, refine};
use super::result::{Scales, SineFit};
use super::{MIN_CYCLES_FIXED, MIN_CYCLES_FREE, SineError};
use core::f64::consts::{PI, TAU};

/// Where [`fit_free`] looks for the frequency; rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrequencySearch {
    low: f64,
    high: f64,
    estimate: f64,
}

impl FrequencySearch {
    /// From half to twice an estimate (the memo's bracket).
    pub fn around(estimate_rad_s: f64) -> Self {
        Self { low: 0.5 * estimate_rad_s, high: 2.0 * estimate_rad_s, estimate: estimate_rad_s }
    }
    /// Between two frequencies, 0 < low < high. What lies beyond Nyquist is left out.
    pub fn between(low_rad_s: f64, high_rad_s: f64) -> Self {
        Self { low: low_rad_s, high: high_rad_s, estimate: low_rad_s }
    }
}

/// The samples (t, y) of an evenly sampled record whose first sample is at `start_s`.
pub fn even(y: &[f64], start_s: f64, sample_period_s: f64) -> impl Iterator<Item = (f64, f64)> + Clone {
    y.iter().enumerate().map(move |(i, y)| (start_s + i as f64 * sample_period_s, *y))
}

/// Linear fit at a known frequency (memo section 2.1): `samples` are (time in s, value), time strictly increasing.
///
/// # Errors
/// [`SineError`] refuses too few samples or cycles, values that are not finite, and a clock that does not increase. It
/// also refuses a frequency outside (0, Nyquist), a constant signal, and columns that the sampling instants do not
/// separate.
pub fn fit_fixed<I>(samples: I, omega_rad_s: f64, model: SineModel) -> Result<SineFit, SineError>
where
    I: Iterator<Item = (f64, f64)> + Clone,
{
    match model.columns() {
        2 => fixed::<2, I>(samples, omega_rad_s, model),
        3 => fixed::<3, I>(samples, omega_rad_s, model),
        4 => fixed::<4, I>(samples, omega_rad_s, model),
        5 => fixed::<5, I>(samples, omega_rad_s, model),
        6 => fixed::<6, I>(samples, omega_rad_s, model),
        7 => fixed::<7, I>(samples, omega_rad_s, model),
        _ => fixed::<8, I>(samples, omega_rad_s, model),
    }
}

/// Fit with free frequency (memo section 2.2, corrected): grid, then Gauss-Newton to the precision of f64. `samples`
/// are (time in s, value), time strictly increasing. On a desktop it takes about 8 µs per sample for
/// [`FrequencySearch::around`]. For long evenly sampled records run [`StreamingSine`](super::StreamingSine) first (5
/// ns per sample) and search a few standard errors around its result.
///
/// # Errors
/// As [`fit_fixed`], and: an empty search range, a best frequency on the range's edge.
pub fn fit_free<I>(samples: I, search: FrequencySearch, model: SineModel) -> Result<SineFit, SineError>
where
    I: Iterator<Item = (f64, f64)> + Clone,
{
    match model.columns() {
        2 => free::<2, I>(samples, search, model),
        3 => free::<3, I>(samples, search, model),
        4 => free::<4, I>(samples, search, model),
        5 => free::<5, I>(samples, search, model),
        6 => free::<6, I>(samples, search, model),
        7 => free::<7, I>(samples, search, model),
        _ => free::<8, I>(samples, search, model),
    }
}

/// The record's extent, found in a first pass, and the map to dimensionless time and signal in −1..1.
#[derive(Clone, Copy, Debug)]
struct Extent {
    samples: usize,
    centre_s: f64,
    half_s: f64,
    middle: f64,
    half_range: f64,
}

impl Extent {
    fn of(samples: impl Iterator<Item = (f64, f64)>, needed: usize) -> Result<Self, SineError> {
        let mut count = 0;
        let (mut first, mut last) = (0.0, 0.0);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (t, y) in samples {
            if !(t.is_finite() && y.is_finite()) {
                return Err(SineError::NotFinite);
            }
            if count == 0 {
                first = t;
            } else if t <= last {
                return Err(SineError::TimeOrder { sample: count });
            }
            last = t;
            low = low.min(y);
            high = high.max(y);
            count += 1;
        }
        if count < needed {
            return Err(SineError::TooFewSamples { samples: count, needed });
        }
        let extent = Self {
            samples: count,
            centre_s: 0.5 * first + 0.5 * last,
            half_s: 0.5 * last - 0.5 * first,
            middle: 0.5 * low + 0.5 * high,
            half_range: 0.5 * high - 0.5 * low,
        };
        if extent.half_s > 0.0 {
            if extent.half_range > 0.0 { Ok(extent) } else { Err(SineError::ZeroSignal) }
        } else {
            // Times that differ by less than the smallest number.
            Err(SineError::SamplePeriod)
        }
    }

    /// The samples in dimensionless time and signal. Without an offset in the model nothing is subtracted.
    fn scaled<I: Iterator<Item = (f64, f64)> + Clone>(
        self,
        samples: I,
        model: SineModel,
    ) -> impl Iterator<Item = (f64, f64)> + Clone {
        let scale = self.signal_scale(model);
        let middle = if model.offset { self.middle } else { 0.0 };
        samples.map(move |(t, y)| ((t - self.centre_s) / self.half_s, (y - middle) / scale))
    }
    fn signal_scale(self, model: SineModel) -> f64 {
        if model.offset { self.half_range } else { self.half_range.max(self.middle.abs()) }
    }
    /// Spans `N·Ts` in dimensionless time: a record of N samples covers N periods of the clock.
    fn span(self) -> f64 {
        2.0 * self.samples as f64 / (self.samples - 1) as f64
    }
    /// Nyquist's frequency of the mean clock, dimensionless.
    fn nyquist(self) -> f64 {
        0.5 * PI * (self.samples - 1) as f64
    }
    fn scales(self, model: SineModel, free: bool) -> Scales<f64> {
        Scales {
            signal: self.signal_scale(model),
            reference: if model.offset { self.middle } else { 0.0 },
            time_s: self.half_s,
            half: 1.0,
            samples: self.samples,
            free,
        }
    }
    /// Checks 0 < ω < limit, the limit being Nyquist over the model's highest harmonic.
    fn check(self, omega: f64, model: SineModel) -> Result<(), SineError> {
        let limit = self.nyquist() / model.highest();
        if omega > 0.0 && omega < limit {
            Ok(())
        } else {
            Err(SineError::Frequency { limit_rad_s: limit / self.half_s })
        }
    }
    fn check_cycles(self, omega: f64, needed: f64) -> Result<(), SineError> {
        let cycles = omega * self.span() / TAU;
        // A grid point or an estimate at exactly the limit is inside it.
        if cycles >= needed * (1.0 - 1e-9) { Ok(()) } else { Err(SineError::TooFewCycles { cycles, needed }) }
    }
}

/// Linear solution, residuals and the frequency's information at one frequency.
fn evaluate<const N: usize>(
    samples: &(impl Iterator<Item = (f64, f64)> + Clone),
    model: SineModel,
    omega: f64,
) -> Option<Point<f64, N>> {
    let mut normal = Normal::<f64, N>::EMPTY;
    for (tau, y) in samples.clone() {
        let (sin, cos) = libm::sincos(omega * tau);
        normal.add(&model.row(sin, cos, tau), y);
    }
    let mut border = Border::new(&normal)?;
    for (tau, y) in samples.clone() {
        let (sin, cos) = libm::sincos(omega * tau);
        let row = model.row(sin, cos, tau);
        let slope = model.slope(&row, border.theta(), tau);
        border.add(&row, slope, y);
    }
    Some(border.point())
}

fn fixed<const N: usize, I>(samples: I, omega_rad_s: f64, model: SineModel) -> Result<SineFit, SineError>
where
    I: Iterator<Item = (f64, f64)> + Clone,
{
    let extent = Extent::of(samples.clone(), N + 1)?;
    let omega = omega_rad_s * extent.half_s;
    extent.check(omega, model)?;
    extent.check_cycles(omega, MIN_CYCLES_FIXED)?;
    let scaled = extent.scaled(samples, model);
    let point = evaluate::<N>(&scaled, model, omega).ok_or(SineError::Singular)?;
    SineFit::assemble(model, omega, &point, point.rss, &extent.scales(model, false))
}

fn free<const N: usize, I>(samples: I, search: FrequencySearch, model: SineModel) -> Result<SineFit, SineError>
where
    I: Iterator<Item = (f64, f64)> + Clone,
{
    let extent = Extent::of(samples.clone(), N + 2)?;
    extent.check(search.estimate * extent.half_s, model)?;
    // At Nyquist itself sine and cosine are one column: stay a grid cell's fraction away.
    let limit = extent.nyquist() / model.highest() - 0.01 * PI;
    let shortest = 0.5 * MIN_CYCLES_FREE * TAU / extent.span();
    let low = (search.low * extent.half_s).max(shortest);
    let high = (search.high * extent.half_s).min(limit);
    extent.check_cycles(high, MIN_CYCLES_FREE)?;
    // Written so that NaN is refused too.
    if !(search.low > 0.0 && search.low < search.high && low < high) {
        return Err(SineError::SearchRange);
    }
    let scaled = extent.scaled(samples, model);
    let cell = grid::search::<N>(&scaled, model, low, high).ok_or(SineError::Singular)?;
    let freedom = (extent.samples - N - 1) as f64;
    let resolution = Resolution::of(cell.best);
    let found =
        refine(cell.low, cell.high, cell.best, resolution, freedom, |omega| evaluate::<N>(&scaled, model, omega));
    let Some((omega, point)) = found else {
        return Err(SineError::SearchEdge { omega_rad_s: cell.best / extent.half_s });
    };
    extent.check_cycles(omega, MIN_CYCLES_FREE)?;
    SineFit::assemble(model, omega, &point, point.rss, &extent.scales(model, true))
}
