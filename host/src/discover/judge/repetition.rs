//! What repeats with the drive of what is left. It tells that an effect is missing, whichever it is.

use super::gain::{Block, z};
use super::regression::rms;
use super::weak_form::WeakForm;

/// The part of a residual force that repeats from one period of the drive to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repetition {
    /// Its rms over that of the drive; 0 where the mean product of two periods is not positive.
    pub share: f64,
    /// Its z over blocks.
    pub z: f64,
}

/// Shortest period, as a multiple of the windows' half-width. A quarter of it is then a window, so that the windows with which
/// a period is compared do not overlap.
const LEAST_PERIOD: f64 = 8.0;

/// What repeats of a residual, one value for each window; `None` where no drive repeats, or too fast for the windows
/// (docs/discovery.md, section 10).
pub(super) fn repetition(form: &WeakForm<'_>, residual: &[f64]) -> Option<Repetition> {
    let mut blocks = vec![Block::default(); form.blocks];
    let (mut products, mut count) = (0.0, 0);
    for (i, fundamental) in form.dataset.fundamentals().iter().enumerate() {
        let Some((omega, _)) = fundamental else { continue };
        let period_s = std::f64::consts::TAU / omega;
        if period_s < LEAST_PERIOD * form.half_width_s {
            continue;
        }
        let first = form.rows.partition_point(|row| row.piece < i);
        let own = &form.rows[first..form.rows.partition_point(|row| row.piece <= i)];
        let h_s = form.dataset.pieces[i].h_s;
        let later = |from: usize, periods: f64| {
            let wanted = own[from].centre as f64 + periods * period_s / h_s;
            let after = own.partition_point(|row| (row.centre as f64) < wanted);
            let near = |at: &usize| (own[*at].centre as f64 - wanted).abs();
            let nearest = [after.checked_sub(1), Some(after)].into_iter().flatten().filter(|at| *at < own.len());
            let at = nearest.min_by(|a, b| near(a).total_cmp(&near(b)))?;
            (near(&at) * h_s < 0.5 * form.half_width_s).then(|| residual[first + at])
        };
        for (k, row) in own.iter().enumerate() {
            let [Some(early), Some(same), Some(late)] = [0.75, 1.0, 1.25].map(|periods| later(k, periods)) else {
                continue;
            };
            let r = residual[first + k];
            // The prediction by the other period saves the product, and acts where the residual is large.
            let product = r * (same - 0.5 * (early + late));
            blocks[row.block].before += product;
            blocks[row.block].change += 0.5 * (r * r + same * same);
            products += product;
            count += 1;
        }
    }
    let share = (products / f64::from(count)).max(0.0).sqrt() / rms(&form.row_u);
    (count > 0 && share.is_finite()).then(|| Repetition { share, z: z(&blocks) })
}

#[cfg(test)]
mod tests {
    use super::super::dataset::Dataset;
    use super::super::search::Stage;
    use super::super::settings::Settings;
    use super::super::sides::Model;
    use super::super::weights::Weights;
    use super::*;
    use crate::recording::Recording;

    /// Period of the drive, s.
    const PERIOD_S: f64 = 1.6;

    /// What is left of so many samples at 500 Hz of an axis under a force of time that no effect of the model has.
    fn within(samples: u32, force: impl Fn(f64) -> f64) -> Option<Repetition> {
        let (mut x, mut v) = (0.0, 0.0_f64);
        let mut recording = Recording::default();
        for k in 0..samples {
            let t = 2e-3 * f64::from(k);
            let phase = std::f64::consts::TAU * t / PERIOD_S;
            let u = phase.cos() + 0.4 * (3.0 * phase).sin();
            recording.t.push(t);
            recording.u.push(u);
            recording.x.push(x);
            for _ in 0..20 {
                v += (u - force(t) - 0.1 * v.signum() - 0.05 * v) / 0.02 * 1e-4;
                x += v * 1e-4;
            }
        }
        let settings = Settings::default();
        let dataset = Dataset::new(&[recording], &settings);
        let form = WeakForm::new(&dataset, 0.04, &settings).unwrap();
        let stage = Stage::new(&form, &settings, Model::default(), &Weights::equal(&form)).unwrap();
        repetition(&form, &stage.fitted.u.residual)
    }

    /// The same of 16 s, which are ten periods.
    fn of(force: impl Fn(f64) -> f64) -> Repetition {
        within(8000, force).unwrap()
    }

    /// In 3.2 s there are two periods, so that it is not known whether the drive repeats.
    #[test]
    fn two_periods_tell_no_repetition() {
        assert_eq!(within(1600, |_| 0.0), None);
    }

    /// The fifth harmonic of the drive's period, of .08. Its rms over the drive's, .08/√(1 + .4²), is .074; the windows let a
    /// wave of 3.1 Hz pass with .93 of it. The base takes a part.
    #[test]
    fn a_force_of_the_drives_period_repeats() {
        let repeats = of(|t| 0.08 * (5.0 * std::f64::consts::TAU * t / PERIOD_S).sin());
        assert!(repeats.z > 4.0 && (0.05..0.075).contains(&repeats.share), "{repeats:?}");
    }

    /// A wave of 3.3 Hz is no harmonic of it: a period later it has moved on by .28 of a wave. A load that grows is alike a
    /// quarter of a period earlier and later.
    #[test]
    fn what_does_not_repeat_and_what_drifts_is_no_repetition() {
        let moves_on = of(|t| 0.08 * (20.7 * t).sin());
        let drifts = of(|t| 0.02 * (t - 8.0));
        assert!([moves_on, drifts].iter().all(|own| own.z < 4.0 || own.share < 0.02), "{moves_on:?} {drifts:?}");
    }
}
