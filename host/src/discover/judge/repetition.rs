//! What of the unexplained force repeats with the drive. It needs no model of what is missing: a force that comes again
//! a period later is not random.

use super::evidence::z;
use super::weak_form::WeakForm;

/// Least periods of a drive that are compared.
const LEAST_PERIODS: f64 = 1.5;
/// Largest distance of two windows between which a residual is interpolated, in the median distance of windows.
const NEAR: f64 = 1.5;

/// How much of a residual repeats with the drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repetition {
    /// Share of the residual's energy that comes again a period later. Random force may make it negative.
    pub share: f64,
    /// z over blocks of that share.
    pub z: f64,
}

/// What repeats of a residual of every window; `None` where no drive repeats, or in fewer than four blocks.
pub fn repetition(form: &WeakForm<'_>, residual: &[f64]) -> Option<Repetition> {
    let mut products = vec![(0.0, 0_usize); form.blocks];
    let (mut product, mut energy) = (0.0, 0.0);
    for (piece, fundamental) in form.dataset.fundamentals().iter().enumerate() {
        let Some((omega, _)) = fundamental.filter(|(_, periods)| *periods >= LEAST_PERIODS) else { continue };
        let rows: Vec<usize> = (0..form.rows.len()).filter(|i| form.rows[*i].piece == piece).collect();
        let at: Vec<f64> = rows.iter().map(|i| form.rows[*i].centre as f64).collect();
        let mut steps: Vec<f64> = at.windows(2).map(|w| w[1] - w[0]).collect();
        if steps.is_empty() {
            continue;
        }
        let middle = steps.len() / 2;
        let step = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
        let period = std::f64::consts::TAU / omega / form.dataset.pieces[piece].h_s;
        for (own, i) in rows.iter().enumerate() {
            let later = at[own] + period;
            let next = at.partition_point(|centre| *centre <= later);
            if next == at.len() || at[next] - at[next - 1] > NEAR * step {
                continue;
            }
            let share = (later - at[next - 1]) / (at[next] - at[next - 1]);
            let again = (1.0 - share) * residual[rows[next - 1]] + share * residual[rows[next]];
            let block = &mut products[form.rows[*i].block];
            *block = (block.0 + residual[*i] * again, block.1 + 1);
            product += residual[*i] * again;
            energy += 0.5 * (residual[*i] * residual[*i] + again * again);
        }
    }
    let blocks: Vec<f64> = products.into_iter().filter(|(_, count)| *count > 0).map(|(sum, _)| sum).collect();
    (blocks.len() >= 4 && energy > 0.0).then(|| Repetition { share: product / energy, z: z(blocks) })
}
