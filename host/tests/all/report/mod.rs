//! The report of a discovery made by hand: its text, its JSON, and that its figures are sound.

mod read_out;
mod sample;

use std::path::Path;

use breakaway::discover::outcome::{Discovery, Force, Verdict};
use breakaway::fit::Candidate;
use breakaway::report::discovery;
use breakaway::report::json::Document;
use breakaway::simulate::axis::Axis;
use breakaway::simulate::experiment::{Excitation, Experiment, Sensor};
use breakaway_core::plant::{Effect, Kind};

/// Every sample under its name. The pages are left in the target folder, for whoever wants to look at them.
fn samples() -> [(&'static str, Discovery); 2] {
    [("explained", sample::explained()), ("unknown", sample::unknown())]
}

fn html(name: &str, sample: &Discovery) -> String {
    let html = discovery::html(sample, &[]);
    std::fs::write(Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.html")), &html).unwrap();
    html
}

/// `text` without what lies between `open` and `close`.
fn without(text: &str, open: &str, close: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(start) = rest.find(open) {
        out.push_str(&rest[..start]);
        let end = rest[start..].find(close).expect("closed") + start + close.len();
        rest = &rest[end..];
    }
    out + rest
}

/// What a reader reads, a line per element; the wide drawing stands for both.
fn skeleton(html: &str) -> String {
    let text = without(&without(html, "<style>", "</style>"), "<script>", "</script>");
    let text = without(&text, "<div class=\"narrow\">", "</div>");
    let text = without(&text.replace("</t", " </t"), "<", ">");
    text.lines().map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<_>>().join("\n")
}

#[test]
fn text_of_the_pages() {
    for (name, sample) in samples() {
        insta::assert_snapshot!(format!("{name}_text"), skeleton(&html(name, &sample)));
    }
}

#[test]
fn json_of_the_discoveries() {
    for (name, mut sample) in samples() {
        for row in &mut sample.where_map {
            row.curve.truncate(2);
            row.curve_after.truncate(1);
        }
        let json = serde_json::to_string_pretty(&Document::from(&sample)).unwrap();
        insta::assert_snapshot!(format!("{name}_json"), json);
    }
}

/// An effect that is named twice, with another wave number each time, stands twice in the page and in the document.
#[test]
fn an_effect_named_twice_is_reported_twice() {
    let mut sample = sample::explained();
    let mut second = sample.effects[1].clone();
    let n = second.parameters.iter_mut().find(|p| p.symbol == "n").unwrap();
    n.value = 28.0;
    sample.effects[0] = second;
    let document = serde_json::to_value(Document::from(&sample)).unwrap();
    let waves = |i: usize| document["effects"][i]["parameters"]["n"]["value"].as_f64();
    assert_eq!((waves(0), waves(1)), (Some(28.0), Some(7.0002)));
    let page = skeleton(&html("twice", &sample));
    assert!(page.contains("28.0") && page.contains("7.000"), "{page}");
}

#[test]
fn no_page_refers_to_anything_outside() {
    for (name, sample) in samples() {
        let html = html(name, &sample);
        for reference in ["://", "src=", "href=", "url(", "@import", "<link"] {
            assert!(!html.contains(reference), "{name}: {reference}");
        }
    }
}

/// Tags are balanced, attributes quoted, and no bare `&` or `<` is left: well-formed XML.
fn assert_well_formed(svg: &str) {
    let mut open: Vec<&str> = Vec::new();
    let mut rest = svg;
    while let Some(start) = rest.find('<') {
        let text = &rest[..start];
        assert!(text.split('&').skip(1).all(|after| after.contains(';')), "bare & in {text}");
        let end = start + rest[start..].find('>').expect("tag ends");
        let tag = &rest[start + 1..end];
        rest = &rest[end + 1..];
        assert!(!tag.contains('<') && tag.matches('"').count().is_multiple_of(2), "{tag}");
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name));
        } else if !tag.ends_with('/') {
            open.push(tag.split_whitespace().next().expect("a name"));
        }
    }
    assert!(open.is_empty(), "{open:?} never closed");
}

#[test]
fn figures_are_well_formed_and_finite_and_described() {
    for (name, sample) in samples() {
        let html = html(name, &sample);
        let mut seen = 0;
        for part in html.split("<div class=\"").skip(1) {
            let Some(start) = part.find("<svg ").filter(|_| part.starts_with("wide") || part.starts_with("narrow"))
            else {
                continue;
            };
            let svg = &part[start..part.find("</div>").expect("closed")];
            assert_well_formed(svg);
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{name}: a number that is not finite");
            assert!(svg.contains("<title>") && svg.contains("<desc>") && svg.contains("role=\"img\""));
            seen += 1;
        }
        // Overlay, map, at least one curve and, where something was added, the ladder, each at two widths.
        assert!(seen >= if sample.effects.is_empty() { 6 } else { 8 } && seen % 2 == 0, "{name}: {seen} drawings");
        assert_well_formed(&discovery::ladder_figure(&sample).file());
    }
}

#[test]
fn a_parameter_without_error_is_held() {
    let html = html("explained", &sample::explained());
    assert!(html.contains("2.0000 (held)"));
    assert!(!html.contains("NaN"));
}

#[test]
fn figures_survive_data_that_are_not_numbers() {
    let mut sample = sample::explained();
    for rung in &mut sample.ladder {
        (rung.fit_rmse, rung.holdout_rmse, rung.holdout_open_loop_rmse) = (f64::NAN, f64::INFINITY, 0.0);
    }
    sample.noise_floor = 0.0;
    sample.overlays[0].before[17] = f64::NAN;
    sample.overlays[0].after.fill(f64::INFINITY);
    sample.where_map[0].curve[3] = [f64::NAN; 3];
    sample.where_map[1].curve.clear();
    sample.where_map[1].r2 = f64::NAN;
    let html = discovery::html(&sample, &[]);
    assert!(!html.contains("NaN") && !html.contains(">inf"));
}

#[test]
fn the_overlay_keeps_its_points_few_and_its_drive_square() {
    let sample = sample::explained();
    let svg = discovery::overlay_figure(&sample, &sample.overlays[0]).file();
    // Five lines of at most 2002 points; a point takes at most 14 letters.
    assert!(svg.len() < 5 * 2002 * 14 + 10_000, "{} bytes", svg.len());
    // The last such line: the first is the legend's.
    let drive = svg.lines().rfind(|line| line.starts_with("<path class=\"drive\""));
    // About 5.5 periods of four switchings each, two corners per switching.
    let corners = drive.expect("a drive").matches('L').count();
    assert!((30..60).contains(&corners), "{corners} corners");
}

/// What a force is worth in the headline: 91 % explained, 0.3 % of the drive left.
fn force() -> Force {
    Force {
        drive: [0.1, 0.03],
        acceleration: [0.1, 0.03],
        coherence: 0.99,
        half_width_s: 0.02,
        random: 0.006,
        random_share: 0.003,
        bandwidth_hz: 19.0,
        predictable: None,
    }
}

/// The first line says what was missing, how much of the unexplained force it explains (1 − 0.3² = 91 %), and what is left.
#[test]
fn the_first_line_says_what_was_missing_what_it_explains_and_what_is_left() {
    let mut sample = sample::explained();
    sample.effects.remove(0);
    sample.force = Some(force());
    // At the noise what is left is no more than that.
    let at_the_noise = discovery::sentence::sentence(&sample);
    assert_eq!(
        at_the_noise,
        "The model missed cogging (force ripple). It explains 91 % of the unexplained force. What is left is the sensor's \
         noise; as random force it is at most 0.30 % of the drive."
    );
    sample.noise_floor *= 0.5;
    let above = discovery::sentence::sentence(&sample);
    assert!(above.ends_with("What is left is random force of 0.30 % of the drive."), "{above}");
    sample.force = Some(Force { predictable: Some("lost_rows"), ..force() });
    let predictable = discovery::sentence::sentence(&sample);
    assert!(predictable.ends_with("a force of 0.30 % of the drive; lost rows predicts a part of it."), "{predictable}");
}

/// The headline and the tiles tell of one horizon: 1 s, or 0.4 s where a model could not be judged over 1 s.
#[test]
fn headline_and_tiles_have_one_horizon() {
    let mut sample = sample::explained();
    for (short, horizon, errors) in [(false, "over 1 s", "44 mrad"), (true, "over 0.4 s", "10 mrad")] {
        if short {
            sample.ladder[1].holdout_open_loop_rmse = f64::NAN;
        }
        let page = discovery::page(&sample, &[]);
        assert!(page.sentence.contains(&format!("error {horizon} falls from {errors}")), "{}", page.sentence);
        let (what, value) = &page.facts[0];
        assert_eq!(*what, format!("held-out error {horizon}"));
        assert!(value.starts_with(errors), "{value}");
    }
}

/// Two waves of one ripple have two names, and are one effect: *it* explains, where two effects do *together*.
#[test]
fn the_waves_of_a_ripple_are_one_effect() {
    let mut sample = sample::explained();
    sample.effects.truncate(1);
    sample.effects.push(sample.effects[0].clone());
    let one = discovery::sentence::sentence(&sample);
    assert!(one.contains(". With it the held-out"), "{one}");
    sample.effects[1].kind = Kind::Spring;
    let two = discovery::sentence::sentence(&sample);
    assert!(two.contains(" and spring or cable. With them the held-out"), "{two}");
}

/// Behind teeth the simulated error may grow with the right effect. The headline says so.
#[test]
fn an_error_that_grows_does_not_fall() {
    let mut sample = sample::explained();
    sample.ladder.reverse();
    let sentence = discovery::sentence::sentence(&sample);
    assert!(sentence.contains("rises from") && !sentence.contains("falls"), "{sentence}");
}

/// Much that is left, and that nothing predicts, is not called random where the verdict is *partly explained*.
#[test]
fn much_that_is_left_is_not_called_random() {
    let force = Force {
        drive: [0.8, 0.25],
        acceleration: [1.0, 0.7],
        coherence: 0.4,
        half_width_s: 0.03,
        random: 0.7,
        random_share: 0.24,
        bandwidth_hz: 3.0,
        predictable: None,
    };
    let mut sample = sample::explained();
    (sample.force, sample.verdict, sample.noise_floor) = (Some(force), Verdict::PartlyExplained, 1e-5);
    let partly = discovery::sentence::sentence(&sample);
    assert!(partly.ends_with("a force of 24 % of the drive; nothing that was tried predicts it."), "{partly}");
    sample.verdict = Verdict::Explained;
    let random = discovery::sentence::sentence(&sample);
    assert!(random.ends_with("What is left is random force of 24 % of the drive."), "{random}");
}

/// An unknown whose best coordinate predicts 1 % says that none does, and names no place.
#[test]
fn an_unknown_that_no_coordinate_predicts_says_so() {
    let mut sample = sample::unknown();
    assert!(discovery::sentence::sentence(&sample).ends_with("The coordinate position predicts 63 % of it."));
    sample.where_map[0].r2 = 0.01;
    let html = html("unpredicted", &sample);
    let page = skeleton(&html);
    assert!(page.contains("No coordinate predicts it."), "{page}");
    assert!(page.contains("the best of them, position, predicts 1 %, which is no more than chance."), "{page}");
    assert!(page.contains("base model") && !page.contains("before: base model"), "{page}");
    assert!(!page.contains("The coordinate position") && !page.contains("Unexplained force over"), "{page}");
}

/// Δ, z, λ and nats stand inside the fold-out alone.
#[test]
fn statistics_are_folded_away() {
    for (name, sample) in samples() {
        let page = skeleton(&without(&html(name, &sample), "<details>", "</details>"));
        for word in ["Δ", "λ", "nats", " z "] {
            assert!(!page.contains(word), "{name}: {word}");
        }
    }
}

/// Cogging of 0.2 V and seven waves per radian, simulated with an encoder of 1 mrad: folded, the measured force lies on the
/// law. 95 of 100 means lie within two standard errors of it; four, and 3 % of the amplitude for the average over a window
/// (`fold.rs`), hold for all.
#[test]
fn a_folded_force_lies_on_its_law() {
    let mut sample = sample::explained();
    let cogging = Effect::new(Kind::Cogging, &[0.2, 7.0, 0.5]);
    let base = sample.ladder[0].base;
    sample.effects.remove(0);
    sample.model = Candidate { base, effects: vec![cogging] };
    // Some hundred windows fill all 24 bins; what is too few for them is in 12. The law changes by 0.1 V over each of
    // these. Three windows at its ends have a standard error of 0.035 V, and the noise adds to it.
    for (duration_s, bins, largest_se) in [(20.0, 24, 0.02), (1.2, 12, 0.06)] {
        let experiment = Experiment {
            name: "sine".into(),
            tick_s: 1e-3,
            duration_s,
            seed: 7,
            drive_limit: f64::INFINITY,
            travel_limit: f64::INFINITY,
            excitation: Excitation::Sine { amplitude: 2.0, frequency_hz: 0.3, centring: 0.0 },
            sensor: Sensor { encoder_step: 1e-3, ..Sensor::default() },
        };
        let recording = Axis::new(base, &[cogging], sample.units.clone()).run(&experiment).unwrap().recording;
        let folds = discovery::folds(&[recording], &sample);
        let [fold] = folds.as_slice() else { panic!("{folds:?}") };
        assert_eq!((fold.kind, fold.coordinate, fold.points.len()), (Kind::Cogging, "position", bins));
        assert!((fold.period - std::f64::consts::TAU / 7.0).abs() < 1e-12);
        for [x, mean, se] in &fold.points {
            let law = 0.2 * (7.0 * x + 0.5).sin();
            assert!((mean - law).abs() < 4.0 * se + 0.03 * 0.2, "{x}: {mean} ± {se}, {law}");
            assert!(*se < largest_se, "{x}: {se}");
        }
        let page = discovery::html(&sample, &folds);
        assert!(page.contains("Cogging (force ripple) over one period") && page.contains("fitted law"));
    }
}
