//! The effect that docs/adding-an-effect.md adds as its example: it compiles as the page shows it, and does what the page says.

use super::eddy_brake::EddyBrake;
use super::{Instant, Law};

const PAGE: &str = include_str!("../../../../docs/adding-an-effect.md");
const FILE: &str = include_str!("../../../tests/example/eddy_brake.rs");

/// Lines of the page's block are indented by four.
#[test]
fn the_page_shows_the_file_that_is_compiled() {
    let mut page = PAGE.lines();
    assert!(page.any(|line| line == "`core/src/plant/effect/eddy_brake.rs`:"), "the page no longer names the file");
    let shown = page.skip(1).take_while(|line| line.is_empty() || line.starts_with("    "));
    let shown = shown.map(|line| line.strip_prefix("    ").unwrap_or(line));
    let mut file = FILE.lines();
    for (number, line) in shown.enumerate() {
        // The block ends with a blank line that the file has not.
        assert_eq!(line, file.next().unwrap_or_default(), "line {} of the block", number + 1);
    }
    assert_eq!(file.next(), None, "the page shows the first lines of the file only");
}

/// The drag peaks at v0 with F, and is odd in the speed.
#[test]
fn the_examples_drag_peaks_at_its_speed() {
    let force = |v: f64| EddyBrake::force(&[0.35, 4.0], &Instant { t: 0.0, x: 0.0, v, u: 0.0, over_s: 0.0 });
    assert_eq!(EddyBrake::DEFINITION.name, "eddy_brake");
    assert!((force(4.0) + 0.35).abs() < 1e-15 && (force(-4.0) - 0.35).abs() < 1e-15);
    assert!(force(2.0) > force(4.0) && force(8.0) > force(4.0) && force(0.0) == 0.0);
}
