//! One port and several processes: watching, stopping, finding the board.

use std::path::Path;
use std::process::{Command as Process, Output};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use breakaway::device::Client;
use breakaway_core::link::*;

use super::peer::{Peer, Then, batches, breakaway, failure, frame, reply, signal, start};

/// A peer that streams 300 samples when it is asked for them, and what it was asked.
fn peer() -> (Peer, Arc<Mutex<Vec<Command>>>) {
    let asked = Arc::new(Mutex::new(Vec::new()));
    let seen = Arc::clone(&asked);
    let peer = Peer::new(Vec::new(), move |Request { id, command }| {
        let mut bytes = frame(&Message::Reply { id, reply: reply(&command) });
        if matches!(command, Command::StreamOn { .. }) {
            let samples = batches(0, 300, Mode::Relay);
            bytes.extend(samples.iter().flat_map(|batch| frame(&Message::Samples(batch.clone()))));
        }
        seen.lock().unwrap().push(command);
        (bytes, Then::Stay)
    });
    (peer, asked)
}

fn wait_for(what: &str, mut there: impl FnMut() -> bool) {
    for _ in 0..1000 {
        if there() {
            return;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    panic!("{what} did not come");
}

fn rows(part: &Path) -> usize {
    std::fs::read_to_string(part).map_or(0, |text| text.lines().count())
}

fn told(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// A capture holds the port. Others read the board, watch it and stop what is running; they start nothing, and do not touch
/// its stream.
#[test]
fn a_port_that_is_held_can_be_watched_and_stopped() {
    let (peer, asked) = peer();
    let folder = tempfile::tempdir().unwrap();
    let (path, part) = (folder.path().join("a.csv"), folder.path().join("a.csv.part"));
    let holder = start(&["capture", "--port", &peer.port, "-o", path.to_str().unwrap()]);
    wait_for("the samples", || rows(&part) > 300);
    let device = |arguments: &[&str]| breakaway(&[&["device", "--port", &peer.port], arguments].concat());
    let before = asked.lock().unwrap().len();
    assert!(told(&device(&["info"])).contains("script"));
    // What the holder knows is not asked again: a guest keeps no time-out of the board's off. (The holder itself does.)
    let hellos = |asked: &[Command]| asked.iter().filter(|command| **command == Command::Hello).count();
    assert_eq!(hellos(&asked.lock().unwrap()[before..]), 0);
    assert!(told(&device(&["status"])).contains("idle"));
    assert!(told(&device(&["stop"])).contains("stopped, through the process that holds the port"));
    assert_eq!(asked.lock().unwrap().iter().filter(|command| **command == Command::Stop).count(), 1);
    let stderr = failure(&device(&["settings", "set", "brake=true"]), 1);
    assert!(stderr.contains("`settings set` cannot be sent: another breakaway process holds"), "{stderr}");
    let other = folder.path().join("b.csv");
    let stderr = failure(&breakaway(&["capture", "--port", &peer.port, "-o", other.to_str().unwrap()]), 1);
    assert!(stderr.contains("another breakaway process holds") && stderr.contains("end that first"), "{stderr}");
    // A client of this process is a guest, too; the stream stays the holder's.
    let (mut guest, _) = Client::connect(&peer.port, BAUD).unwrap();
    assert!(guest.is_guest());
    guest.done(Command::StreamOn { decimation: 7 }).unwrap();
    guest.done(Command::StreamOff).unwrap();
    let streams = |command: &&Command| matches!(command, Command::StreamOn { .. } | Command::StreamOff);
    assert_eq!(asked.lock().unwrap().iter().filter(streams).count(), 1);
    signal(&holder, "INT");
    assert!(holder.wait_with_output().unwrap().status.success());
    let gone = loop {
        if let Err(error) = guest.receive(Duration::from_millis(20)) {
            break error.to_string();
        }
    };
    assert!(gone.contains("has ended"), "{gone}");
    // The port is free again, and nothing is left of the socket.
    assert!(told(&device(&["stop"])).starts_with("stopped\n"));
}

/// A holder that hangs answers nobody: the stop goes past it, over the port that it holds.
#[test]
fn a_holder_that_hangs_does_not_prevent_a_stop() {
    let (peer, asked) = peer();
    let folder = tempfile::tempdir().unwrap();
    let (path, part) = (folder.path().join("a.csv"), folder.path().join("a.csv.part"));
    let holder = start(&["capture", "--port", &peer.port, "-o", path.to_str().unwrap()]);
    wait_for("the samples", || rows(&part) > 300);
    signal(&holder, "STOP");
    let stopped = breakaway(&["device", "--port", &peer.port, "stop", "--json"]);
    let document: serde_json::Value = serde_json::from_str(&told(&stopped)).unwrap();
    assert_eq!(document["way"], "past_holder");
    assert!(asked.lock().unwrap().contains(&Command::Stop));
    let stderr = failure(&breakaway(&["device", "--port", &peer.port, "status"]), 1);
    assert!(stderr.contains("does not answer: it hangs"), "{stderr}");
    signal(&holder, "CONT");
    signal(&holder, "INT");
    told(&holder.wait_with_output().unwrap());
}

/// A holder that was killed leaves its socket; the next one replaces it, and a stop does not wait for it.
#[test]
fn a_socket_that_was_left_behind_is_in_nobodys_way() {
    let (peer, _) = peer();
    let folder = tempfile::tempdir().unwrap();
    let (path, part) = (folder.path().join("a.csv"), folder.path().join("a.csv.part"));
    let arguments = ["capture", "--port", &peer.port, "-o", path.to_str().unwrap()];
    let mut holder = start(&arguments);
    wait_for("the samples", || rows(&part) > 300);
    holder.kill().unwrap();
    holder.wait().unwrap();
    assert!(told(&breakaway(&["device", "--port", &peer.port, "stop"])).starts_with("stopped\n"));
    std::fs::remove_file(&part).unwrap();
    let holder = start(&arguments);
    wait_for("the samples", || rows(&part) > 300);
    assert!(told(&breakaway(&["device", "--port", &peer.port, "stop"])).contains("through the process"));
    signal(&holder, "INT");
    assert!(holder.wait_with_output().unwrap().status.success());
}

#[test]
fn a_monitor_beside_needs_a_terminal_and_a_board() {
    let stderr = failure(&breakaway(&["capture", "--port", "/dev/ttyNONE0", "-o", "a.csv", "--monitor"]), 2);
    assert!(stderr.contains("--monitor needs a terminal"), "{stderr}");
    let stderr = failure(&breakaway(&["run", "suite", "-o", "session", "--monitor"]), 2);
    assert!(stderr.contains("--monitor shows a board: give --port"), "{stderr}");
}

/// Ports that answer, by the files of virtual boards, in a runtime folder of their own.
fn with_boards(peers: &[&Peer], arguments: &[&str]) -> Output {
    let runtime = tempfile::tempdir().unwrap();
    let folder = runtime.path().join("breakaway");
    std::fs::create_dir(&folder).unwrap();
    for (k, peer) in peers.iter().enumerate() {
        std::fs::write(folder.join(format!("{k}.virtual")), format!("{}\n{}\n", peer.port, std::process::id()))
            .unwrap();
    }
    // One whose process is gone: the number is above the largest that Linux gives.
    std::fs::write(folder.join("gone.virtual"), "/dev/pts/4000\n2000000000\n").unwrap();
    let run = Process::new(env!("CARGO_BIN_EXE_breakaway"))
        .args(arguments)
        .env("XDG_RUNTIME_DIR", runtime.path())
        .output()
        .unwrap();
    if arguments.contains(&"list") {
        assert!(!folder.join("gone.virtual").exists());
    }
    run
}

#[test]
fn ports_are_listed_and_the_only_one_that_answers_is_used() {
    let (one, _) = peer();
    let (other, _) = peer();
    let silent = Peer::new(Vec::new(), |_| (Vec::new(), Then::Stay));
    let listed = with_boards(&[&one, &silent], &["device", "list", "--json"]);
    let document: serde_json::Value = serde_json::from_str(&told(&listed)).unwrap();
    crate::json_schema::valid("device-list", &document);
    let entry =
        |peer: &Peer| document.as_array().unwrap().iter().find(|entry| entry["port"] == peer.port.as_str()).unwrap();
    assert_eq!((&entry(&one)["answers"], &entry(&one)["board"]), (&true.into(), &"script".into()), "{document}");
    assert_eq!((&entry(&one)["device"], &entry(&one)["held"]), (&"virtual board".into(), &false.into()));
    assert_eq!(entry(&silent)["answers"], false, "{document}");
    assert!(entry(&silent)["reason"].as_str().unwrap().contains("no answer within"), "{document}");

    let status = with_boards(&[&one, &silent], &["device", "status"]);
    assert!(told(&status).contains("idle"));
    let said = String::from_utf8(status.stderr).unwrap();
    assert!(said.contains(&format!("using {}", one.port)), "{said}");

    let stderr = failure(&with_boards(&[&one, &other], &["device", "status"]), 2);
    assert!(stderr.contains("several boards answer") && stderr.contains(&one.port), "{stderr}");
    assert!(stderr.contains(&other.port) && stderr.contains("--port PORT"), "{stderr}");
    let stderr = failure(&with_boards(&[&silent], &["device", "status"]), 1);
    assert!(stderr.contains("no board answers at") && stderr.contains("breakaway device list"), "{stderr}");
}
