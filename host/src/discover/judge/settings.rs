//! Every constant of the judge, with its unit and its source.

/// The judge's thresholds. docs/discovery.md derives the defaults, and docs/machines.md was made with them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Half-widths of the windows, s. The narrowest resolves an electrical lag; the widest suits the slowest bus.
    pub half_widths_s: [f64; 14],
    /// Fewest samples from the middle of a window to its edge. The kernels are exact on a cubic, which takes four.
    pub least_half_samples: usize,
    /// Largest share of the acceleration's rms that the sensor's noise may make.
    pub noise_share: f64,
    /// Shortest sample interval, s. Samples of a faster clock are averaged.
    pub least_interval_s: f64,
    /// Most samples. Of more than that stretches are taken. The judge needs 7 kB for each on two cores (docs/scale.md), and the
    /// whole may need 1 GB.
    pub most_samples: usize,
    /// Least speed of a window, as a share of the 95th percentile of the speed. Slower windows are left out.
    pub slow_share: f64,
    /// Most windows. Where there are more, they are thinned and overlap less.
    pub most_rows: usize,
    /// Folds of the cross-validation.
    pub folds: usize,
    /// Shortest block, s, and in half-widths of a window.
    pub block_s: f64,
    /// See `block_s`.
    pub block_half_widths: f64,
    /// Most blocks of all recordings together.
    pub most_blocks: usize,
    /// Least gain ½·ln(RSS₀/RSS₁) where the effect acts, nats: on a rough machine, and on a quiet one.
    pub local_gain: [f64; 2],
    /// Least gain over all rows, nats: on a rough machine, and on a quiet one.
    pub gain: [f64; 2],
    /// Multiple of the best decoy's gain that a name must reach, between the two.
    pub over_decoys: f64,
    /// Least z over blocks.
    pub z: f64,
    /// Least share of the acceleration that the drive determines, b_U/b_A.
    pub coherence: f64,
    /// Largest disagreement of the two sides' forces, ‖F_U − F_A‖/‖F_U‖.
    pub disagreement: f64,
    /// Least share of the named effect's gain at which a rival may be tied with it.
    pub tie: f64,
    /// Standard deviations below which the named effect's lead leaves a rival tied.
    pub tie_z: f64,
    /// An inconsistent rival makes the verdict *unknown* where this share of its gain is more than the named effect's.
    pub rival: f64,
    /// The same share for a decoy.
    pub decoy: f64,
    /// Multiple of a damped mode's gain that a coupling must reach. A body that rings loses its gain where it is damped.
    pub over_damped: f64,
    /// Share of the drive, predicted without a name, from which something is missing. A drive is known to about 2 %: a
    /// supply that is off by so much predicts as much.
    pub predictable: f64,
    /// Most effects named.
    pub most_names: usize,
}

impl Settings {
    /// Least z over blocks of a term that was chosen of so many. The largest of n normal numbers is about √(2·ln n). It
    /// is added in squares, so that the chance of a false name is that of a term without choice.
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
            most_samples: 100_000,
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
            over_damped: 2.0,
            predictable: 0.02,
            most_names: 4,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Settings;

    /// The best of a thousand lines needs a z of 5.46. There n·exp(−z²/2) is exp(−4²/2), the chance of a term that was
    /// not chosen.
    #[test]
    fn the_best_of_many_needs_more() {
        let settings = Settings::default();
        assert!((settings.least_z(1.0) - 4.0).abs() < 1e-12 && (settings.least_z(0.0) - 4.0).abs() < 1e-12);
        let z = settings.least_z(1000.0);
        assert!((1000.0 * (-0.5 * z * z).exp() - (-8.0_f64).exp()).abs() < 1e-12, "{z}");
    }
}
