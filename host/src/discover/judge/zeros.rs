//! The zero of each recording. An incremental encoder starts anywhere. A law of the position has one phase only where
//! all recordings count from one place.

use std::f64::consts::{PI, TAU};

use breakaway_core::plant::{Effect, Kind};

use super::dataset::Dataset;
use super::finding::Finding;
use super::ruling::Ruling;
use super::settings::Settings;
use super::weak_form::{Sample, WeakForm};
use crate::fit::golden_section;
use crate::recording::Recording;

/// Phases that are tried before the best is refined.
const PHASES: usize = 36;
/// Golden sections that refine the best phase to a thousandth of a step.
const SECTIONS: usize = 14;

/// How far to move the positions of each of `recordings`, position units. The first law of the position that the ruling
/// names then has the phase, or the place of rest, that it has in `first`. A recording that tells none is not moved.
/// `None` where one zero fits all, or where `first` tells none.
pub fn shifts(recordings: &[Recording], first: &Recording, ruling: &Ruling, settings: &Settings) -> Option<Vec<f64>> {
    let finding = ruling.findings.iter().find(|finding| finding.own_zeros)?;
    let law = PositionLaw::of(finding, ruling)?;
    let place = |recording: &Recording| law.place(recording, ruling, settings);
    let reference = place(first)?;
    let shift = |recording| place(recording).map_or(0.0, |own| law.nearest(own - reference));
    Some(recordings.iter().map(shift).collect())
}

/// A law of the position, as a force on the side of the drive.
struct PositionLaw {
    kind: Kind,
    amplitude: f64,
    /// Wave number, radians of the wave in a position unit; `None` for a spring, which does not repeat.
    wave_number: Option<f64>,
}

impl PositionLaw {
    fn of(finding: &Finding, ruling: &Ruling) -> Option<Self> {
        let Effect { kind, p } = finding.effect;
        let (amplitude, wave_number) = match kind {
            Kind::Spring => (p[0], None),
            Kind::GravityLoad => (-p[0], Some(1.0)),
            Kind::Cogging => (-p[0], Some(p[1])),
            Kind::PositionFriction => (p[0] * ruling.base.f1, Some(p[1])),
            Kind::EncoderEccentricity => (-p[0] * ruling.base.b, Some(1.0)),
            _ => return None,
        };
        (amplitude != 0.0).then_some(Self { kind, amplitude, wave_number })
    }

    /// The shortest distance to the same place of the wave.
    fn nearest(&self, distance: f64) -> f64 {
        self.wave_number.map_or(distance, |k| (k * distance + PI).rem_euclid(TAU) / k - PI / k)
    }

    /// Place of the law that fits the forces of one recording, position units: its phase over the wave number, or minus
    /// its place of rest. `None` where the recording moves too little.
    fn place(&self, recording: &Recording, ruling: &Ruling, settings: &Settings) -> Option<f64> {
        let dataset = Dataset::new(std::slice::from_ref(recording), settings);
        let form = WeakForm::new(&dataset, ruling.half_width_s, settings)?;
        let base = ruling.base;
        let rows = form.row_u.iter().zip(&form.row_a).zip(form.row_v.iter().zip(&form.row_direction));
        let left: Vec<f64> = rows.map(|((u, a), (v, s))| u - base.b * a - base.c * v - base.f1 * s).collect();
        let Some(k) = self.wave_number else {
            let x = form.means(&form.field(|s| s.x));
            let rest = left.iter().zip(&x).map(|(force, x)| force / self.amplitude - x).sum::<f64>();
            return Some(rest / left.len() as f64);
        };
        let wave = |shift: f64| {
            let of = |s: Sample| {
                let wave = (k * s.x + shift).sin();
                if self.kind == Kind::PositionFriction { s.direction * wave } else { wave }
            };
            let field = form.field(of);
            if self.kind == Kind::EncoderEccentricity { form.second_derivatives(&field) } else { form.means(&field) }
        };
        let (sine, cosine) = (wave(0.0), wave(0.5 * PI));
        let misses = |phase: f64| {
            let (sin, cos) = phase.sin_cos();
            let of = |((force, s), c): ((&f64, &f64), &f64)| (force - self.amplitude * (cos * s + sin * c)).powi(2);
            left.iter().zip(&sine).zip(&cosine).map(of).sum::<f64>()
        };
        let step = TAU / PHASES as f64;
        let best = (0..PHASES).map(|i| i as f64 * step).min_by(|a, b| misses(*a).total_cmp(&misses(*b)))?;
        Some(golden_section([best - step, best + step], SECTIONS, misses) / k)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discover::judge::ruling::rule;

    /// 20 s at 500 Hz of a pendulum with b = .02 V·s²/rad, c = .1 V·s/rad and .6 V at its side. Its reading starts at
    /// `zero`.
    fn pendulum(zero: f64, beat: f64) -> Recording {
        let (b, c, m, h) = (0.02, 0.1, 0.6, 2e-3);
        let (mut x, mut v) = (0.0_f64, 0.0_f64);
        let mut recording = Recording::default();
        for k in 0..10_000 {
            let t = f64::from(k) * h;
            let u = 1.1 * (2.3 * t).sin() + 0.8 * (beat * t).sin();
            recording.t.push(t);
            recording.u.push(u);
            recording.x.push(x + zero);
            for _ in 0..10 {
                v += (u - c * v - m * x.sin()) / b * h / 10.0;
                x += v * h / 10.0;
            }
        }
        recording
    }

    /// Gravity is named though each encoder starts anywhere. The positions are moved by the difference of the zeros, to
    /// .02 rad. That is the half-width of a window at 1 rad/s.
    #[test]
    fn recordings_are_counted_from_one_zero() {
        let recordings = [pendulum(0.0, 7.1), pendulum(1.1, 9.7), pendulum(-2.0, 5.3)];
        let settings = Settings::default();
        let ruling = rule(&recordings, Some(1.0), &settings).unwrap();
        assert_eq!(ruling.findings[0].effect.kind, Kind::GravityLoad, "{:?}", ruling.findings);
        let shifts = shifts(&recordings, &recordings[0], &ruling, &settings).unwrap();
        for (shift, expected) in shifts.iter().zip([0.0, -1.1, 2.0]) {
            assert!((shift - expected).abs() < 0.02, "{shifts:?}");
        }
    }

    /// Recordings of one zero have one phase, so that nothing is moved.
    #[test]
    fn one_zero_stays_one() {
        let recordings = [pendulum(0.3, 7.1), pendulum(0.3, 9.7)];
        let settings = Settings::default();
        let ruling = rule(&recordings, Some(1.0), &settings).unwrap();
        assert_eq!(shifts(&recordings, &recordings[0], &ruling, &settings), None);
    }
}
