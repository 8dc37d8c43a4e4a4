//! Welch's method: spectra of segments that overlap by half, each under a Hann window, are averaged.
//!
//! Source: Welch (1967); errors of gain and coherence of Bendat and Piersol, Random Data, section 9.2.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;
use rustfft::{Fft, FftPlanner};

use super::even::{Even, Piece};
use super::{CHANCE, HIGHEST, LEAST_NEIGHBOURS, MOST_ERROR, NEIGHBOURHOOD_OCTAVES, Point, SPREAD_LINES};

/// Groups of segments for the jackknife.
pub(super) const GROUPS: usize = 8;
/// Independent segments per segment. Neighbours that overlap by half share a sixth of their amplitude under a Hann window, so
/// that the variance of a mean is larger by 1 + 2/36.
const INDEPENDENT: f64 = 18.0 / 19.0;

/// Sums over segments, by frequency.
#[derive(Clone, Debug, Default)]
struct Sums {
    drive: Vec<f64>,
    motion: Vec<f64>,
    cross: Vec<Complex<f64>>,
    segments: usize,
}

impl Sums {
    fn add(&mut self, drive: &[Complex<f64>], motion: &[Complex<f64>]) {
        let lines = drive.len() / 2 + 1;
        self.drive.resize(lines, 0.0);
        self.motion.resize(lines, 0.0);
        self.cross.resize(lines, Complex::default());
        for k in 0..lines {
            self.drive[k] += drive[k].norm_sqr();
            self.motion[k] += motion[k].norm_sqr();
            self.cross[k] += motion[k] * drive[k].conj();
        }
        self.segments += 1;
    }
}

/// The spectra of a session, in groups of segments that follow each other.
#[derive(Debug)]
pub(super) struct Spectra {
    groups: Vec<Sums>,
    length: usize,
    interval_s: f64,
}

/// Segments that a piece gives.
fn count(piece: &Piece, length: usize) -> usize {
    if piece.len() < length { 0 } else { (piece.len() - length) / (length / 2) + 1 }
}

/// The longest segment of which there are at least `wanted`; one that fills the longest piece by halves where there are
/// never so many.
pub(super) fn longest(pieces: &[Piece], wanted: usize) -> usize {
    let segments = |length: usize| pieces.iter().map(|piece| count(piece, length)).sum::<usize>();
    let recorded = pieces.iter().map(Piece::len).max().unwrap_or(0);
    let (mut low, mut high) = (2, recorded.max(2));
    while high - low > 1 {
        let middle = low.midpoint(high);
        if segments(middle) >= wanted { low = middle } else { high = middle }
    }
    low & !1
}

impl Spectra {
    /// Of segments of `length` samples.
    pub(super) fn of(even: &Even, length: usize) -> Self {
        let window: Vec<f64> =
            (0..length).map(|k| 0.5 - 0.5 * (TAU * (k as f64 + 0.5) / length as f64).cos()).collect();
        let fft = FftPlanner::new().plan_fft_forward(length);
        let all: usize = even.pieces.iter().map(|piece| count(piece, length)).sum();
        let mut groups = vec![Sums::default(); GROUPS.min(all)];
        let mut done = 0;
        for piece in &even.pieces {
            for segment in 0..count(piece, length) {
                let range = segment * (length / 2)..segment * (length / 2) + length;
                let drive = spectrum(fft.as_ref(), &window, &piece.drive[range.clone()]);
                let motion = spectrum(fft.as_ref(), &window, &piece.steps[range]);
                let group = done * groups.len() / all;
                groups[group].add(&drive, &motion);
                done += 1;
            }
        }
        Self { groups, length, interval_s: even.interval_s }
    }

    pub(super) fn segments(&self) -> usize {
        self.groups.iter().map(|group| group.segments).sum()
    }

    pub(super) fn groups(&self) -> usize {
        self.groups.len()
    }

    /// Interval between samples, s.
    pub(super) fn interval_s(&self) -> f64 {
        self.interval_s
    }

    /// The response of all segments.
    pub(super) fn points(&self) -> Vec<Point> {
        self.without(usize::MAX)
    }

    /// The response without the segments of one group.
    pub(super) fn without(&self, left_out: usize) -> Vec<Point> {
        let mut points = Vec::new();
        let kept = || self.groups.iter().enumerate().filter(|(k, _)| *k != left_out).map(|(_, group)| group);
        let segments = INDEPENDENT * kept().map(|group| group.segments).sum::<usize>() as f64;
        // A coherence of unrelated signals exceeds this with the probability CHANCE (Carter, Knapp and Nuttall 1973).
        let by_chance = if segments > 1.0 { 1.0 - CHANCE.powf((segments - 1.0).recip()) } else { 1.0 };
        for line in SPREAD_LINES..=(HIGHEST * self.length as f64) as usize {
            let drive: f64 = kept().map(|group| group.drive[line]).sum();
            let motion: f64 = kept().map(|group| group.motion[line]).sum();
            let cross: Complex<f64> = kept().map(|group| group.cross[line]).sum();
            let coherence = (cross.norm_sqr() / (drive * motion)).min(1.0);
            let turn = line as f64 / self.length as f64;
            // From steps to positions, and from the drive's samples to the drive that is held.
            let to_position = (Complex::from_polar(1.0, TAU * turn) - 1.0).inv();
            let held = Complex::from_polar((PI * turn).sin() / (PI * turn), -PI * turn);
            let response = cross / drive * to_position / held;
            let share = ((1.0 - coherence) / (2.0 * segments * coherence)).sqrt();
            if response.is_finite() {
                points.push(Point {
                    frequency_hz: turn / self.interval_s,
                    response,
                    gain_se: share * response.norm(),
                    phase_rad: response.arg(),
                    coherence,
                    coherent: share <= MOST_ERROR && coherence > by_chance,
                });
            }
        }
        without_strays(&mut points);
        continue_phase(&mut points);
        points
    }
}

/// Takes the coherence from frequencies that are nearly alone with it: chance, or what a controller makes of the sensor's steps.
fn without_strays(points: &mut [Point]) {
    let coherent: Vec<bool> = points.iter().map(|point| point.coherent).collect();
    let near = NEIGHBOURHOOD_OCTAVES.exp2();
    for k in 0..points.len() {
        let frequency_hz = points[k].frequency_hz;
        let from = points.partition_point(|other| other.frequency_hz < frequency_hz / near).min(k.saturating_sub(2));
        let to = points.partition_point(|other| other.frequency_hz <= frequency_hz * near).max(k + 3).min(points.len());
        let there = coherent[from..to].iter().filter(|coherent| **coherent).count();
        points[k].coherent = coherent[k] && there as f64 >= LEAST_NEIGHBOURS * (to - from) as f64;
    }
}

/// Turns each phase by whole turns to that of the coherent frequency before it.
fn continue_phase(points: &mut [Point]) {
    let mut before_rad: Option<f64> = None;
    for point in points {
        if let Some(before_rad) = before_rad {
            point.phase_rad += TAU * ((before_rad - point.phase_rad) / TAU).round();
        }
        if point.coherent {
            before_rad = Some(point.phase_rad);
        }
    }
}

/// The spectrum of a segment without its mean, under the window.
fn spectrum(fft: &dyn Fft<f64>, window: &[f64], segment: &[f64]) -> Vec<Complex<f64>> {
    let mean = segment.iter().sum::<f64>() / segment.len() as f64;
    let mut buffer: Vec<Complex<f64>> =
        segment.iter().zip(window).map(|(value, weight)| Complex::new((value - mean) * weight, 0.0)).collect();
    fft.process(&mut buffer);
    buffer
}
