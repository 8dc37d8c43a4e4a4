//! Each way in which a board cannot be reached has a message of its own.

use std::sync::{Arc, Mutex};

use breakaway_core::link::*;

use super::peer::{Peer, Then, breakaway, failure, frame, info, reply};

#[test]
fn a_port_that_is_not_there() {
    let stderr = failure(&breakaway(&["device", "--port", "/dev/ttyNONE0", "info"]), 1);
    assert!(stderr.contains("there is no port /dev/ttyNONE0: is the board plugged in?"), "{stderr}");
}

#[test]
fn a_file_is_no_port() {
    let file = tempfile::NamedTempFile::new().unwrap();
    let stderr = failure(&breakaway(&["device", "--port", file.path().to_str().unwrap(), "info"]), 1);
    assert!(stderr.contains("cannot be used as a serial port: it is an ordinary file"), "{stderr}");
}

#[test]
fn a_port_that_is_in_use() {
    let peer = Peer::answering(reply, Vec::new(), Then::Stay);
    let held = serialport::new(&peer.port, 115_200).open().unwrap();
    let stderr = failure(&breakaway(&["device", "--port", &peer.port, "info"]), 1);
    assert!(stderr.contains("is in use by another program"), "{stderr}");
    drop(held);
    assert!(breakaway(&["device", "--port", &peer.port, "info"]).status.success());
}

#[test]
fn nobody_answers() {
    let peer = Peer::new(Vec::new(), |_| (Vec::new(), Then::Stay));
    let stderr = failure(&breakaway(&["device", "--port", &peer.port, "info"]), 1);
    assert!(stderr.contains("not a single byte"), "{stderr}");
}

#[test]
fn a_wrong_baud_rate() {
    // What a frame looks like at another rate: bytes, with zeros among them, that mean nothing.
    let noise: Vec<u8> = (0..2000u32).map(|k| (k.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    let peer = Peer::new(noise, |_| (Vec::new(), Then::Stay));
    let stderr = failure(&breakaway(&["device", "--port", &peer.port, "--baud", "115200", "info"]), 1);
    assert!(stderr.contains("2000 bytes came, and no readable frame"), "{stderr}");
    assert!(stderr.contains("The baud rate is wrong (tried 115200, the firmware's own is 921600"), "{stderr}");
}

#[test]
fn another_version() {
    // Another version may go on as it likes after its first two fields.
    let peer = Peer::new(Vec::new(), |request| {
        (frame(&(0u8, request.id, 0u8, 77u16, 0xabcd_u32, "another format")), Then::Stay)
    });
    let stderr = failure(&breakaway(&["device", "--port", &peer.port, "info"]), 1);
    let expected =
        format!("the board speaks link version 77 (schema 0000abcd), this program version {PROTOCOL_VERSION}");
    assert!(stderr.contains(&expected) && stderr.contains("flash the firmware of this release"), "{stderr}");
}

#[test]
fn the_same_version_with_another_schema_is_another_version() {
    let peer = Peer::answering(
        |command| match command {
            Command::Hello => Reply::Info(Info { schema: !SCHEMA, ..info() }),
            other => reply(other),
        },
        Vec::new(),
        Then::Stay,
    );
    let stderr = failure(&breakaway(&["device", "--port", &peer.port, "info"]), 1);
    assert!(stderr.contains("the board speaks link version"), "{stderr}");
}

#[test]
fn unplugged_before_it_answers() {
    let peer = Peer::new(Vec::new(), |_| (Vec::new(), Then::Unplug));
    let stderr = failure(&breakaway(&["device", "--port", &peer.port, "info"]), 1);
    assert!(stderr.contains("went away") && stderr.contains("plug it in again"), "{stderr}");
}

#[test]
fn a_refusal_names_the_field_and_what_is_valid() {
    let peer = Peer::answering(
        |command| match command {
            Command::SetSettings(_) => Reply::Error(CommandError::Settings(Field::JumpCounts)),
            Command::ClearFault => Reply::Error(CommandError::FaultPersists),
            other => reply(other),
        },
        Vec::new(),
        Then::Stay,
    );
    let device = |arguments: &[&str]| breakaway(&[&["device", "--port", &peer.port], arguments].concat());
    let stderr = failure(&device(&["settings", "set", "jump_counts=5"]), 1);
    assert!(stderr.contains("jump_counts is out of range: it must be 1 to 2147483647 counts"), "{stderr}");
    let stderr = failure(&device(&["clear"]), 1);
    assert!(stderr.contains("the cause of the fault is still there"), "{stderr}");
    // What the host can tell itself is wrong usage, and the board is not asked.
    let stderr = failure(&device(&["settings", "set", "jump_count=5"]), 2);
    assert!(stderr.contains("did you mean `jump_counts`?"), "{stderr}");
}

#[test]
fn info_is_a_document() {
    let peer = Peer::answering(reply, Vec::new(), Then::Stay);
    let run = breakaway(&["device", "--port", &peer.port, "info", "--json"]);
    let document: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    // The decimal that was meant, not its nearest single-precision number.
    assert_eq!(document["position_per_count"], 0.001);
    assert_eq!((document["board"].as_str(), document["tick_hz"].as_u64()), (Some("script"), Some(1000)));
}

/// What `jog`, `home` and `zero` ask of the board, and what they make of its answers.
#[test]
fn pushes_and_zeroes() {
    let asked = Arc::new(Mutex::new(Vec::new()));
    let seen = Arc::clone(&asked);
    let peer = Peer::new(Vec::new(), move |Request { id, command }| {
        let mut bytes = frame(&Message::Reply { id, reply: reply(&command) });
        let ending = match command {
            Command::Jog(_) => Some(Ending::TimeUp),
            Command::Home { at: 0, .. } => Some(Ending::NoLimitCycle),
            Command::Home { .. } => Some(Ending::Homed),
            _ => None,
        };
        if let Some(ending) = ending {
            let ended = Ended { mode: Mode::Drive, ending, tick: 9, ticks: 5, saturated: 0 };
            bytes.extend(frame(&Message::Event(Event::ExperimentEnded(ended))));
        }
        if !matches!(command, Command::Hello | Command::Status | Command::GetSettings) {
            seen.lock().unwrap().push(command);
        }
        (bytes, Then::Stay)
    });
    let device = |arguments: &[&str]| breakaway(&[&["device", "--port", &peer.port], arguments].concat());
    let told = |output: &std::process::Output| String::from_utf8(output.stdout.clone()).unwrap();
    assert!(told(&device(&["zero", "--at", "-0.25"])).contains("it stands at -0.250000 rad"));
    assert!(
        told(&device(&["jog", "--drive", "-1.2", "--for", "0.25", "--distance", "0.1"])).contains("time up: at 0.0")
    );
    assert!(told(&device(&["home", "--drive=1.2", "--at", "0.5"])).contains("homed: at 0.0"));
    let stderr = failure(&device(&["home", "--drive=1.2"]), 1);
    assert!(stderr.contains("it did not move"), "{stderr}");
    let push = |volts: f64, max_ticks, travel_counts| Push {
        drive_code: (volts / 12.0 * 32_767.0).round() as i16,
        bounds: Bounds { max_ticks, drive_max_code: 0, travel_counts },
    };
    let expected = [
        Command::Zero { count: -250 },
        Command::Jog(push(-1.2, 250, 100)),
        Command::Home { push: push(1.2, 10_000, 0), at: 500 },
        Command::Home { push: push(1.2, 10_000, 0), at: 0 },
    ];
    assert_eq!(*asked.lock().unwrap(), expected);
}
