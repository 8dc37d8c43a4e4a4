//! Whether the simulated motion follows the measured one better with other names.

use std::f64::consts::FRAC_PI_2;

use breakaway_core::plant::effect::Role;
use breakaway_core::plant::{Effect, Kind};

use super::data::Data;
use super::decide::{NAMING, paired};
use super::gap::{open_loop_squares, root_mean};
use super::judge::gain::z_of_t;
use super::judge::ruling::Ruling;
use super::outcome::Rung;
use crate::fit::Fit;

/// Held-out error over 1 s in open loop, position units; over segments where no window of 1 s is held out.
pub(super) fn open_loop(data: &Data, fit: &Fit) -> f64 {
    let windows = open_loop_squares(data, &data.open_loop, fit);
    let (square, count) = windows.iter().fold((0.0, 0), |sum, (square, n)| (sum.0 + square, sum.1 + n));
    if count > 0 { (square / count as f64).sqrt() } else { root_mean(&data.over(&data.score).score(&fit.candidate)) }
}

/// Whether `fit` follows most held-out segments better than `base`. Where another effect is missing too, a few segments
/// that it follows much worse outweigh the others in a mean square.
pub(super) fn follows(data: &Data, base: &Fit, fit: &Fit) -> bool {
    let held_out = data.over(&data.score);
    let [before, after] = [base, fit].map(|fit| held_out.score(&fit.candidate));
    mostly_better(data.sigma, &before, &after)
}

/// The same over windows of 1 s in open loop.
pub(super) fn follows_for_longer(data: &Data, base: &Fit, fit: &Fit) -> bool {
    let mean = |(square, count): (f64, usize)| square / count.max(1) as f64;
    let [before, after] = [base, fit].map(|fit| {
        let windows = open_loop_squares(data, &data.open_loop, fit);
        windows.into_iter().map(mean).collect::<Vec<f64>>()
    });
    mostly_better(data.sigma, &before, &after)
}

/// Whether the segments that were fitted name what `fit` has more than `before`, and the held-out motion bears it out. An
/// effect that acts in few segments is told by those beyond doubt, though most segments are no better with it. Neither
/// held-out error may be larger.
pub(super) fn told(data: &Data, before: &Fit, fit: &Fit) -> bool {
    let parameters = fit.free.len().saturating_sub(before.free.len());
    let held_out = |fit: &Fit| root_mean(&data.over(&data.score).score(&fit.candidate));
    parameters > 0
        && paired(&before.mse, &fit.mse, &fit.samples, data.floor()).names(parameters, &NAMING)
        && held_out(fit) <= held_out(before)
        && open_loop(data, fit) <= open_loop(data, before)
}

/// Whether mean squares fall, significantly over the windows. A short recording has few, so that their mean over its error
/// is a t.
fn mostly_better(sigma: f64, before: &[f64], after: &[f64]) -> bool {
    let compared = paired(before, after, &vec![1.0; after.len()], sigma);
    let freedom = after.len().saturating_sub(1) as f64;
    compared.delta >= NAMING.delta && freedom > 0.0 && z_of_t(compared.z, freedom) >= NAMING.z
}

/// Why names of the measured forces are taken back; `None` where they stay. They go where the simulated motion is no
/// better with them. Names that all repeat over position stay: a simulated rotor is soon off by one tooth, so its error
/// says nothing.
pub(super) fn contradicted(ruling: &Ruling, ladder: &[Rung]) -> Option<String> {
    let others: Vec<&str> = ruling
        .findings
        .iter()
        .map(|finding| finding.effect.kind)
        .filter(|kind| !kind.periodic_in_position())
        .map(Kind::name)
        .collect();
    let (first, last) = (ladder.first()?, ladder.last()?);
    let better = last.holdout_rmse < BETTER * first.holdout_rmse
        || last.holdout_open_loop_rmse < BETTER * first.holdout_open_loop_rmse;
    (!others.is_empty() && !better).then(|| {
        format!("the measured forces speak for {}, and the simulated motion does not: not named", others.join(" and "))
    })
}

/// Whether all names repeat over position, and the simulated motion is off by a quarter of their shortest wave. A simulated
/// rotor then comes to rest in another tooth than the measured one, so its error tells nothing more. The error is that of
/// held-out segments with these effects, position units. It is asked for only where all names repeat.
pub(super) fn off_by_a_tooth(ruling: &Ruling, effects: &[Effect<f64>], error: impl FnOnce() -> f64) -> bool {
    let ripples = ruling.findings.iter().map(|finding| finding.effect.kind);
    if ruling.findings.is_empty() || !ripples.into_iter().all(Kind::periodic_in_position) {
        return false;
    }
    let wave_numbers = effects.iter().flat_map(|effect| {
        let parameters = effect.kind.definition().parameters.iter().zip(effect.p);
        parameters.filter(|(parameter, _)| parameter.role == Role::WaveNumber).map(|(_, value)| value)
    });
    error() * wave_numbers.fold(0.0, f64::max) > FRAC_PI_2
}

/// Share of the held-out simulation error below which names must bring it, over segments or in open loop.
const BETTER: f64 = 0.95;

#[cfg(test)]
mod tests {
    use breakaway_core::plant::{Effect, Kind};

    use super::super::judge::ruling::Ruling;
    use super::{mostly_better, off_by_a_tooth};

    /// A quarter of a wave is 2π/28 = .224 rad, where there are seven in a turn. Other effects tell the motion from its wave.
    #[test]
    fn a_rotor_is_off_by_a_quarter_of_its_wave() {
        let off = |kinds: &[Kind], error: f64| {
            let effects: Vec<Effect<f64>> = kinds.iter().map(|kind| Effect::new(*kind, &[1.0, 7.0, 0.0])).collect();
            off_by_a_tooth(&Ruling::naming(kinds, [0.1, 50.0]), &effects, || error)
        };
        assert!(off(&[Kind::Cogging], 0.23) && !off(&[Kind::Cogging], 0.22));
        assert!(!off(&[Kind::Cogging, Kind::Stribeck], 0.23) && !off(&[], 0.23));
    }

    /// Mean squares that fall by a fifth on average. In four windows the mean is 2.0 times its error, which chance gives
    /// once in seven times with three degrees of freedom. In forty it is 7.3 times its error.
    #[test]
    fn few_windows_tell_little() {
        let after = |count: usize| -> Vec<f64> { (0..count).map(|i| [0.6, 0.75, 0.9, 1.0][i % 4]).collect() };
        let better = |count: usize| mostly_better(1e-6, &vec![1.0; count], &after(count));
        assert_eq!([4, 40].map(better), [false, true]);
    }
}
