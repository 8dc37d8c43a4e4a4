//! `run --port`: what can go wrong between the start of an experiment and its end.

use std::path::PathBuf;

use breakaway::recording::{ReadOptions, Recording};
use breakaway_core::link::*;

use super::peer::{Peer, Then, batches, breakaway, failure, frame, reply, status};

const RELAY: &str = "name = \"relay\"\nduration_s = 0.5\n[excitation]\nkind = \"relay\"\nh1 = 2.0\nh2 = 1.5\n";

fn experiment(folder: &tempfile::TempDir) -> String {
    let path = folder.path().join("relay.toml");
    std::fs::write(&path, RELAY).unwrap();
    path.to_str().unwrap().to_owned()
}

/// A peer that, after the relay was started, sends its samples, those of the idle board after it, and `event`.
fn peer(event: Event, then: Then) -> Peer {
    let mut bytes = Vec::new();
    for batch in batches(10, 500, Mode::Relay).into_iter().chain(batches(510, 20, Mode::Idle)) {
        bytes.extend(frame(&Message::Samples(batch)));
    }
    bytes.extend(frame(&Message::Event(event)));
    Peer::new(Vec::new(), move |Request { id, command }| {
        let mut answer = frame(&Message::Reply { id, reply: reply(&command) });
        if !matches!(command, Command::StartRelay(_)) {
            return (answer, Then::Stay);
        }
        answer.extend(&bytes);
        (answer, then)
    })
}

fn ended(ending: Ending) -> Event {
    Event::ExperimentEnded(Ended { mode: Mode::Relay, ending, tick: 509, ticks: 500, saturated: 0 })
}

fn run(peer: &Peer) -> (std::process::Output, tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let file = experiment(&folder);
    let out = folder.path().join("out");
    let output = breakaway(&["run", &file, "--port", &peer.port, "-o", out.to_str().unwrap(), "--json"]);
    (output, folder, out.join("relay.csv"))
}

#[test]
fn the_samples_of_the_experiment_and_no_others_are_recorded() {
    let (output, _folder, file) = run(&peer(ended(Ending::TimeUp), Then::Stay));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let recording = Recording::read(&file, &ReadOptions::default()).unwrap();
    assert_eq!((recording.x.len(), recording.t[0]), (500, 0.01));
    assert_eq!((recording.meta["ended"].as_str(), recording.meta["board"].as_str()), ("time up", "script"));
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (document["recordings"][0]["samples"].as_u64(), document["recordings"][0]["missing"].as_u64()),
        (Some(500), Some(0))
    );
}

#[test]
fn a_limit_is_an_ending_with_its_number() {
    let limit = Ending::Limit { limit: Limit::Speed, value: 123_456 };
    let (output, _folder, _) = run(&peer(ended(limit), Then::Stay));
    assert!(output.status.success());
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let ending = &document["recordings"][0]["ending"];
    assert_eq!(
        (ending["kind"].as_str(), ending["limit"].as_str(), ending["value"].as_f64()),
        (Some("limit_tripped"), Some("speed"), Some(123_456.0))
    );
}

#[test]
fn a_fault_fails_and_what_came_before_it_is_kept() {
    let (output, _folder, file) = run(&peer(ended(Ending::Fault(FaultCause::EncoderJump)), Then::Stay));
    let stderr = failure(&output, 1);
    assert!(stderr.contains("the 500 samples of relay until then are in"), "{stderr}");
    assert!(stderr.contains("the board has a fault: encoder_jump"), "{stderr}");
    assert_eq!(Recording::read(&file, &ReadOptions::default()).unwrap().x.len(), 500);
}

#[test]
fn unplugging_keeps_what_had_come() {
    let (output, _folder, file) = run(&peer(Event::Started, Then::Unplug));
    let stderr = failure(&output, 1);
    assert!(stderr.contains("the 500 samples of relay until then are in"), "{stderr}");
    assert_eq!(Recording::read(&file, &ReadOptions::default()).unwrap().x.len(), 500);
}

#[test]
fn a_board_that_is_not_idle_is_left_alone() {
    let busy = Peer::answering(
        |command| match command {
            Command::Status => status(Mode::Track),
            // It is asked only what changes nothing.
            Command::Hello | Command::GetSettings => reply(command),
            other => panic!("{other:?}"),
        },
        Vec::new(),
        Then::Stay,
    );
    let (output, _folder, file) = run(&busy);
    let stderr = failure(&output, 1);
    assert!(stderr.contains("the board is not idle but in mode `track`"), "{stderr}");
    assert!(!file.exists());
}

#[test]
fn a_latched_fault_is_said_with_its_numbers() {
    let record = FaultRecord {
        cause: FaultCause::EncoderJump,
        mode: Mode::Relay,
        tick: 1,
        count: 2,
        drive_code: 3,
        value: 4567,
        limit: 1000,
    };
    let faulted = Peer::answering(
        move |command| match command {
            Command::Status => status(Mode::Fault),
            Command::GetFault => Reply::Fault(Some(record)),
            other => reply(other),
        },
        Vec::new(),
        Then::Stay,
    );
    let stderr = failure(&run(&faulted).0, 1);
    assert!(stderr.contains("the encoder jumped by 4567 counts in one tick (limit 1000)"), "{stderr}");
}
