//! `cargo xtask arrows`: draws which room uses which, from the source, into docs/architecture.md.
//!
//! Crate by crate, the rooms stand in the order of [`CRATES`]; a room may use those before it. The page and the rule are
//! checked by the tests below. cargo-modules draws every module of one crate and can refuse cycles; it does not know the
//! order, and brings a whole rust-analyzer.

mod scan;

use std::fmt::Write as _;
use std::fs;

use anyhow::{Context, Result, ensure};

use crate::run::root;
use scan::Arrows;

/// A crate and its rooms, each after those that it may use.
struct Order {
    name: &'static str,
    rooms: &'static [&'static str],
}

/// The walk of the data: what is applied, learnt, driven and sent; recording → model → discovery → device → report.
const CRATES: [Order; 3] = [
    Order { name: "core", rooms: &["fnv", "says", "scalar", "plant", "excite", "estimate", "control", "link"] },
    Order { name: "firmware", rooms: &["board", "storage", "app"] },
    Order {
        name: "host",
        rooms: &[
            "interrupt",
            "nearest",
            "mistaken",
            "file",
            "recording",
            "look",
            "model",
            "export",
            "sine",
            "response",
            "simulate",
            "fit",
            "identify",
            "discover",
            "control",
            "device",
            "report",
            "fleet",
            "models",
            "command",
        ],
    },
];

const PAGE: &str = "docs/architecture.md";
const START: &str = "<!-- drawn by `cargo xtask arrows` -->\n";
const END: &str = "<!-- end of what is drawn -->\n";

/// Draws the page anew.
pub fn draw() -> Result<()> {
    let path = root().join(PAGE);
    let page = fs::read_to_string(&path).with_context(|| PAGE.to_owned())?;
    let (before, rest) = page.split_once(START).with_context(|| format!("{PAGE}: no {START}"))?;
    let (_, after) = rest.split_once(END).with_context(|| format!("{PAGE}: no {END}"))?;
    fs::write(&path, format!("{before}{START}{}{END}{after}", drawing()?))?;
    let new = backward()?;
    ensure!(new.is_empty(), "these arrows go backwards:\n{}", new.join("\n"));
    println!("{PAGE} is drawn; no arrow goes backwards");
    Ok(())
}

/// What stands in the page between the marks.
fn drawing() -> Result<String> {
    let mut text = String::new();
    for order in &CRATES {
        let arrows = of(order)?;
        // Writing to a String cannot fail.
        let _ = writeln!(text, "\n### {}\n\n```mermaid\nflowchart BT", order.name);
        for room in order.rooms {
            let _ = writeln!(text, "    {room}");
        }
        for ((from, to), _) in reduced(order, &arrows) {
            let line = if is_backward(order, &from, &to) { "-.->|back|" } else { "-->" };
            let _ = writeln!(text, "    {from} {line} {to}");
        }
        let _ = writeln!(text, "```\n\n| room | uses |\n|---|---|");
        for room in order.rooms {
            let uses: Vec<&str> =
                arrows.keys().filter(|arrow| arrow.0 == *room).map(|arrow| arrow.1.as_str()).collect();
            let _ = writeln!(text, "| `{room}` | {} |", if uses.is_empty() { "–".to_owned() } else { uses.join(", ") });
        }
    }
    text.push('\n');
    Ok(text)
}

fn of(order: &Order) -> Result<Arrows> {
    let src = root().join(order.name).join("src");
    let rooms = scan::rooms(&src)?;
    let unknown: Vec<&String> = rooms.iter().filter(|room| !order.rooms.contains(&room.as_str())).collect();
    let gone: Vec<&&str> = order.rooms.iter().filter(|room| !rooms.iter().any(|there| there == *room)).collect();
    ensure!(
        unknown.is_empty() && gone.is_empty(),
        "{}: new rooms {unknown:?}, rooms that are gone {gone:?}: put them in order in xtask/src/arrows.rs",
        order.name
    );
    scan::arrows(&src, &rooms)
}

/// The arrows without those that a longer way already shows; what goes backwards stays.
fn reduced(order: &Order, arrows: &Arrows) -> Arrows {
    let forward =
        |from: &str, to: &str| arrows.contains_key(&(from.to_owned(), to.to_owned())) && !is_backward(order, from, to);
    let reaches = |from: &str, to: &str| {
        // A room's reach, farthest first: each uses only those before it.
        let mut reached = vec![from];
        for room in order.rooms.iter().rev() {
            if *room != to && reached.iter().any(|at| forward(at, room)) {
                reached.push(room);
            }
        }
        reached.iter().skip(1).any(|at| forward(at, to))
    };
    let shown = arrows.iter().filter(|((from, to), _)| is_backward(order, from, to) || !reaches(from, to));
    shown.map(|(arrow, files)| (arrow.clone(), files.clone())).collect()
}

fn is_backward(order: &Order, from: &str, to: &str) -> bool {
    let place = |name: &str| order.rooms.iter().position(|room| *room == name);
    place(from) < place(to)
}

/// Arrows that go backwards.
fn backward() -> Result<Vec<String>> {
    let mut wrong = Vec::new();
    for order in &CRATES {
        for ((from, to), files) in &of(order)? {
            if is_backward(order, from, to) {
                wrong.push(format!("{}: {from} → {to} in {}", order.name, files.join(", ")));
            }
        }
    }
    Ok(wrong)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_arrow_goes_backwards() {
        let wrong = backward().unwrap();
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }

    #[test]
    fn the_page_shows_what_is() {
        let page = fs::read_to_string(root().join(PAGE)).unwrap();
        let shown = page.split_once(START).and_then(|(_, rest)| rest.split_once(END)).expect("the marks").0;
        assert_eq!(shown, drawing().unwrap(), "`cargo xtask arrows` draws {PAGE} anew");
    }

    /// a ← b ← c, a ← c: the last is left out, an arrow back is not.
    #[test]
    fn what_a_longer_way_shows_is_left_out() {
        let order = Order { name: "", rooms: &["a", "b", "c"] };
        let arrow = |from: &str, to: &str| ((from.to_owned(), to.to_owned()), Vec::new());
        let arrows = Arrows::from([arrow("b", "a"), arrow("c", "b"), arrow("c", "a"), arrow("a", "c")]);
        let shown: Vec<(String, String)> = reduced(&order, &arrows).into_keys().collect();
        assert_eq!(shown, [arrow("a", "c").0, arrow("b", "a").0, arrow("c", "b").0]);
    }
}
