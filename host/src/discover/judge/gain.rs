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
pub(super) struct Block {
    pub before: f64,
    pub after: f64,
    pub change: f64,
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

/// z of what the blocks save, d = Σ(r₀² − r₁²) = Σδ·(r₀ + r₁), with the term's held-out prediction δ = r₀ − r₁. A term
/// acts much in some blocks and little in others. That is no error: the errors are d − c·Σδ², with one c for all blocks.
/// The sum over its error is a t. It has as many degrees of freedom as blocks that carry δ, less one.
pub(super) fn z(blocks: &[Block]) -> f64 {
    let saved = |b: &Block| b.before - b.after;
    let [change, squares, total] = blocks.iter().fold([0.0; 3], |[change, squares, total], b| {
        [change + b.change, squares + b.change * b.change, total + saved(b)]
    });
    let carrying = change * change / squares;
    let freedom = carrying - 1.0;
    // A block alone has no error, and no term at all carries nothing.
    if freedom.is_nan() || freedom < LEAST_FREEDOM {
        return 0.0;
    }
    let scale = total / change;
    let errors: f64 = blocks.iter().map(|b| (saved(b) - scale * b.change).powi(2)).sum();
    z_of_t(total / (errors * carrying / freedom).sqrt().max(f64::MIN_POSITIVE), freedom)
}

/// Degrees of freedom below which nothing is told, so that rounding makes no freedom out of one block.
const LEAST_FREEDOM: f64 = 1e-6;

/// The normal number that is as likely as a t of so many degrees of freedom, to a hundredth (Wallace 1959, *Annals of
/// Mathematical Statistics* 30, 1124).
pub(in crate::discover) fn z_of_t(t: f64, freedom: f64) -> f64 {
    let size = (freedom * (t * t / freedom).ln_1p()).sqrt() * (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0);
    size.copysign(t)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Blocks of which so many carry the term. They save 1 each, and ±`error` in turn.
    fn blocks(carrying: usize, error: f64) -> Vec<Block> {
        let own = |i: usize| {
            let change = if i < carrying { 1.0 } else { 0.0 };
            let saved = change * if i.is_multiple_of(2) { 1.0 + error } else { 1.0 - error };
            Block { before: 5.0, after: 5.0 - saved, change }
        };
        (0..60).map(own).collect()
    }

    /// The 97.5 and 99.95 per cent of Student's t, from its tables.
    #[test]
    fn a_t_is_as_likely_as_its_z() {
        for (t, freedom, z) in [(2.201, 11.0, 1.960), (4.437, 11.0, 3.291), (2.571, 5.0, 1.960), (-2.042, 30.0, -1.960)]
        {
            assert!((z_of_t(t, freedom) - z).abs() < 0.01, "{t} {freedom}: {}", z_of_t(t, freedom));
        }
    }

    /// Twelve of 60 blocks carry a term, and save alike to a tenth: 12/√(.12·12/11) = 33 is as likely as 7.0. The mean of
    /// the 60 over its standard error would be 3.9.
    #[test]
    fn that_a_term_acts_in_some_blocks_alone_is_no_error() {
        let z = z(&blocks(12, 0.1));
        assert!((z - 6.96).abs() < 0.05, "{z}");
    }

    /// One block tells nothing, and two that agree to a hundredth tell no name.
    #[test]
    fn few_blocks_tell_little() {
        assert_eq!(z(&blocks(1, 0.0)).to_bits(), 0.0_f64.to_bits());
        let two = z(&blocks(2, 0.01));
        assert!(two > 2.0 && two < 3.0, "{two}");
        assert_eq!(z(&blocks(0, 0.0)).to_bits(), 0.0_f64.to_bits());
    }
}
