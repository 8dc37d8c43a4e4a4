//! From a known plant, over the registers, back to the plant.

use breakaway::command::run::papers_plant;
use breakaway_core::link::{Command, Ending, IdentificationVerdict, Reply};

use crate::machine::{axis, run_relay};

/// The board by itself, with the bars of the virtual board (`virtual_board/identify.rs`): as many seconds of both relays.
#[test]
fn the_board_identifies_by_itself() {
    needs_unicorn!();
    let mut bench = axis();
    for (h1, h2) in [(2.0, 1.5), (1.0, 0.7)] {
        assert_eq!(run_relay(&mut bench, h1, h2, 90_000).ending, Ending::TimeUp);
    }
    let reply = bench.request(Command::Identify);
    let Reply::Identified(found) = reply else { panic!("not identified: {reply:?}") };
    assert_eq!(found.verdict, IdentificationVerdict::Determined);
    let truth = papers_plant().base;
    for (name, got, truth, allowed) in
        [("b", found.b, truth.b, 0.01), ("c", found.c, truth.c, 0.015), ("f1", found.f1, truth.f1, 0.01)]
    {
        let off = f64::from(got.value) / truth - 1.0;
        println!("{name}: {:+.3} %", 100.0 * off);
        assert!(off.abs() < allowed, "{name}: {got:?} is off by {:.2} %", 100.0 * off);
    }
    assert!(found.sine.is_some_and(|sine| sine.cycles > 20.0));
}
