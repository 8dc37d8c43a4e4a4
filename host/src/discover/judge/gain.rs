//! What a term gains on one side, in held-out blocks.

use super::weak_form::WeakForm;

/// Gains of one side.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gain {
    /// ½·ln(RSS₀/RSS₁) over all rows, held out, nats.
    pub flat: f64,
    /// The same with every row weighted by the effect's own energy.
    pub local: f64,
    /// z over blocks, the larger of both.
    pub z: f64,
}

/// Sums of squares in every block, before and after a term: over all rows, and with every row weighted by the term's own
/// energy.
pub(super) struct Sums {
    flat: Vec<[f64; 2]>,
    local: Vec<[f64; 2]>,
}

impl Sums {
    /// The sums of the residuals `before`, times `shrink`, and `after`; `own` is the term's force.
    pub(super) fn new(
        form: &WeakForm<'_>,
        weights: &[f64],
        (before, shrink): (&[f64], f64),
        after: &[f64],
        own: &[f64],
    ) -> Self {
        let n = weights.len();
        let (mut flat, mut local) = (vec![[0.0; 2]; form.blocks], vec![[0.0; 2]; form.blocks]);
        let energy = own.iter().zip(weights).map(|(f, w)| (f * w).powi(2)).sum::<f64>() / n as f64;
        for (i, row) in form.rows.iter().enumerate() {
            let (r0, r1) = ((weights[i] * before[i] * shrink).powi(2), (weights[i] * after[i]).powi(2));
            let e = (own[i] * weights[i]).powi(2) / energy.max(f64::MIN_POSITIVE);
            flat[row.block][0] += r0;
            flat[row.block][1] += r1;
            local[row.block][0] += e * r0;
            local[row.block][1] += e * r1;
        }
        Self { flat, local }
    }

    /// The gains, with z over the differences of the blocks.
    pub(super) fn gain(&self) -> Gain {
        let total = |blocks: &[[f64; 2]], j: usize| blocks.iter().map(|b| b[j]).sum::<f64>();
        let nats = |blocks: &[[f64; 2]]| 0.5 * (total(blocks, 0) / total(blocks, 1).max(f64::MIN_POSITIVE)).ln();
        let saved = |blocks: &[[f64; 2]]| {
            let each: Vec<f64> = blocks.iter().filter(|b| b[0] > 0.0).map(|b| b[0] - b[1]).collect();
            z(&each)
        };
        let z = saved(&self.flat).max(saved(&self.local));
        Gain { flat: nats(&self.flat), local: nats(&self.local), z }
    }

    /// z over the logarithms of the shares that are left of the blocks.
    pub(super) fn z_of_shares(&self) -> f64 {
        let both = self.flat.iter().filter(|b| b[0] > 0.0 && b[1] > 0.0);
        let shares: Vec<f64> = both.map(|b| (b[0] / b[1]).ln()).collect();
        z(&shares)
    }
}

/// z of the blocks' gains: their mean over its standard error; 0 of fewer than four.
fn z(gains: &[f64]) -> f64 {
    let n = gains.len() as f64;
    if n < 4.0 {
        return 0.0;
    }
    let mean = gains.iter().sum::<f64>() / n;
    let variance = gains.iter().map(|g| (g - mean).powi(2)).sum::<f64>() / (n - 1.0);
    mean / (variance / n).sqrt().max(f64::MIN_POSITIVE)
}
