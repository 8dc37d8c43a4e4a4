//! The wire format is what `core/src/link/golden.txt` says.

use std::fmt::Write as _;

use breakaway_core::excite::waveform::Shape;
use breakaway_core::link::*;
use breakaway_core::plant::Kind;
use serde::Serialize;

use crate::examples;

/// Version and fingerprint of every wire format there has been, the present one last.
const HISTORY: &[(u16, u32)] =
    &[(1, 0x5214_160a), (2, 0x339b_64f8), (3, 0x6fef_c601), (4, 0x5c2c_3251), (5, 0x4db5_c477)];

const CHANGED: &str = "the wire format has changed. If version PROTOCOL_VERSION has left the house, raise it \
    (core/src/link/mod.rs). Then write the vectors anew (BLESS=1 cargo test -p breakaway-core --test link), read their \
    diff, and add (version, schema) to HISTORY in this file";

fn hex(bytes: &[u8]) -> String {
    let mut text = String::new();
    for byte in bytes {
        let _ = write!(text, "{byte:02x}");
    }
    text
}

fn line(text: &mut String, name: &str, message: &impl Serialize) {
    let mut bytes = [0; MAX_MESSAGE];
    let _ = writeln!(text, "{name}: {}", hex(postcard::to_slice(message, &mut bytes).unwrap()));
}

/// What the present code writes.
fn vectors() -> String {
    let mut text = String::from("# The wire format, written by core/tests/link/golden.rs: name: message in hex.\n");
    for (name, command) in examples::commands() {
        line(&mut text, &format!("request {name}"), &Request { id: 0x0203, command });
    }
    for (name, message) in examples::messages() {
        line(&mut text, &name, &message);
    }
    text.push_str("# Frames: COBS, CRC-32, zero byte.\n");
    let mut frame = [0; MAX_FRAME];
    let used = encode(&Request { id: 0, command: Command::Hello }, &mut frame).unwrap();
    let _ = writeln!(text, "frame hello: {}", hex(&frame[..used]));
    let used = encode(&Message::Samples(examples::batch()), &mut frame).unwrap();
    let _ = writeln!(text, "frame samples: {}", hex(&frame[..used]));
    text.push_str("# Every value of the enumerations that stand alone.\n");
    all(&mut text, "mode", &[Mode::Idle, Mode::Relay, Mode::Drive, Mode::Track, Mode::Hold, Mode::Fault]);
    all(&mut text, "shape", &[Shape::Still, Shape::Sine, Shape::Triangle, Shape::Ramp, Shape::Table]);
    all(
        &mut text,
        "limit",
        &[Limit::Travel, Limit::Bound, Limit::Speed, Limit::Current, Limit::MeanDrive, Limit::SetPoints],
    );
    all(&mut text, "unit", &PositionUnit::ALL);
    all(&mut text, "unit", &DriveUnit::ALL);
    all(&mut text, "cause", &FaultCause::ALL);
    all(&mut text, "verdict", &IdentificationVerdict::ALL);
    for field in Field::ALL {
        line(&mut text, &format!("field {}", field.name()), field);
    }
    text
}

/// The numbers of the effects. They are not part of the format: a device refuses by name what it does not know.
fn effects() -> String {
    let mut text = String::from("# Numbers of the effects on the wire: a hash of the name. Lines are only added.\n");
    for kind in Kind::ALL {
        let _ = writeln!(text, "{}: {:08x}", kind.name(), EffectId::of(*kind).0);
    }
    text
}

fn all<T: Serialize + std::fmt::Debug>(text: &mut String, name: &str, values: &[T]) {
    for value in values {
        line(text, &format!("{name} {value:?}"), value);
    }
}

/// The file's content; with `BLESS` it is written first.
fn pinned(file: &str, now: &str) -> String {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&path, now).unwrap();
    }
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn the_wire_format_is_the_golden_one() {
    let now = vectors();
    let golden = pinned("src/link/golden.txt", &now);
    for (golden, now) in golden.lines().zip(now.lines()) {
        assert_eq!(golden, now, "{CHANGED}");
    }
    assert_eq!(golden.lines().count(), now.lines().count(), "{CHANGED}");
}

/// docs/link.md explains bytes; they are those of the golden vectors.
#[test]
fn the_page_explains_golden_bytes() {
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/link.md")).unwrap();
    let golden = include_str!("../../src/link/golden.txt");
    let (mut inside, mut explained) = (false, 0);
    for (number, line) in page.lines().enumerate() {
        match line.strip_prefix("```") {
            Some(language) => inside = language == "golden",
            None if inside => {
                assert!(golden.lines().any(|golden| golden == line), "docs/link.md:{}: {line}", number + 1);
                explained += 1;
            }
            None => {}
        }
    }
    assert_eq!(explained, 9);
}

#[test]
fn every_format_has_its_version() {
    let (version, schema) = *HISTORY.last().unwrap();
    assert_eq!((PROTOCOL_VERSION, format!("{SCHEMA:#010x}")), (version, format!("{schema:#010x}")), "{CHANGED}");
    assert!(HISTORY.is_sorted_by(|a, b| a.0 < b.0), "one format per version");
}

#[test]
fn effects_keep_their_numbers() {
    let now = effects();
    let kept = pinned("tests/link/effects.txt", &now);
    assert_eq!(
        kept, now,
        "an effect changed its name, and with it its number on the wire: devices will not know it. \
        If it was only added, write the list anew (BLESS=1)"
    );
}

#[test]
fn effects_have_numbers_of_their_own() {
    for (i, kind) in Kind::ALL.iter().enumerate() {
        assert_eq!(EffectId::of(*kind).kind(), Some(*kind));
        assert!(Kind::ALL[..i].iter().all(|other| EffectId::of(*other) != EffectId::of(*kind)), "{}", kind.name());
    }
    assert_eq!(EffectId(0).kind(), None);
}

#[test]
fn another_version_can_be_told_by_its_first_bytes() {
    // A device of the future: the same first fields, then anything.
    let mut bytes = [0; MAX_MESSAGE];
    let future = postcard::to_slice(&(0u8, 7u16, 0u8, 900u16, 0xdead_beef_u32, "anything"), &mut bytes).unwrap();
    assert_eq!(peer_version(future), Some((7, 900, 0xdead_beef)));
    assert_eq!(Message::decode(future), None);

    let info = Message::Reply { id: 9, reply: Reply::Info(examples::info()) };
    let bytes = postcard::to_slice(&info, &mut bytes).unwrap();
    assert_eq!(peer_version(bytes), Some((9, 0x1234, 0x8765_4321)));
    assert_eq!(peer_version(&[0, 9, 1]), None);
    assert_eq!(peer_version(&[]), None);
    // The host's side of the same promise.
    let hello = Request { id: 0x0203, command: Command::Hello };
    assert_eq!(postcard::to_slice(&hello, &mut [0; 8]).unwrap(), &[0x83, 0x04, 0x00]);
}
