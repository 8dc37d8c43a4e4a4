//! A frequency response: gain, phase and coherence under each other, over the logarithm of the frequency.

use super::column::Column;
use super::panel::{Entry, Panel, legend, legend_height};
use super::scale::Scale;
use super::sheet::{Sheet, through};

/// What is drawn; a value that is not finite leaves a hole.
#[derive(Clone, Copy, Debug)]
pub struct Reading<'a> {
    /// Frequencies, Hz, increasing and above 0.
    pub frequency: &'a [f64],
    /// Gain.
    pub gain: &'a [f64],
    /// Its unit.
    pub gain_unit: &'a str,
    /// Phase, degrees.
    pub phase: &'a [f64],
    /// Coherence, 0 to 1.
    pub coherence: &'a [f64],
    /// Frequencies of resonances, Hz.
    pub resonances: &'a [f64],
    /// Frequencies of antiresonances, Hz.
    pub antiresonances: &'a [f64],
}

/// Draws the three panels.
pub fn bode(width: f64, reading: &Reading<'_>) -> Sheet {
    let drawn = reading.frequency.iter().zip(reading.gain).filter(|(_, gain)| gain.is_finite()).map(|(f, _)| *f);
    let x = Scale::log_over(drawn, 1.1, 1.1);
    let panels = [
        ("gain", reading.gain_unit, reading.gain, 190.0, Scale::log_over(reading.gain.iter().copied(), 1.3, 1.3)),
        ("phase", "°", reading.phase, 150.0, Scale::over(reading.phase.iter().copied(), 0.07)),
        ("coherence", "", reading.coherence, 80.0, Scale::Linear(0.0, 1.0)),
    ];
    let kinds = [("resonance", "before", reading.resonances), ("antiresonance", "floor", reading.antiresonances)];
    let mut entries = vec![Entry { class: "after", marker: None, label: "measured" }];
    entries.extend(kinds.iter().filter(|kind| !kind.2.is_empty()).map(|(label, class, _)| Entry {
        class,
        marker: None,
        label,
    }));
    let (left, right, gap) = (66.0, 10.0, 34.0);
    let head = legend_height(&entries, width - 10.0) + 30.0;
    let heights: f64 = panels.iter().map(|panel| panel.3 + gap).sum();
    let mut sheet = Sheet::new(width, head + heights + 12.0);
    legend(&mut sheet, (2.0, 2.0), &entries, width - 10.0);
    sheet.columns.push(Column::new(("frequency", "Hz"), "", reading.frequency));
    let mut top = head;
    for (i, (quantity, unit, values, height, y)) in panels.into_iter().enumerate() {
        let panel = Panel { left, top, width: width - left - right, height, x, y };
        sheet.columns.push(Column::new((quantity, unit), "", values));
        // On a logarithmic axis each label would carry the unit, and that of a gain is long.
        let labelled = if i == 0 { (format!("{quantity} ({unit})"), "") } else { (quantity.to_owned(), unit) };
        panel.plot(&mut sheet, ("frequency", "Hz"), (&labelled.0, labelled.1), i == 2, |sheet| {
            for (_, class, frequencies) in kinds {
                for frequency in frequencies {
                    let at = panel.px(*frequency);
                    sheet.line((at, panel.top), (at, panel.bottom()), class);
                }
            }
            let points = reading.frequency.iter().zip(values).map(|(f, value)| (panel.px(*f), panel.py(*value)));
            sheet.curve(&through(points), "after", quantity);
        });
        top += height + gap;
    }
    sheet
}
