//! The tables of a discovery.

use std::fmt::Write as _;

use crate::discover::outcome::{Discovery, NamedEffect, ParameterValue};
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

/// Each added effect: law, parameters, rivals.
pub(super) fn effects(discovery: &Discovery) -> String {
    discovery.effects.iter().map(effect).collect()
}

fn effect(effect: &NamedEffect) -> String {
    let definition = effect.kind.definition();
    let mut out = format!(
        "<h3>{} <code>{}</code></h3>\n<p class=\"law\">{}</p>\n<p class=\"note\">Shown by: {}.{}</p>\n",
        escape(definition.title),
        escape(definition.name),
        escape(definition.law),
        escape(definition.shown_by),
        definition.compensation.map_or_else(
            || " A controller cannot compensate it.".to_owned(),
            |how| format!(" Compensated by {}.", escape(how))
        ),
    );
    out.push_str(&parameters(&effect.parameters));
    if effect.rivals.is_empty() {
        out.push_str("<p class=\"note\">No other effect came near.</p>\n");
        return out;
    }
    let rows: Vec<_> = effect
        .rivals
        .iter()
        .map(|rival| {
            let fate = if rival.tied {
                "tied: these recordings cannot tell the two apart".to_owned()
            } else {
                format!("lost: its simulation is worse segment by segment, {} standard deviations", number(rival.z, 2))
            };
            let title = escape(rival.kind.definition().title);
            (rival.tied, vec![title, number(rival.delta, 2), number(rival.z, 2), escape(&fate)])
        })
        .collect();
    out.push_str(&table(&[("rival", ""), ("Δ", "n"), ("z", "n"), ("why it is not the one", "w")], &rows));
    out
}

fn parameters(parameters: &[ParameterValue]) -> String {
    let rows: Vec<_> = parameters
        .iter()
        .map(|p| {
            let value = escape(&with_error(p.value, p.se));
            let unit = if p.unit == "1" { String::new() } else { escape(&p.unit) };
            (false, vec![format!("<i>{}</i>", escape(p.symbol)), value, unit, escape(p.meaning)])
        })
        .collect();
    table(&[("", ""), ("value ± standard error", "q"), ("unit", ""), ("what it is", "w")], &rows)
}

/// The candidates of the first round.
pub(super) fn candidates(discovery: &Discovery) -> String {
    if discovery.candidates.is_empty() {
        return String::new();
    }
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
    let columns = [("effect", ""), ("Δ", "n"), ("z", "n"), ("λ", "n"), ("what became of it", "w")];
    format!(
        "<p class=\"note\">First round, each effect fitted by simulation with the base free. Δ is the mean improvement of \
         log(noise² + error²) per segment over the base model, z its score over paired segments, λ the effective \
         log-likelihood ratio.</p>\n{}",
        table(&columns, &rows)
    )
}

/// The final base parameters and the noise.
pub(super) fn model(discovery: &Discovery) -> String {
    let Some(rung) = discovery.ladder.last() else { return String::new() };
    let units = &discovery.units;
    let rows = [
        ("b", "inertia over motor gain", rung.base.b, units.of_b()),
        ("c", "viscous friction and back-EMF", rung.base.c, units.of_c()),
        ("f1", "Coulomb friction", rung.base.f1, units.of_f1()),
    ];
    let rows: Vec<_> = rows
        .into_iter()
        .zip(discovery.base_se)
        .map(|((symbol, meaning, value, unit), se)| {
            let value = escape(&with_error(value, se));
            (false, vec![format!("<i>{symbol}</i>"), value, escape(&unit), meaning.to_owned()])
        })
        .collect();
    let effects: String =
        discovery.effects.iter().fold(String::new(), |all, effect| all + " + " + effect.kind.definition().name);
    let (fitted, all) = discovery.segments;
    format!(
        "<p class=\"law\">b·ẍ + c·ẋ + f1·sgn ẋ = u{}</p>\n{}<p class=\"note\">Noise of the position: {}. {fitted} of {all} \
         segments were simulated.</p>\n",
        escape(&effects),
        table(&[("", ""), ("value ± standard error", "q"), ("unit", ""), ("what it is", "w")], &rows),
        escape(&quantity(discovery.noise_floor, &units.x, 3)),
    )
}

/// Inputs, version, command.
pub(super) fn provenance(discovery: &Discovery) -> String {
    let from = &discovery.provenance;
    let mut out = String::new();
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
