//! What the page's script reads: every figure has its axes and its curves in it, and the values come back from the drawing.

use breakaway::report::discovery;
use serde_json::Value;

use super::{html, samples, without};

/// The value of an attribute, as HTML has it.
fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    let start = tag.find(&format!(" {name}=\""))? + name.len() + 3;
    tag[start..].split('"').next()
}

/// An axis of a plot: kind, ends, unit, quantity.
fn axis(tag: &str, name: &str) -> Value {
    let text = attribute(tag, name).unwrap_or_else(|| panic!("{name} in {tag}"));
    serde_json::from_str(&text.replace("&quot;", "\"").replace("&#39;", "'").replace("&amp;", "&")).unwrap()
}

/// The plots of a drawing: the tag that opens each, and what is in it.
fn plots(svg: &str) -> Vec<(&str, &str)> {
    let parts = svg.split("<svg class=\"plot\"").skip(1);
    parts
        .map(|part| part.split_once('>').map(|(tag, rest)| (tag, rest.split("</svg>").next().unwrap())).unwrap())
        .collect()
}

/// The points of a path, pixels.
fn points(d: &str) -> Vec<[f64; 2]> {
    let numbers = |point: &str| -> Vec<f64> { point.split(' ').map(|number| number.parse().unwrap()).collect() };
    d.split(['M', 'L'])
        .filter(|point| !point.is_empty())
        .map(|point| <[f64; 2]>::try_from(numbers(point)).unwrap())
        .collect()
}

/// The page has one script, of our own. Its policy names that one by its hash, and allows nothing from outside.
#[test]
fn the_script_is_ours_and_asks_for_nothing() {
    for (name, sample) in samples() {
        let html = html(name, &sample);
        let script = html.split("<script>").nth(1).and_then(|rest| rest.split("</script>").next()).unwrap();
        assert_eq!(html.matches("<script").count(), 1, "{name}");
        assert!(html.contains("default-src 'none'; style-src 'unsafe-inline'; script-src 'sha256-"), "{name}");
        for word in ["fetch(", "XMLHttpRequest", "WebSocket", "import", "eval", "localStorage", "cookie", "://"] {
            assert!(!script.contains(word), "{word}");
        }
        // Without it the page is what it was: all text, all drawings.
        let plain = without(&html, "<script>", "</script>");
        assert!(plain.contains("</svg>") && !plain.contains("onclick") && !plain.contains("javascript:"), "{name}");
    }
}

/// Every panel of every figure says what its edges are, and has a curve under a name. Bars have their numbers printed beside
/// them, and no panel.
#[test]
fn every_panel_carries_its_axes_and_its_curves() {
    for (name, sample) in samples() {
        let html = html(name, &sample);
        let figures: Vec<&str> =
            html.split("<figure>").skip(1).map(|part| part.split("</figure>").next().unwrap()).collect();
        let mut bars = 0;
        for figure in figures {
            let panels = plots(figure);
            bars += usize::from(panels.is_empty() && figure.contains("bar-before"));
            assert!(!panels.is_empty() || figure.contains("bar-before"), "{name}: a figure without a panel");
            for (tag, inside) in panels {
                let (x, y) = (axis(tag, "data-x"), axis(tag, "data-y"));
                assert!(["linear", "log", "words"].contains(&x[0].as_str().unwrap()), "{name}: {x}");
                if x[0] != "words" {
                    assert!(
                        x[2].as_f64().unwrap() > x[1].as_f64().unwrap() && !x[4].as_str().unwrap().is_empty(),
                        "{x}"
                    );
                }
                assert!(y[2].as_f64().unwrap() > y[1].as_f64().unwrap() && !y[4].as_str().unwrap().is_empty(), "{y}");
                assert!(inside.contains(" data-label=\""), "{name}: a panel without a curve: {tag}");
            }
        }
        assert_eq!(bars, 1, "{name}");
    }
}

/// The measured position read back from the drawing is that of the sample. A point is drawn to a hundredth of a pixel, half
/// of it either way: of 738 pixels for the time and of 190 for the position.
#[test]
fn values_come_back_from_the_drawing() {
    let sample = super::sample::explained();
    let overlay = &sample.overlays[0];
    let svg = discovery::overlay_figure(&sample, overlay).file();
    let (tag, inside) = plots(&svg)[0];
    let number = |name: &str| attribute(tag, name).unwrap().parse::<f64>().unwrap();
    let (x, y) = (axis(tag, "data-x"), axis(tag, "data-y"));
    let span = |axis: &Value| [1, 2].map(|end| axis[end].as_f64().unwrap());
    assert_eq!((x[3].as_str(), x[4].as_str()), (Some("s"), Some("time")));
    let factor = match y[3].as_str().unwrap() {
        "rad" => 1.0,
        "mrad" => 1e-3,
        other => panic!("{other}"),
    };
    // The clip is two pixels higher than the panel on both sides.
    let (left, width, bottom, height) =
        (number("x"), number("width"), number("y") + number("height") - 2.0, number("height") - 4.0);
    let curve = inside.lines().find(|line| line.contains(" data-label=\"measured\"")).unwrap();
    let drawn = points(attribute(curve, "d").unwrap());
    assert!(drawn.len() > 100, "{}", drawn.len());
    let ([t0, t1], [low, high]) = (span(&x), span(&y));
    for [px, py] in drawn {
        let t = t0 + (px - left) / width * (t1 - t0);
        let position = factor * (low + (bottom - py) / height * (high - low));
        let k = (0..overlay.t.len())
            .min_by(|a, b| (overlay.t[*a] - t).abs().total_cmp(&(overlay.t[*b] - t).abs()))
            .unwrap();
        assert!((overlay.t[k] - t).abs() < 0.006 / width * (t1 - t0), "{t}");
        assert!((overlay.measured[k] - position).abs() < 0.006 / height * (high - low) * factor, "{t}: {position}");
    }
}

/// The table of a figure has the numbers themselves, under names with units.
#[test]
fn the_table_has_the_numbers_of_the_figure() {
    let sample = super::sample::explained();
    let overlay = &sample.overlays[0];
    let csv = discovery::overlay_figure(&sample, overlay).csv();
    let mut lines = csv.lines();
    assert!(lines.next().unwrap().starts_with("# figure by breakaway: Measured and simulated, "));
    let header = "time (s),position: measured (rad),position: before: base model (rad),\
                  position: after: effects added (rad),measured − simulated: before: base model (rad),\
                  measured − simulated: after: effects added (rad),drive (V)";
    assert_eq!(lines.next().unwrap(), header);
    for (k, line) in lines.enumerate() {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let expected = [overlay.t[k], overlay.measured[k], overlay.before[k], overlay.after[k]];
        assert_eq!(&cells[..4], &expected, "row {k}");
        assert_eq!((cells[4], cells[6]), (overlay.measured[k] - overlay.before[k], overlay.u[k]), "row {k}");
    }
    let ladder = discovery::ladder_figure(&sample).csv();
    assert!(ladder.contains("effects added,") && ladder.lines().count() == 2 + sample.ladder.len(), "{ladder}");
}
