//! The motor library: every card passes its check, and docs/models.md is what the cards say.

use std::path::Path;

use breakaway::models::{self, Card, check, page};
use breakaway_tests::measured_data;

/// Every card is complete, has the name of its file, is in the program, and is written as it was read.
#[test]
fn every_card_passes_its_check() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let mut files: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let stems: Vec<_> = files.iter().map(|file| file.file_stem().unwrap().to_str().unwrap()).collect();
    assert_eq!(stems, models::names());
    for (file, name) in files.iter().zip(models::names()) {
        let card = models::card(name).unwrap();
        assert_eq!(card, Card::read(file).unwrap());
        assert_eq!(card.head.name, name);
        assert_eq!(check::faults(&card), Vec::<String>::new(), "{name}");
        assert_eq!(Card::parse("again", &card.to_toml()).unwrap(), card, "{name}");
    }
}

/// The recordings are those that the cards were made from, and give the card's held-out error again. Another
/// mathematics library may change a fitted start, and by it the error by 2 %.
#[test]
fn every_card_holds_beside_its_recordings() {
    let Some(data) = measured_data() else { return };
    for card in models::all().unwrap() {
        let faults = check::faults_beside(&card, &data).unwrap();
        assert_eq!(faults, Vec::<String>::new(), "{}", card.head.name);
    }
}

/// A card with each fault is refused for it.
#[test]
fn a_fault_is_seen() {
    let card = models::card("emps").unwrap();
    let spoilt = |spoil: &dyn Fn(&mut Card), word: &str| {
        let mut card = card.clone();
        spoil(&mut card);
        let faults = check::faults(&card);
        assert!(faults.len() == 1 && faults[0].contains(word), "{word}: {faults:?}");
    };
    spoilt(&|card| card.head.name = "EM PS".into(), "name");
    spoilt(&|card| card.data.licence.clear(), "licence");
    spoilt(&|card| card.data.file[0].sha256.truncate(10), "SHA-256");
    spoilt(&|card| card.data.file.clear(), "no recording");
    spoilt(&|card| card.range.speed = 0.0, "range");
    spoilt(&|card| card.held_out.rmse = 1.0, "stands still");
    if let Some(data) = measured_data() {
        let mut other = card.clone();
        other.data.file[0].sha256 = "0".repeat(64);
        other.model.base.b *= 2.0;
        let faults = check::faults_beside(&other, &data).unwrap();
        assert!(faults.len() == 2 && faults[0].contains("another file") && faults[1].contains("it errs"), "{faults:?}");
    }
}

/// `BREAKAWAY_BLESS=1 cargo test -p breakaway-tests --test all models::` writes the page anew.
#[test]
fn the_page_is_what_the_cards_say() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/models.md");
    let made = breakaway_tests::markdown::wrapped(&page::page(&models::all().unwrap()));
    if std::env::var_os("BREAKAWAY_BLESS").is_some() {
        std::fs::write(&path, &made).unwrap();
    }
    assert!(std::fs::read_to_string(&path).unwrap() == made, "docs/models.md is not what the cards say");
}
