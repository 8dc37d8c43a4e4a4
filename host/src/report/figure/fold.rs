//! One period of a force over position: the measured means with their errors, and the fitted law.

use super::column::Column;
use super::panel::{Entry, Panel, legend, legend_height};
use super::scale::Scale;
use super::sheet::{Sheet, through};

/// Draws `points` (position, mean, standard error) with bars of two standard errors, and the `law` (position, force) over
/// them; axes are named by (quantity, unit).
pub fn fold(width: f64, x_axis: (&str, &str), y_axis: (&str, &str), points: &[[f64; 3]], law: &[[f64; 2]]) -> Sheet {
    let entries = [
        Entry { class: "error-before", marker: Some(('■', "dot-before")), label: "measured force (± 2 s.e.)" },
        Entry { class: "after", marker: None, label: "fitted law" },
    ];
    let head = legend_height(&entries, width - 10.0) + 30.0;
    let (left, right, height) = (52.0, 12.0, 200.0);
    let mut sheet = Sheet::new(width, head + height + 42.0);
    legend(&mut sheet, (2.0, 2.0), &entries, width - 10.0);
    let reach = |point: &[f64; 3]| {
        let se = if point[2].is_finite() { 2.0 * point[2] } else { 0.0 };
        [point[1] - se, point[1] + se]
    };
    let last = law.last().map_or(0.0, |point| point[0]);
    let panel = Panel {
        left,
        top: head,
        width: width - left - right,
        height,
        x: Scale::over([0.0, last], 0.0),
        y: Scale::over(points.iter().flat_map(reach).chain(law.iter().map(|p| p[1])).chain([0.0]), 0.06),
    };
    sheet.columns.extend(Column::of_points(x_axis, y_axis, "measured", points));
    let part = |i: usize| law.iter().map(|point| point[i]).collect::<Vec<_>>();
    sheet.columns.push(Column::new(x_axis, "fitted law", &part(0)));
    sheet.columns.push(Column::new(y_axis, "fitted law", &part(1)));
    panel.plot(&mut sheet, x_axis, y_axis, true, |sheet| {
        let curve = through(law.iter().map(|point| (panel.px(point[0]), panel.py(point[1]))));
        sheet.curve(&curve, "after", "fitted law");
        // Under the marks, for the page's script: their values between them are those of a straight line.
        let means = through(points.iter().map(|point| (panel.px(point[0]), panel.py(point[1]))));
        sheet.curve(&means, "unseen", "measured force");
        for point in points.iter().filter(|point| point[1].is_finite()) {
            let (x, [low, high]) = (panel.px(point[0]), reach(point));
            sheet.marker((x, panel.py(point[1])), '■', 3.6, "dot-before");
            // Over the mark: its edge of paper would cut a short bar into two.
            sheet.line((x, panel.py(low)), (x, panel.py(high)), "error-before");
        }
    });
    sheet
}
