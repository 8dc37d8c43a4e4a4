//! The page of a discovery (docs/discovery.md, section 10).

mod figures;
mod fold;
mod horizon;
pub mod sentence;
mod tables;

use std::fmt::Write as _;

pub use figures::{ladder_figure, overlay_figure};
pub use fold::{Fold, folds};

use super::figure::Figure;
use super::page::{Page, Section, list};
use super::text::{escape, number, quantity};
use crate::discover::outcome::{Discovery, NextExperiment, Rung, Verdict, WhereRow};
use horizon::Horizon;

/// Overlays that are shown; more of them say nothing new.
const MOST_OVERLAYS: usize = 4;
/// Coordinates whose curves are shown.
const MOST_CURVES: usize = 3;

/// The report of a discovery as one file; `folds` are those of its named effects ([`folds`](folds())).
pub fn html(discovery: &Discovery, folds: &[Fold]) -> String {
    page(discovery, folds).html()
}

/// The report of a discovery.
pub fn page(discovery: &Discovery, folds: &[Fold]) -> Page {
    let (badge, badge_class) = badge(discovery.verdict);
    Page {
        title: "Breakaway discovery".into(),
        badge: badge.into(),
        badge_class,
        sentence: sentence::sentence(discovery),
        facts: facts(discovery),
        lead: lead(discovery),
        sections: sections(discovery, folds),
    }
}

/// What comes under the lead.
fn sections(discovery: &Discovery, folds: &[Fold]) -> Vec<Section> {
    let mut sections = Vec::new();
    let mut add = |heading: &str, body: String| {
        if !body.is_empty() {
            sections.push(Section::new(heading, body));
        }
    };
    add("Where the gap is", where_it_is(discovery, folds));
    add("What was added, and what else it could be", tables::effects(discovery));
    add("What the data cannot tell", cannot_tell(discovery));
    add("The experiment that would decide", discovery.next_experiment.as_ref().map_or_else(String::new, next));
    let more = discovery.overlays.iter().skip(1).take(MOST_OVERLAYS - 1);
    add("More held-out recordings", more.map(|overlay| overlay_figure(discovery, overlay).html()).collect());
    add("How the effects were compared", tables::comparison(discovery));
    add("Provenance", tables::provenance(discovery));
    sections
}

const fn badge(verdict: Verdict) -> (&'static str, &'static str) {
    match verdict {
        Verdict::Explained => ("✓ explained", "good"),
        Verdict::PartlyExplained => ("◐ partly explained", "part"),
        Verdict::Unknown => ("? unknown", "open"),
        Verdict::NothingMissing => ("= nothing missing", "good"),
    }
}

/// First and last rung, if there are two.
fn ends(discovery: &Discovery) -> Option<(&Rung, &Rung)> {
    match discovery.ladder.as_slice() {
        [first, .., last] => Some((first, last)),
        _ => None,
    }
}

fn facts(discovery: &Discovery) -> Vec<(String, String)> {
    let unit = &discovery.units.x;
    let horizon = Horizon::of(discovery);
    let error = format!("held-out error {}", horizon.words());
    let mut facts = Vec::new();
    let mut fact = |what: &str, value: String| facts.push((what.to_owned(), value));
    if let Some((first, last)) = ends(discovery) {
        let [before, after] = [first, last].map(|rung| horizon.error(rung));
        fact(&error, format!("{} → {}", quantity(before, unit, 2), quantity(after, unit, 2)));
        if after < before {
            fact("smaller by", format!("{} ×", number(before / after, 2)));
        }
    } else if let Some(base) = discovery.ladder.first() {
        fact(&error, quantity(horizon.error(base), unit, 2));
    }
    fact("position noise", quantity(discovery.noise_floor, unit, 2));
    if let Some(force) = discovery.force {
        let left = quantity(force.random, &discovery.units.u, 2);
        fact("force left", format!("{left} below {} Hz", number(force.bandwidth_hz, 2)));
    }
    fact("recordings", discovery.provenance.inputs.len().to_string());
    fact("time taken", quantity(discovery.seconds, "s", 2));
    facts
}

fn lead(discovery: &Discovery) -> String {
    let mut out = tables::model(discovery);
    // Of one model the table says it all.
    if discovery.ladder.len() > 1 {
        out.push_str(&ladder_figure(discovery).html());
    }
    if let Some(overlay) = discovery.overlays.first() {
        out.push_str(&overlay_figure(discovery, overlay).html());
    }
    if !discovery.ladder.is_empty() {
        out.push_str(&tables::ladder(discovery));
    }
    out
}

fn where_it_is(discovery: &Discovery, folds: &[Fold]) -> String {
    if discovery.where_map.is_empty() {
        return String::new();
    }
    let mut out = String::from(
        "<p>The force that the base model leaves unexplained is averaged over one coordinate at a time. The share of it \
         that such averages predict on data they were not taken from says where the missing effect acts.</p>\n",
    );
    if discovery.effects.is_empty() && sentence::place(discovery).is_none() {
        let _ = writeln!(
            out,
            "<p>Here no coordinate predicts it: the best of them, {}, predicts {:.0} %, which is no more than chance.</p>",
            escape(discovery.where_map[0].coordinate),
            100.0 * discovery.where_map[0].r2.max(0.0)
        );
    }
    out.push_str(&figures::map_figure(discovery).html());
    for fold in folds {
        out.push_str(&figures::fold_figure(discovery, fold).html());
    }
    for row in curves(discovery, folds) {
        out.push_str(&figures::curve_figure(discovery, row).html());
    }
    out
}

/// The coordinates whose curves are shown.
fn curves<'a>(discovery: &'a Discovery, folds: &[Fold]) -> impl Iterator<Item = &'a WhereRow> {
    // Averages over the whole travel blur what repeats along it; the fold has it.
    let blurred = move |row: &WhereRow| folds.iter().any(|fold| fold.coordinate == row.coordinate);
    let tells = move |row: &&WhereRow| !row.curve.is_empty() && !blurred(row) && row.r2 >= sentence::PREDICTS;
    discovery.where_map.iter().filter(tells).take(MOST_CURVES)
}

/// Every figure of the page: the ladder, the overlays, where the gap is.
pub fn all_figures(discovery: &Discovery, folds: &[Fold]) -> Vec<Figure> {
    let ladder = (discovery.ladder.len() > 1).then(|| ladder_figure(discovery));
    let overlays = discovery.overlays.iter().take(MOST_OVERLAYS).map(|overlay| overlay_figure(discovery, overlay));
    let map = (!discovery.where_map.is_empty()).then(|| figures::map_figure(discovery));
    // As on the page, folds and curves go with the map.
    let folded = folds.iter().filter(|_| map.is_some()).map(|fold| figures::fold_figure(discovery, fold));
    let curves = curves(discovery, folds).map(|row| figures::curve_figure(discovery, row));
    ladder.into_iter().chain(overlays).chain(map.clone()).chain(folded).chain(curves).collect()
}

fn cannot_tell(discovery: &Discovery) -> String {
    let mut items = Vec::new();
    for effect in &discovery.effects {
        let tied = effect.rivals.iter().filter(|rival| rival.tied);
        let names: Vec<&str> = tied.map(|rival| rival.kind.definition().title).collect();
        if !names.is_empty() {
            items.push(format!(
                "{} or {}: these recordings cannot tell. The first was added to the model.",
                effect.kind.definition().title,
                names.join(" or ")
            ));
        }
    }
    // Which effect came closest is said in numbers, where the effects are compared.
    items.extend(discovery.remarks.iter().filter(|remark| Some(*remark) != discovery.nearest.as_ref()).cloned());
    if items.is_empty() { String::new() } else { list(&items) }
}

fn next(next: &NextExperiment) -> String {
    let names: Vec<&str> = next.separates.iter().map(|kind| kind.definition().title).collect();
    let what = if names.is_empty() { "the models".to_owned() } else { names.join(" from ") };
    let mut out = format!(
        "<p>It tells {} by a predicted difference of {} times the noise.</p>\n",
        escape(&what),
        number(next.difference_over_noise, 2)
    );
    // Writing to a String cannot fail; a seed beyond TOML's integers is the only thing that cannot be written.
    if let Ok(file) = toml::to_string(&next.experiment) {
        let _ = writeln!(
            out,
            "<p>Save this as <code>{name}.toml</code> and run <code>breakaway run {name}.toml -o next</code>:</p>\n<pre>{}</pre>",
            escape(file.trim_end()),
            name = escape(&next.experiment.name)
        );
    }
    out
}
