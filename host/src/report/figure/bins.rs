//! Binned averages with their standard errors: the residual force over a coordinate.

use super::column::Column;
use super::panel::{Entry, Panel, legend, legend_height};
use super::scale::Scale;
use super::sheet::{Sheet, through};

/// Draws `before` and `after` (centre, mean, standard error) with bands of two standard errors; axes are named by
/// (quantity, unit). An empty `after` is left out.
pub fn bins(width: f64, x_axis: (&str, &str), y_axis: (&str, &str), before: &[[f64; 3]], after: &[[f64; 3]]) -> Sheet {
    let label = if after.is_empty() { "base model (± 2 s.e.)" } else { "before: base model (± 2 s.e.)" };
    let mut entries = vec![Entry { class: "before", marker: Some(('■', "dot-before")), label }];
    if !after.is_empty() {
        entries.push(Entry {
            class: "after",
            marker: Some(('●', "dot-after")),
            label: "after: effects added (± 2 s.e.)",
        });
    }
    let head = legend_height(&entries, width - 10.0) + 30.0;
    let (left, right, height) = (52.0, 12.0, 200.0);
    let mut sheet = Sheet::new(width, head + height + 42.0);
    legend(&mut sheet, (2.0, 2.0), &entries, width - 10.0);
    let all = || before.iter().chain(after);
    let reach = |bin: &[f64; 3]| {
        let se = if bin[2].is_finite() { 2.0 * bin[2] } else { 0.0 };
        [bin[1] - se, bin[1] + se]
    };
    let panel = Panel {
        left,
        top: head,
        width: width - left - right,
        height,
        x: Scale::over(all().map(|bin| bin[0]), 0.02),
        y: Scale::over(all().flat_map(reach).chain([0.0]), 0.06),
    };
    for (name, points) in [("before", before), ("after", after)].into_iter().filter(|(_, points)| !points.is_empty()) {
        sheet.columns.extend(Column::of_points(x_axis, y_axis, name, points));
    }
    panel.plot(&mut sheet, x_axis, y_axis, true, |sheet| {
        for (curve, band, class, marker, dot) in
            [(before, "band-before", "before", '■', "dot-before"), (after, "band-after", "after", '●', "dot-after")]
        {
            let curve: Vec<[f64; 3]> =
                curve.iter().copied().filter(|bin| bin[0].is_finite() && bin[1].is_finite()).collect();
            let upper = curve.iter().map(|bin| (panel.px(bin[0]), panel.py(reach(bin)[1])));
            let lower = curve.iter().rev().map(|bin| (panel.px(bin[0]), panel.py(reach(bin)[0])));
            let outline = through(upper.chain(lower));
            if !outline.is_empty() {
                sheet.path(&format!("{outline}Z"), band);
            }
            let line = through(curve.iter().map(|bin| (panel.px(bin[0]), panel.py(bin[1]))));
            sheet.curve(&line, class, if after.is_empty() { "base model" } else { class });
            if curve.len() <= 40 && width > 500.0 {
                for bin in &curve {
                    sheet.marker((panel.px(bin[0]), panel.py(bin[1])), marker, 3.6, dot);
                }
            }
        }
    });
    sheet
}
