//! The tables of a discovery.

use std::fmt::Write as _;

use super::sentence::within_a_sentence;
use crate::discover::outcome::{Discovery, NamedEffect};
use crate::report::page::table;
use crate::report::text::{escape, number, quantity, with_error};

/// The ladder in numbers.
pub(super) fn ladder(discovery: &Discovery) -> String {
    let unit = &discovery.units.x;
    let rows: Vec<_> = discovery
        .ladder
        .iter()
        .enumerate()
        .map(|(i, rung)| {
            let name = match rung.effects.last() {
                Some(kind) if i > 0 => format!("+ {}", kind.definition().title),
                _ => "base model".to_owned(),
            };
            let errors = [rung.holdout_open_loop_rmse, rung.holdout_rmse, rung.fit_rmse];
            let mut cells = vec![escape(&name)];
            cells.extend(errors.map(|error| escape(&quantity(error, unit, 3))));
            (false, cells)
        })
        .collect();
    table(&[("model", ""), ("held-out, 1 s", "n"), ("held-out, 0.4 s", "n"), ("fitted, 0.4 s", "n")], &rows)
}

/// Each added effect: law, what shows it, and what else it could be.
pub(super) fn effects(discovery: &Discovery) -> String {
    discovery.effects.iter().map(effect).collect()
}

fn effect(effect: &NamedEffect) -> String {
    let definition = effect.kind.definition();
    let titles = |tied: bool| -> Vec<&str> {
        effect.rivals.iter().filter(|rival| rival.tied == tied).map(|rival| rival.kind.definition().title).collect()
    };
    let rivals = match (titles(true).as_slice(), titles(false).as_slice()) {
        ([], []) => "No other effect came near.".to_owned(),
        ([], lost) => format!("Its simulation is better than that of the next best: {}.", lost.join(", ")),
        (tied, []) => format!("These recordings cannot tell it from {}.", tied.join(" or ")),
        (tied, lost) => format!(
            "These recordings cannot tell it from {}. Its simulation is better than that of {}.",
            tied.join(" or "),
            lost.join(", ")
        ),
    };
    format!(
        "<h3>{} <code>{}</code></h3>\n<p class=\"law\">{}</p>\n<p class=\"note\">Shown by: {}.{}</p>\n<p>{}</p>\n",
        escape(definition.title),
        escape(definition.name),
        escape(definition.law),
        escape(definition.shown_by),
        definition.compensation.map_or_else(
            || " A controller cannot compensate it.".to_owned(),
            |how| format!(" Compensated by {}.", escape(how))
        ),
        escape(&rivals),
    )
}

/// The numbers by which effects were compared, folded away: who needs them knows what they are.
pub(super) fn comparison(discovery: &Discovery) -> String {
    let mut out = String::new();
    for effect in discovery.effects.iter().filter(|effect| !effect.rivals.is_empty()) {
        let rows: Vec<_> = effect
            .rivals
            .iter()
            .map(|rival| {
                let title = escape(rival.kind.definition().title);
                let fate = if rival.tied { "tied" } else { "lost" };
                (rival.tied, vec![title, number(rival.delta, 2), number(rival.z, 2), fate.to_owned()])
            })
            .collect();
        let columns = [("rival", ""), ("Δ", "n"), ("z", "n"), ("", "w")];
        let title = escape(effect.kind.definition().title);
        // Writing to a String cannot fail.
        let _ = writeln!(out, "<h3>Rivals of {title}</h3>\n{}", table(&columns, &rows));
    }
    if let Some(nearest) = &discovery.nearest {
        let _ = writeln!(out, "<p>{}</p>", escape(nearest));
    }
    if !discovery.candidates.is_empty() {
        let _ = writeln!(out, "<h3>First round</h3>\n{}", candidates(discovery));
    }
    if out.is_empty() {
        return out;
    }
    format!(
        "<details>\n<summary>Numbers of every effect that was tried</summary>\n<p class=\"note\">Δ is the mean gain \
         in log(noise² + error²) over the model to compare with. z is Δ over its standard error, and λ is the \
         logarithm of the likelihood ratio. All three are in nats or without unit; docs/discovery.md defines \
         them.</p>\n\
         {out}</details>\n"
    )
}

/// The candidates of the first round.
fn candidates(discovery: &Discovery) -> String {
    let rows: Vec<_> = discovery
        .candidates
        .iter()
        .map(|candidate| {
            let named = discovery.effects.first().is_some_and(|effect| effect.kind == candidate.kind);
            let numbers = [(candidate.delta, 2), (candidate.z, 2), (candidate.lambda, 3)];
            let mut cells = vec![escape(candidate.kind.definition().title)];
            cells.extend(numbers.map(|(value, digits)| number(value, digits)));
            cells.push(escape(&candidate.fate));
            (named, cells)
        })
        .collect();
    table(&[("effect", ""), ("Δ", "n"), ("z", "n"), ("λ", "n"), ("what became of it", "w")], &rows)
}

/// The model's equation, and its parameters before and after.
pub(super) fn model(discovery: &Discovery) -> String {
    let (Some(first), Some(last)) = (discovery.ladder.first(), discovery.ladder.last()) else { return String::new() };
    let units = &discovery.units;
    let changed = discovery.ladder.len() > 1;
    let base = [
        ("b", "inertia over motor gain", first.base.b, last.base.b, units.of_b()),
        ("c", "viscous friction and back-EMF", first.base.c, last.base.c, units.of_c()),
        ("f1", "Coulomb friction", first.base.f1, last.base.f1, units.of_f1()),
    ];
    let row = |symbol: &str, before: String, after: String, unit: &str, meaning: &str| {
        let mut cells = vec![format!("<i>{}</i>", escape(symbol))];
        if changed {
            cells.push(escape(&before));
        }
        let unit = if unit == "1" { "" } else { unit };
        cells.extend([escape(&after), escape(unit), escape(meaning)]);
        (false, cells)
    };
    let mut rows: Vec<_> = base
        .into_iter()
        .zip(discovery.base_se)
        .map(|((symbol, meaning, before, after, unit), se)| {
            let now =
                if se.is_finite() { with_error(after, se) } else { format!("{} (error not told)", number(after, 4)) };
            row(symbol, number(before, 4), now, &unit, meaning)
        })
        .collect();
    for effect in &discovery.effects {
        let title = within_a_sentence(effect.kind.definition().title);
        rows.extend(effect.parameters.iter().map(|p| {
            let meaning = format!("{title}: {}", p.meaning);
            row(p.symbol, "–".to_owned(), with_error(p.value, p.se), &p.unit, &meaning)
        }));
    }
    let mut columns = vec![("", "")];
    if changed {
        columns.push(("base model", "q"));
    }
    columns.push((if changed { "improved model ± standard error" } else { "value ± standard error" }, "q"));
    columns.extend([("unit", ""), ("what it is", "w")]);
    let mut names: Vec<&str> = discovery.model.effects.iter().map(|effect| effect.kind.name()).collect();
    if names.is_empty() {
        names = discovery.effects.iter().map(|effect| effect.kind.name()).collect();
    }
    let effects = names.iter().fold(String::new(), |sum, name| sum + " + " + name);
    format!("<p class=\"law\">b·ẍ + c·ẋ + f1·sgn ẋ = u{}</p>\n{}", escape(&effects), table(&columns, &rows))
}

/// Inputs, version, command.
pub(super) fn provenance(discovery: &Discovery) -> String {
    let from = &discovery.provenance;
    let (fitted, all) = discovery.segments;
    let mut out = format!("<p>{fitted} of {all} segments of the recordings were simulated.</p>\n");
    if !from.command.is_empty() {
        // Writing to a String cannot fail.
        let _ = writeln!(out, "<pre>{}</pre>", escape(&from.command));
    }
    if !from.version.is_empty() {
        let _ = writeln!(out, "<p>breakaway {}</p>", escape(&from.version));
    }
    if !from.inputs.is_empty() {
        let cell = |hash: &str| format!("<code class=\"hash\">{}</code>", escape(hash));
        let rows: Vec<_> = from.inputs.iter().map(|(file, hash)| (false, vec![escape(file), cell(hash)])).collect();
        out.push_str(&table(&[("recording", ""), ("SHA-256", "")], &rows));
    }
    out
}
