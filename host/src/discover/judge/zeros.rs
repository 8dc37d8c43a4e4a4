//! The zero of each recording. An incremental encoder starts anywhere. A law of the position has one phase only where
//! all recordings count from one place.

use std::f64::consts::{PI, TAU};

use breakaway_core::plant::effect::Element;
use breakaway_core::plant::{Base, Effect};
use nalgebra::{DMatrix, DVector};

use super::dataset::Dataset;
use super::ruling::Ruling;
use super::settings::Settings;
use super::weak_form::{Sample, WeakForm};
use crate::discover::known::without_effects;
use crate::fit::{Candidate, golden_section};
use crate::recording::Recording;

/// Places that are tried along the shortest wave before the best is refined.
const PLACES: f64 = 36.0;
/// Phase of the shortest wave within which places are the same, rad. It changes the wave by 5 %.
const SAME_RAD: f64 = 0.05;
/// Most places that are tried: of waves whose numbers are a thousandfold apart, all of them. Beyond that only places near
/// the present zero are, so that the search ends for any wave number.
const MOST_PLACES: f64 = 40_000.0;
/// Longest waves about the place of a spring's rest in which places are tried. The mean of what the
/// waves leave tells the rest alone, so it may be a wave off. All laws together tell the place.
const WAVES_ABOUT_REST: f64 = 5.0;
/// Golden sections that refine the best place to a thousandth of a step.
const SECTIONS: usize = 14;

/// How far to move the positions of each of `recordings`, position units, so that all have one zero. The laws of the
/// position that the ruling names then have the places that they have in `first`. All laws are placed together. A ripple
/// tells the zero but for whole waves, and a load of one wave tells which wave it is. A recording that tells no place is
/// not moved. `None` where one zero fits all, or where `first` tells none.
pub fn shifts(recordings: &[Recording], first: &Recording, ruling: &Ruling, settings: &Settings) -> Option<Vec<f64>> {
    if !ruling.findings.iter().any(|finding| finding.own_zeros) {
        return None;
    }
    let laws = PositionLaws::of(ruling)?;
    let place = |recording: &Recording| laws.place(recording, ruling.half_width_s, settings);
    let reference = place(first)?;
    let shift = |recording| place(recording).map_or(0.0, |own| laws.nearest(own - reference));
    let shifts: Vec<f64> = recordings.iter().map(shift).collect();
    let is_same = |shift: &f64| laws.wave_numbers.is_some_and(|[_, shortest]| (shortest * shift).abs() < SAME_RAD);
    (!shifts.iter().all(is_same)).then_some(shifts)
}

/// A law of the position, as a force on the side of the drive. It is linear in two columns.
#[derive(Clone, Copy)]
enum PositionLaw {
    /// A·sin(k·x + φ), times what the wave acts on.
    Wave { acts_on: ActsOn, amplitude: f64, wave_number: f64, phase: f64 },
    /// κ·(x − rest).
    Spring { stiffness: f64, rest: f64 },
}

/// What a wave over position acts on.
#[derive(Clone, Copy, PartialEq)]
enum ActsOn {
    Force,
    Friction,
    Reading,
}

impl PositionLaw {
    /// `None` for an effect that is no law of the position.
    fn of(effect: &Effect<f64>, base: &Base<f64>) -> Option<Self> {
        let wave = |acts_on, amplitude, wave_number, phase| Self::Wave { acts_on, amplitude, wave_number, phase };
        match effect.element(base) {
            Element::Ripple { wave_number, first: [amplitude, phase], .. } => {
                Some(wave(ActsOn::Force, -amplitude, wave_number, phase))
            }
            Element::LevelByPosition { amplitude, wave_number, phase } => {
                Some(wave(ActsOn::Friction, amplitude, wave_number, phase))
            }
            Element::ReadingRipple { amplitude, wave_number, phase } => {
                Some(wave(ActsOn::Reading, -amplitude * base.b, wave_number, phase))
            }
            Element::Spring { stiffness, rest } => Some(Self::Spring { stiffness, rest }),
            _ => None,
        }
    }

    /// The two columns in the windows of `form`.
    fn columns(&self, form: &WeakForm<'_>) -> [Vec<f64>; 2] {
        let Self::Wave { acts_on, wave_number, .. } = *self else {
            return [form.means(&form.field(|s| s.x)), vec![1.0; form.rows.len()]];
        };
        [0.0, 0.5 * PI].map(|quarter| {
            let of = |s: Sample| {
                let wave = (wave_number * s.x + quarter).sin();
                if acts_on == ActsOn::Friction { s.direction * wave } else { wave }
            };
            let field = form.field(of);
            if acts_on == ActsOn::Reading { form.second_derivatives(&field) } else { form.means(&field) }
        })
    }

    /// The factors of the columns where the law is moved by `place`, position units.
    fn factors(&self, place: f64) -> [f64; 2] {
        match *self {
            Self::Wave { amplitude, wave_number, phase, .. } => {
                let (sin, cos) = (phase + wave_number * place).sin_cos();
                [amplitude * cos, amplitude * sin]
            }
            Self::Spring { stiffness, rest } => [stiffness, stiffness * (place - rest)],
        }
    }
}

/// The laws of the position of a ruling, beside what it names else.
struct PositionLaws {
    laws: Vec<PositionLaw>,
    /// The base, and the other effects.
    others: Candidate,
    /// The least and the largest wave number, radians of the wave in a position unit; `None` where no law repeats.
    wave_numbers: Option<[f64; 2]>,
}

impl PositionLaws {
    /// `None` where the ruling names no law of the position.
    fn of(ruling: &Ruling) -> Option<Self> {
        let effects = || ruling.findings.iter().map(|finding| finding.effect);
        let of = |effect: &Effect<f64>| PositionLaw::of(effect, &ruling.base);
        let laws: Vec<PositionLaw> = effects().filter_map(|effect| of(&effect)).collect();
        let wave_numbers = laws.iter().filter_map(|law| match law {
            PositionLaw::Wave { wave_number, .. } => Some(wave_number.abs()),
            PositionLaw::Spring { .. } => None,
        });
        let range = wave_numbers.fold(None, |range: Option<[f64; 2]>, k| {
            Some(range.map_or([k, k], |[least, largest]| [least.min(k), largest.max(k)]))
        });
        let others = Candidate { base: ruling.base, effects: effects().filter(|own| of(own).is_none()).collect() };
        (!laws.is_empty()).then_some(Self { laws, others, wave_numbers: range })
    }

    /// The shortest distance to the same place of the longest wave. A spring has one place of rest, so beside it no other
    /// place is the same.
    fn nearest(&self, distance: f64) -> f64 {
        let spring = self.laws.iter().any(|law| matches!(law, PositionLaw::Spring { .. }));
        let wave_number = self.wave_numbers.map(|[least, _]| least).filter(|_| !spring);
        wave_number.map_or(distance, |k| (k * distance + PI).rem_euclid(TAU) / k - PI / k)
    }

    /// The place of the laws that fits the forces of one recording best, position units. `None` where the recording moves
    /// too little.
    fn place(&self, recording: &Recording, half_width_s: f64, settings: &Settings) -> Option<f64> {
        let alone = without_effects(std::slice::from_ref(recording), &self.others);
        let dataset = Dataset::new(&alone, settings);
        let form = WeakForm::new(&dataset, half_width_s, settings)?;
        let base = self.others.base;
        let rows = form.row_u.iter().zip(&form.row_a).zip(form.row_v.iter().zip(&form.row_direction));
        let left = rows.map(|((u, a), (v, s))| u - base.b * a - base.c * v - base.f1 * s);
        let left = DVector::from_iterator(form.rows.len(), left);
        let columns: Vec<Vec<f64>> = self.laws.iter().flat_map(|law| law.columns(&form)).collect();
        let columns = DMatrix::from_fn(form.rows.len(), columns.len(), |i, j| columns[j][i]);
        let (products, with_left) = (columns.tr_mul(&columns), columns.tr_mul(&left));
        let misses = |place: f64| {
            let factors: Vec<f64> = self.laws.iter().flat_map(|law| law.factors(place)).collect();
            let factors = DVector::from_vec(factors);
            factors.dot(&(&products * &factors)) - 2.0 * factors.dot(&with_left)
        };
        let rest = self.place_of_rest(&products, &with_left);
        let about = rest.unwrap_or(0.0);
        let Some([longest, shortest]) = self.wave_numbers else { return Some(about) };
        let step = TAU / (shortest * PLACES);
        let waves = if rest.is_some() { WAVES_ABOUT_REST } else { 1.0 };
        let count = (waves * TAU / longest / step).ceil().clamp(1.0, MOST_PLACES);
        let places = (0..count as usize).map(|i| about + (i as f64 - 0.5 * count) * step);
        let best = places.min_by(|a, b| misses(*a).total_cmp(&misses(*b)))?;
        Some(golden_section([best - step, best + step], SECTIONS, misses))
    }

    /// The place by the spring alone; `None` where there is none.
    fn place_of_rest(&self, products: &DMatrix<f64>, with_left: &DVector<f64>) -> Option<f64> {
        let (i, stiffness, rest) = self.laws.iter().enumerate().find_map(|(i, law)| match *law {
            PositionLaw::Spring { stiffness, rest } => Some((2 * i, stiffness, rest)),
            PositionLaw::Wave { .. } => None,
        })?;
        let count = products[(i + 1, i + 1)];
        Some(rest + (with_left[i + 1] / stiffness - products[(i, i + 1)]) / count)
    }
}

#[cfg(test)]
pub(in crate::discover) mod tests {
    use breakaway_core::plant::Kind;

    use super::*;
    use crate::discover::judge::finding::Finding;
    use crate::discover::judge::ruling::rule;

    /// 20 s at 500 Hz of a pendulum with b = .02 V·s²/rad, c = .1 V·s/rad and .6 V at its side. Its reading starts at
    /// `zero`.
    fn pendulum(zero: f64, beat: f64) -> Recording {
        with_a_ripple(zero, beat, 0.0)
    }

    /// The same with a ripple of seven waves in a turn, V.
    pub fn with_a_ripple(zero: f64, beat: f64, ripple: f64) -> Recording {
        under(zero, beat, |x| 0.6 * x.sin() + ripple * (7.0 * x).sin())
    }

    /// The same with another force of the position at its side, V.
    fn under(zero: f64, beat: f64, force: impl Fn(f64) -> f64) -> Recording {
        let (b, c, h) = (0.02, 0.1, 2e-3);
        let (mut x, mut v) = (0.0_f64, 0.0_f64);
        let mut recording = Recording::default();
        for k in 0..10_000 {
            let t = f64::from(k) * h;
            let u = 1.1 * (2.3 * t).sin() + 0.8 * (beat * t).sin();
            recording.t.push(t);
            recording.u.push(u);
            recording.x.push(x + zero);
            for _ in 0..10 {
                v += (u - c * v - force(x)) / b * h / 10.0;
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

    /// A ripple of seven waves tells the zero but for .9 rad, a seventh of a turn, and gravity tells which. Placed together
    /// the two give it to a thousandth of a radian. In the reading of the first the ripple is at 7·.4 rad.
    #[test]
    fn laws_are_placed_together() {
        let zeros = [0.4, 1.5, -2.0, 3.0];
        let beats = [7.1, 9.7, 5.3, 8.3];
        let recordings: Vec<Recording> =
            zeros.iter().zip(beats).map(|(zero, beat)| with_a_ripple(*zero, beat, 0.3)).collect();
        let finding = |kind, p: &[f64]| Finding {
            effect: Effect::new(kind, p),
            own_zeros: kind == Kind::GravityLoad,
            ..Finding::of(kind)
        };
        let ruling = Ruling {
            base: Base { b: 0.02, c: 0.1, f1: 0.0 },
            findings: vec![finding(Kind::Cogging, &[-0.3, 7.0, -2.8]), finding(Kind::GravityLoad, &[-0.6, -0.4])],
            half_width_s: 0.03,
            ..Ruling::naming(&[], [0.0, 1.0])
        };
        let shifts = shifts(&recordings, &recordings[0], &ruling, &Settings::default()).unwrap();
        for (shift, zero) in shifts.iter().zip(zeros) {
            let off = (shift + zero - zeros[0] + PI).rem_euclid(TAU) - PI;
            assert!(off.abs() < 1e-3, "{shifts:?}");
        }
    }

    /// A ripple of seven waves beside a spring. The zeros differ by up to four waves, and the place of rest tells each. A place
    /// that is a wave further is another. In the reading of the first the spring rests at .4 rad.
    #[test]
    fn a_spring_tells_the_wave() {
        let zeros = [0.4, 2.2, -3.1, 1.3];
        let beats = [7.1, 9.7, 5.3, 8.3];
        let axis = |(zero, beat): (&f64, f64)| under(*zero, beat, |x| 0.25 * x + 0.3 * (7.0 * x).sin());
        let recordings: Vec<Recording> = zeros.iter().zip(beats).map(axis).collect();
        let finding = |kind, p: &[f64]| Finding { effect: Effect::new(kind, p), own_zeros: true, ..Finding::of(kind) };
        let ruling = Ruling {
            base: Base { b: 0.02, c: 0.1, f1: 0.0 },
            findings: vec![finding(Kind::Cogging, &[-0.3, 7.0, -2.8]), finding(Kind::Spring, &[0.25, 0.4])],
            half_width_s: 0.03,
            ..Ruling::naming(&[], [0.0, 1.0])
        };
        let shifts = shifts(&recordings, &recordings[0], &ruling, &Settings::default()).unwrap();
        for (shift, zero) in shifts.iter().zip(zeros) {
            assert!((shift + zero - zeros[0]).abs() < 1e-3, "{shifts:?}");
        }
    }

    /// A wave number of nearly nothing would ask for 10¹¹ places. The search ends, and finds the zero of the ripple.
    #[test]
    fn the_search_ends_for_any_wave_number() {
        let finding = |n: f64, phase: f64| Finding {
            effect: Effect::new(Kind::Cogging, &[-0.3, n, phase]),
            own_zeros: true,
            ..Finding::of(Kind::Cogging)
        };
        let ruling = Ruling {
            base: Base { b: 0.02, c: 0.1, f1: 0.0 },
            findings: vec![finding(7.0, 0.0), finding(1e-9, 0.0)],
            half_width_s: 0.03,
            ..Ruling::naming(&[], [0.0, 1.0])
        };
        let laws = PositionLaws::of(&ruling).unwrap();
        let place = laws.place(&with_a_ripple(0.0, 7.1, 0.3), 0.03, &Settings::default()).unwrap();
        assert!((7.0 * place).cos() > 0.99, "{place}");
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
