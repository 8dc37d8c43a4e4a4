//! The cards as a page of documentation: `docs/models.md`.

use std::fmt::Write as _;

use super::Card;
use super::compare::parameters;
use crate::report::text::{number, quantity, range};

const HEAD: &str = "# The motor library

A card holds the model of a machine, and what it was made from and judged by. The cards are in
`models/` and in the program. This page is generated from them.

    breakaway models list
    breakaway models show emps
    breakaway models compare emps ak80

*Held out* is the error of a simulation over windows of the last third of every recording. The start
of a window is fitted to its first 40 %. *Standing still* is the same of an axis that does not move.

| of a card | |
|---|---|
| `[card]` | name, machine, source, and the command that gives the model again |
| `[data]` | licence and columns, and `[[data.file]]` with name and SHA-256 of each recording |
| `[motor]` | what is known of motor and gear, for `breakaway export --motor` |
| `[range]` | where the recordings were: position, speed, drive |
| `[held_out]` | the error below, over how many windows |
| `[model]` | the model, as a model file has it ([formats](formats.md)) |

The recordings are other people's, and the project holds none of them. A parameter without an error
was held; or it was found in the measured forces, which give none; or the recordings do not tell it.

`breakaway models add MODEL.toml REC…` makes a card, and refuses one that fails its check. It fails
if a text is missing, if a hash is none, or if the model is worse than an axis that stands still.
Where the recordings are there, a test computes hashes and held-out errors again.

Each machine that `discover` gets right ([machines](machines.md)) has a card, but for one. The arm of
CICESE hardly moves in its recordings: its friction is told, its inertia is not. A model without an
inertia simulates nothing else.

The robot drives `frc-left` and `frc-right` miss nothing. Their f1 is twice the .26 V
that the description of the recordings gives. A straight line by hand, u over velocity in the slow
recordings, gives .53 to .56 V, and the wheels start at .75 V. Their inertia is not told, because the
velocity follows the drive.

";

/// The page.
pub fn page(cards: &[Card]) -> String {
    let mut text = HEAD.to_owned();
    text.push_str("| card | machine | effects | held out | standing still | windows |\n|---|---|---|---|---|---|\n");
    for card in cards {
        let held = &card.held_out;
        let x = &card.model.units.x;
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "| [{0}](#{0}) | {1} | {2} | {3} | {4} | {5} of {6} s |",
            card.head.name,
            card.head.machine,
            effects(card),
            quantity(held.rmse, x, 4),
            quantity(held.standstill_rmse, x, 4),
            held.windows,
            held.window_s
        );
    }
    for card in cards {
        text.push_str(&section(card));
    }
    text
}

/// The names of a card's effects.
pub fn effects(card: &Card) -> String {
    let names: Vec<&str> = card.model.effects.iter().map(|entry| entry.name.as_str()).collect();
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

fn section(card: &Card) -> String {
    let (x, u) = (&card.model.units.x, &card.model.units.u);
    let mut text = format!("\n## {}\n\n{}.\n\n", card.head.name, card.head.machine);
    let between = &card.range;
    let rows = [
        ("source", card.head.source.clone()),
        ("licence of the data", card.data.licence.clone()),
        ("recordings", card.data.file.len().to_string()),
        ("position", format!("{} {x}", range(between.position))),
        ("largest speed", format!("{} {x}/s", number(between.speed, 4))),
        ("largest drive", format!("{} {u}", number(between.drive, 4))),
        ("again by", format!("`{}`", card.head.repeat)),
    ];
    text.push_str("| of the data | |\n|---|---|\n");
    for (what, value) in rows {
        let _ = writeln!(text, "| {what} | {value} |");
    }
    text.push_str("\n| parameter | value | unit |\n|---|---|---|\n");
    for (name, quantity) in parameters(card) {
        let _ = writeln!(text, "| {name} | {} | {} |", quantity.text(), quantity.unit);
    }
    text
}
