//! `capture`: whatever ends it, what had come until then is a valid recording.

use std::path::Path;
use std::time::Duration;

use breakaway::recording::{ReadOptions, Recording};
use breakaway_core::link::*;

use super::peer::{Peer, Then, batches, breakaway, failure, frame, reply, samples_of, signal, start};

fn stream(batches: &[Batch]) -> Vec<u8> {
    batches.iter().flat_map(|batch| frame(&Message::Samples(batch.clone()))).collect()
}

fn read(path: &Path) -> Recording {
    Recording::read(path, &ReadOptions::default()).unwrap()
}

fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn unplugging_costs_nothing_that_had_come() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    let batches = batches(5000, 700, Mode::Relay);
    let peer = Peer::answering(reply, stream(&batches), Then::Unplug);
    let run = breakaway(&["capture", "--port", &peer.port, "-o", path.to_str().unwrap()]);
    let stderr = failure(&run, 1);
    assert!(stderr.contains("went away") && stderr.contains("the 700 samples until then (0.699 s) are in"), "{stderr}");
    let recording = read(&path);
    assert_eq!((recording.x.len(), recording.gaps.len()), (700, 0));
    // Code 2731 of 32767 at 12 V; tick 5000 at 1 kHz; count 699 at 0.001 rad.
    assert_eq!((recording.t[0], recording.x[699], recording.u[0]), (5.0, 0.699, 2731.0 * 12.0 / 32_767.0));
    assert_eq!((recording.units.u.as_str(), recording.encoder_step), ("V", Some(0.001)));
    assert_eq!((recording.meta["board"].as_str(), recording.meta["firmware build"].as_str()), ("script", "abcdef"));
    assert_eq!(files(folder.path()), ["a.csv"]);
}

#[test]
fn lost_frames_are_gaps_and_nothing_is_filled_in() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    let batches = batches(0, 400, Mode::Relay);
    let lost = samples_of(&batches[1..2]);
    let first = samples_of(&batches[..1]);
    // One bit of the second frame.
    let mut bytes = stream(&batches[..1]);
    let at = bytes.len() + 20;
    bytes.extend(stream(&batches[1..]));
    bytes[at] ^= 0x10;
    let peer = Peer::answering(reply, bytes, Then::Stay);
    let run =
        breakaway(&["capture", "--port", &peer.port, "-o", path.to_str().unwrap(), "--seconds", "0.35", "--json"]);
    let document: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    let number = |key: &str| document[key].as_u64().unwrap() as usize;
    assert_eq!((number("samples"), number("missing"), number("gaps")), (350 - lost, lost, 1));
    assert_eq!((number("lost_frames"), number("damaged_frames"), number("dropped_on_board")), (1, 1, 0));
    let recording = read(&path);
    assert_eq!((recording.x.len(), recording.gaps.as_slice()), (350 - lost, &[first][..]));
    assert_eq!(recording.meta["samples missing at gaps"], lost.to_string());
    // Every sample stands at its own time: position k·0.001 rad at k ms.
    assert!(recording.t.iter().zip(&recording.x).all(|(t, x)| (t - x).abs() < 1e-12));
}

/// Waits until the samples are in the part.
fn wait_for_rows(part: &Path, rows: usize) {
    for _ in 0..500 {
        if std::fs::read_to_string(part).is_ok_and(|text| text.lines().count() > rows) {
            return;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    panic!("the rows did not come");
}

#[test]
fn ctrl_c_closes_the_file_properly() {
    for name in ["INT", "TERM"] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        let peer = Peer::answering(reply, stream(&batches(0, 300, Mode::Idle)), Then::Stay);
        let child = start(&["capture", "--port", &peer.port, "-o", path.to_str().unwrap()]);
        wait_for_rows(&folder.path().join("a.csv.part"), 300);
        signal(&child, name);
        let run = child.wait_with_output().unwrap();
        assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
        assert!(String::from_utf8_lossy(&run.stdout).contains("300 samples"));
        assert_eq!((read(&path).x.len(), read(&path).meta["ended"].as_str()), (300, "Ctrl-C"));
        assert_eq!(files(folder.path()), ["a.csv"]);
    }
}

#[test]
fn a_kill_leaves_a_valid_part_and_an_old_file_untouched() {
    let folder = tempfile::tempdir().unwrap();
    let (path, part) = (folder.path().join("a.csv"), folder.path().join("a.csv.part"));
    // What it would replace, if it came to its end.
    let old = "# units: t=s, u=V, x=rad\nt,u,x\n0.0,1.0,2.0\n";
    std::fs::write(&path, old).unwrap();
    let peer = Peer::answering(reply, stream(&batches(0, 300, Mode::Idle)), Then::Stay);
    let arguments = ["capture", "--port", &peer.port, "-o", path.to_str().unwrap()];
    let mut child = start(&arguments);
    wait_for_rows(&part, 300);
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), old);
    assert_eq!(read(&part).x.len(), 300);
    // The next capture does not overwrite it.
    let stderr = failure(&breakaway(&arguments), 1);
    assert_eq!(stderr.matches("an earlier capture was cut off here").count(), 1, "{stderr}");
    assert_eq!(read(&part).x.len(), 300);
}

#[test]
fn a_board_that_is_reset_or_silent_ends_the_capture() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    let mut bytes = stream(&batches(100_000, 100, Mode::Relay));
    // The clock begins anew.
    bytes.extend(stream(&batches(0, 100, Mode::Idle)));
    let peer = Peer::answering(reply, bytes, Then::Stay);
    let run = breakaway(&["capture", "--port", &peer.port, "-o", path.to_str().unwrap()]);
    let stderr = failure(&run, 1);
    assert!(stderr.contains("the board was reset") && stderr.contains("the 100 samples until then"), "{stderr}");
    assert_eq!(read(&path).x.len(), 100);

    let peer = Peer::answering(reply, Vec::new(), Then::Stay);
    let nothing = folder.path().join("b.csv");
    let stderr = failure(&breakaway(&["capture", "--port", &peer.port, "-o", nothing.to_str().unwrap()]), 1);
    assert!(stderr.contains("no answer to `stream on`") && stderr.contains("no sample had come"), "{stderr}");
    assert_eq!(files(folder.path()), ["a.csv"]);
}

#[test]
fn wait_waits_for_the_port() {
    let folder = tempfile::tempdir().unwrap();
    let (path, link) = (folder.path().join("a.csv"), folder.path().join("port"));
    let peer = Peer::answering(reply, stream(&batches(0, 100, Mode::Idle)), Then::Stay);
    let arguments = ["capture", "--port", link.to_str().unwrap(), "-o", path.to_str().unwrap(), "--seconds", "0.099"];
    assert!(failure(&breakaway(&arguments), 1).contains("there is no port"));
    let child = start(&[&arguments[..], &["--wait"]].concat());
    std::thread::sleep(Duration::from_millis(200));
    std::os::unix::fs::symlink(&peer.port, &link).unwrap();
    assert!(child.wait_with_output().unwrap().status.success());
    assert_eq!(read(&path).x.len(), 99);
}
