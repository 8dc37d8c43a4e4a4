//! The figure of a sine fit.

use super::figure::{Figure, Ink, Series, Strip, stack};
use crate::recording::Signal;
use crate::sine::SineFit;

/// The signal, the fitted sine, and what is left between them.
pub fn figure(signal: &Signal, fit: &SineFit) -> Figure {
    let first = signal.t.first().copied().unwrap_or(0.0);
    let phase = |t: f64| fit.omega_rad_s * (t - first) + fit.phase_start_rad;
    let sine: Vec<f64> = signal.t.iter().map(|t| fit.amplitude * phase(*t).sin() + fit.offset).collect();
    let rest: Vec<f64> = signal.y.iter().zip(&sine).map(|(y, s)| y - s).collect();
    let unit = signal.unit.as_deref().unwrap_or("");
    let strip = |quantity, height, series| Strip { quantity, unit, height, series, band: None, held: false };
    let both = vec![
        Series { ink: Ink::Measured, label: "measured", y: &signal.y },
        Series { ink: Ink::After, label: "fitted sine", y: &sine },
    ];
    let strips = [
        strip(signal.column.as_str(), 190.0, both),
        strip("measured − fitted", 120.0, vec![Series { ink: Ink::Before, label: "measured − fitted", y: &rest }]),
    ];
    let caption =
        "Above, the broad line is the measurement and the thin one the fitted sine. Below is their difference.";
    Figure::new(format!("Sine fit of {}, {}", signal.column, signal.name), caption, |width| {
        stack(width, &signal.t, &strips)
    })
}
