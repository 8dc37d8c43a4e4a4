//! Resonances, antiresonances and delay: a rational function with a delay, fitted to the acceleration over the drive.
//!
//! Of the acceleration, because a rigid axis has a level gain there. The delay turns the phase by −ω·τ, and is found with
//! the function: damping and modes turn the phase too.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::rational::{Datum, Rational, fit};
use super::spectra::Spectra;
use super::{Estimate, Mode, Point};

/// Largest degree that is tried: a rigid axis and two modes.
const LARGEST_DEGREE: usize = 5;
/// Each degree must make the misfit smaller by this factor.
const WORTH_A_DEGREE: f64 = 2.0;
/// Errors that no average shows, as a share of the gain: what the window smears.
const SMEARED: f64 = 0.02;
/// Frequencies of the fit, as a share of the sampling rate. Above it converters and currents add what no axis has.
const HIGHEST_FITTED: f64 = 0.2;
/// Fewest frequencies of a fit.
const FEWEST: usize = 8;
/// Most frequencies in an octave that are fitted one by one; more are averaged.
const PER_OCTAVE: f64 = 48.0;
/// Delays that are tried, samples.
const DELAYS: (f64, f64) = (-2.0, 30.0);
/// Largest damping ratio of a mode: above 1/√2 a gain has no peak.
const MOST_DAMPING: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// A pole and a zero nearer to each other than this, as a share, take each other away.
const CANCELLED: f64 = 0.03;
/// Largest standard error of a mode's frequency, as a share.
const MOST_FREQUENCY_ERROR: f64 = 0.1;

/// What was found.
#[derive(Debug, Default)]
pub(super) struct Found {
    pub(super) resonances: Vec<Mode>,
    pub(super) antiresonances: Vec<Mode>,
    pub(super) delay_s: Option<Estimate>,
}

/// Fits the response of all segments, and without each group of them for the standard errors.
pub(super) fn find(spectra: &Spectra) -> Found {
    let interval_s = spectra.interval_s();
    let values = accelerations(&spectra.points(), interval_s);
    let (Some(first), Some(last)) = (values.first(), values.last()) else { return Found::default() };
    let band = (first.omega_rad_s, last.omega_rad_s);
    let Some((degree, delay_s, whole)) = choose(&values, interval_s) else { return Found::default() };
    let parts: Vec<(f64, Rational)> = (0..spectra.groups())
        .filter_map(|group| delayed(&accelerations(&spectra.without(group), interval_s), degree, interval_s))
        .collect();
    let all = parts.len() == spectra.groups() && parts.len() > 1;
    let se = |of: &dyn Fn(&(f64, Rational)) -> Option<f64>| -> f64 {
        let left: Vec<f64> = parts.iter().filter_map(of).collect();
        if all && left.len() == parts.len() { jackknife(&left) } else { f64::NAN }
    };
    let modes = |roots: &dyn Fn(&Rational) -> Vec<Complex<f64>>, others: &[Complex<f64>], stable: bool| {
        let mut modes: Vec<Mode> = roots(&whole)
            .into_iter()
            .filter(|root| (band.0..=band.1).contains(&root.norm()) && damping(*root).abs() < MOST_DAMPING)
            .filter(|root| !stable || damping(*root) > 0.0)
            .filter(|root| others.iter().all(|other| (other - root).norm() > CANCELLED * root.norm()))
            .map(|root| {
                let same = |part: &(f64, Rational)| nearest(&roots(&part.1), root);
                let frequency_se = se(&|part| Some(same(part)?.norm() / TAU));
                let damping_se = se(&|part| Some(damping(same(part)?)));
                Mode {
                    frequency_hz: Estimate { value: root.norm() / TAU, se: frequency_se },
                    damping_ratio: Estimate { value: damping(root), se: damping_se },
                }
            })
            .filter(|mode| mode.frequency_hz.se < MOST_FREQUENCY_ERROR * mode.frequency_hz.value)
            .collect();
        modes.sort_by(|a, b| a.frequency_hz.value.total_cmp(&b.frequency_hz.value));
        modes
    };
    let (poles, zeros) = (whole.poles(), whole.zeros());
    let delay = Estimate { value: delay_s, se: se(&|part| Some(part.0)) };
    Found {
        resonances: modes(&Rational::poles, &zeros, true),
        antiresonances: modes(&Rational::zeros, &poles, false),
        delay_s: delay.se.is_finite().then_some(delay),
    }
}

/// The degree that is worth its unknowns, with its delay. A misfit below 1 is noise.
fn choose(values: &[Datum], interval_s: f64) -> Option<(usize, f64, Rational)> {
    (1..=LARGEST_DEGREE)
        .filter_map(|degree| {
            let (delay_s, own) = delayed(values, degree, interval_s)?;
            let price = own.misfit.max(1.0) * WORTH_A_DEGREE.powi(degree as i32);
            Some((price, (degree, delay_s, own)))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, chosen)| chosen)
}

/// The function of `degree` with the delay that fits best.
fn delayed(values: &[Datum], degree: usize, interval_s: f64) -> Option<(f64, Rational)> {
    let of = |delay_s: f64| {
        let ahead: Vec<Datum> = values
            .iter()
            .map(|own| Datum { value: own.value * Complex::from_polar(1.0, own.omega_rad_s * delay_s), ..*own })
            .collect();
        fit(&ahead, degree)
    };
    // Half a sample turns the phase at the highest frequency by a tenth of a turn.
    let steps = (2.0 * (DELAYS.1 - DELAYS.0)) as usize;
    let tried = (0..=steps).map(|step| (DELAYS.0 + 0.5 * step as f64) * interval_s);
    let (mut best_s, mut best) =
        tried.filter_map(|delay_s| Some((delay_s, of(delay_s)?))).min_by(|a, b| a.1.misfit.total_cmp(&b.1.misfit))?;
    let mut step_s = 0.25 * interval_s;
    while step_s > 1e-3 * interval_s {
        let beside = [best_s - step_s, best_s + step_s].into_iter().filter_map(|delay_s| Some((delay_s, of(delay_s)?)));
        match beside.filter(|(_, own)| own.misfit < best.misfit).min_by(|a, b| a.1.misfit.total_cmp(&b.1.misfit)) {
            Some(better) => (best_s, best) = better,
            None => step_s *= 0.5,
        }
    }
    Some((best_s, best))
}

/// Accelerations over the drive at the coherent frequencies, so many in an octave; none where they are too few. Each octave
/// has the same weight.
fn accelerations(points: &[Point], interval_s: f64) -> Vec<Datum> {
    let fitted = points.iter().filter(|point| point.coherent && point.frequency_hz <= HIGHEST_FITTED / interval_s);
    let mut values: Vec<Datum> = Vec::new();
    let mut bin: Vec<Datum> = Vec::new();
    for point in fitted {
        let omega_rad_s = TAU * point.frequency_hz;
        let factor = -omega_rad_s * omega_rad_s;
        let value = point.response * factor;
        let own = Datum { omega_rad_s, value, se: (point.gain_se * factor).abs(), weight: 1.0 };
        if bin.first().is_some_and(|first| (omega_rad_s / first.omega_rad_s).log2() > PER_OCTAVE.recip()) {
            values.extend(mean(&bin));
            bin.clear();
        }
        bin.push(own);
    }
    values.extend(mean(&bin));
    if values.len() < FEWEST {
        return Vec::new();
    }
    let edges: Vec<f64> = values.iter().map(|value| value.omega_rad_s.log2()).collect();
    for k in 0..values.len() {
        let width = edges[(k + 1).min(edges.len() - 1)] - edges[k.saturating_sub(1)];
        values[k].weight = width.max(1e-9);
        values[k].se = values[k].se.hypot(SMEARED * values[k].value.norm());
    }
    values
}

/// Mean of values next to each other.
fn mean(bin: &[Datum]) -> Option<Datum> {
    let count = bin.len() as f64;
    let sum: Complex<f64> = bin.iter().map(|value| value.value).sum();
    let se = bin.iter().map(|value| value.se.powi(2)).sum::<f64>().sqrt() / count;
    let omega_rad_s = bin.iter().map(|value| value.omega_rad_s).sum::<f64>() / count;
    (!bin.is_empty()).then(|| Datum { omega_rad_s, value: sum / count, se, weight: 1.0 })
}

fn damping(root: Complex<f64>) -> f64 {
    -root.re / root.norm()
}

fn nearest(roots: &[Complex<f64>], to: Complex<f64>) -> Option<Complex<f64>> {
    roots.iter().copied().min_by(|a, b| (a - to).norm().total_cmp(&(b - to).norm()))
}

/// Standard error of an estimate by those without one group each (Efron 1982).
fn jackknife(left: &[f64]) -> f64 {
    let count = left.len() as f64;
    let mean = left.iter().sum::<f64>() / count;
    ((count - 1.0) / count * left.iter().map(|value| (value - mean).powi(2)).sum::<f64>()).sqrt()
}
