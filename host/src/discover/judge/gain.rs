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

/// Sums over a block: of the squared residual before and after a term, and of the squared change of the residual.
#[derive(Clone, Copy, Default)]
struct Block {
    before: f64,
    after: f64,
    change: f64,
}

impl Block {
    fn add(&mut self, before: f64, after: f64, weight: f64) {
        self.before += weight * before * before;
        self.after += weight * after * after;
        self.change += weight * (before - after).powi(2);
    }
}

/// The gain of a term of force `own`. The held-out residuals are `before`, times `shrink`, and `after`.
pub(super) fn gain(
    form: &WeakForm<'_>,
    weights: &[f64],
    (before, shrink): (&[f64], f64),
    after: &[f64],
    own: &[f64],
) -> Gain {
    let (mut flat, mut local) = (vec![Block::default(); form.blocks], vec![Block::default(); form.blocks]);
    let square = own.iter().zip(weights).map(|(f, w)| (f * w).powi(2)).sum::<f64>() / weights.len() as f64;
    for (i, row) in form.rows.iter().enumerate() {
        let (r0, r1) = (weights[i] * before[i] * shrink, weights[i] * after[i]);
        flat[row.block].add(r0, r1, 1.0);
        local[row.block].add(r0, r1, (own[i] * weights[i]).powi(2) / square.max(f64::MIN_POSITIVE));
    }
    Gain { flat: nats(&flat), local: nats(&local), z: z(&flat).max(z(&local)) }
}

fn nats(blocks: &[Block]) -> f64 {
    let total = |of: fn(&Block) -> f64| blocks.iter().map(of).sum::<f64>();
    0.5 * (total(|b| b.before) / total(|b| b.after).max(f64::MIN_POSITIVE)).ln()
}

/// z of what the blocks save, d = Σ(r₀² − r₁²) = Σδ·(r₀ + r₁) with the term's held-out prediction δ = r₀ − r₁. A term
/// acts much in some blocks and little in others. That is no error: the errors are d − c·Σδ², with one c for all blocks.
/// The t of the sum has as many degrees of freedom as blocks that carry δ, less one. Its probability is that of the z
/// (Wallace 1959).
fn z(blocks: &[Block]) -> f64 {
    let saved = |b: &Block| b.before - b.after;
    let [change, squares, total] = blocks.iter().fold([0.0; 3], |[change, squares, total], b| {
        [change + b.change, squares + b.change * b.change, total + saved(b)]
    });
    let carrying = change * change / squares;
    let freedom = carrying - 1.0;
    if !(freedom > 0.0) {
        return 0.0;
    }
    let scale = total / change;
    let errors: f64 = blocks.iter().map(|b| (saved(b) - scale * b.change).powi(2)).sum();
    let t = total / (errors * carrying / freedom).sqrt().max(f64::MIN_POSITIVE);
    let z = (freedom * (t * t / freedom).ln_1p()).sqrt() * (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0);
    z.copysign(t)
}
