//! Every constant of the judge, with its unit and its source.

/// What the judge asks of a name. The defaults are those that docs/discovery.md derives and docs/machines.md was made with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Half-widths of the windows, s: from the fastest tick that resolves an electrical lag to the slowest bus.
    pub half_widths_s: [f64; 14],
    /// Fewest samples from the middle of a window to its edge: the kernels are exact on a cubic, which takes four.
    pub least_half_samples: usize,
    /// Largest share of the acceleration's rms that the sensor's noise may make.
    pub noise_share: f64,
    /// Shortest sample interval, s: faster clocks are averaged down to it.
    pub least_interval_s: f64,
    /// Rows slower than this share of the 95th percentile of the speed have no vote.
    pub slow_share: f64,
    /// Most windows: more are thinned, and overlap less.
    pub most_rows: usize,
    /// Folds of the cross-validation.
    pub folds: usize,
    /// Shortest block, s, and in half-widths of a window.
    pub block_s: f64,
    /// See `block_s`.
    pub block_half_widths: f64,
    /// Most blocks of all recordings together.
    pub most_blocks: usize,
    /// Least gain ½·ln(RSS₀/RSS₁) where the effect acts on a rough machine and on a quiet one, nats.
    pub local_gain: [f64; 2],
    /// Least gain over all rows, nats.
    pub gain: [f64; 2],
    /// Times that a name must gain what the best decoy gains, between the two.
    pub over_decoys: f64,
    /// Least z over blocks.
    pub z: f64,
    /// Least share of the acceleration that the drive determines, b_U/b_A.
    pub coherence: f64,
    /// Largest disagreement of the two sides' forces, ‖F_U − F_A‖/‖F_U‖.
    pub disagreement: f64,
    /// A rival that gains this share of the named one, and is worse by fewer standard deviations than this, is tied with it.
    pub tie: f64,
    /// See `tie`.
    pub tie_z: f64,
    /// An inconsistent rival that gains the inverse of this more makes the verdict *unknown*.
    pub rival: f64,
    /// The same of a decoy.
    pub decoy: f64,
    /// Share of the drive, predicted without a name, from which something is missing. A drive is known to about so much: a supply that
    /// is off by 2 % predicts as much.
    pub predictable: f64,
    /// Most effects named.
    pub most_names: usize,
}

impl Settings {
    /// Least z over blocks of a term that was chosen of so many. The largest of n normal numbers is about √(2·ln n); adding it in
    /// squares keeps the chance of a false name what it is without the choice.
    pub fn least_z(&self, chosen_of: f64) -> f64 {
        (self.z * self.z + 2.0 * chosen_of.max(1.0).ln()).sqrt()
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            half_widths_s: [
                0.005, 0.006, 0.007, 0.008, 0.010, 0.015, 0.020, 0.030, 0.045, 0.065, 0.100, 0.150, 0.200, 0.300,
            ],
            least_half_samples: 4,
            noise_share: 0.15,
            least_interval_s: 0.5e-3,
            slow_share: 0.02,
            most_rows: 5000,
            folds: 5,
            block_s: 0.25,
            block_half_widths: 6.0,
            most_blocks: 120,
            local_gain: [0.10, 0.02],
            gain: [0.015, 0.003],
            over_decoys: 2.0,
            z: 4.0,
            coherence: 0.3,
            disagreement: 0.3,
            tie: 0.7,
            tie_z: 2.0,
            rival: 0.85,
            decoy: 0.75,
            predictable: 0.02,
            most_names: 4,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Settings;

    /// Of a thousand lines the best needs 5.46: n·exp(−z²/2) is then exp(−4²/2), the chance of one that was not chosen.
    #[test]
    fn the_best_of_many_needs_more() {
        let settings = Settings::default();
        assert!((settings.least_z(1.0) - 4.0).abs() < 1e-12 && (settings.least_z(0.0) - 4.0).abs() < 1e-12);
        let z = settings.least_z(1000.0);
        assert!((1000.0 * (-0.5 * z * z).exp() - (-8.0_f64).exp()).abs() < 1e-12, "{z}");
    }
}
