//! Set-points that are sent while the axis moves, and processes that share the port, all of them real.

use std::io::Write as _;
use std::process::{Child, Command as Process, Stdio};
use std::time::{Duration, Instant};

use breakaway::command::run::papers_plant;
use breakaway::device::share::folder;
use breakaway::device::virtual_board::VirtualBoard;
use breakaway::device::{Client, DeviceError};
use breakaway_core::link::{BAUD, Message, Mode};

use crate::bench::{options, start};
use crate::identify::{breakaway, program, refused};

/// `x = 0.5·(1 − cos πt)` each 10 ms, `count` lines.
fn cosine(count: u32) -> String {
    let line = |k: u32| {
        let t = 0.01 * f64::from(k);
        format!("{t:.2},{:.6}\n", 0.5 * (1.0 - (std::f64::consts::PI * t).cos()))
    };
    (0..count).map(line).collect()
}

/// A board five times slower than real time, and the papers' model: a host that is held up by other work is still in time.
fn board() -> (VirtualBoard, tempfile::TempDir, String) {
    let mut slow = options(&papers_plant());
    slow.speed = 0.2;
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("model.toml");
    papers_plant().write(&model).unwrap();
    (start(&slow), folder, model.display().to_string())
}

/// A file is read faster than real time: the board takes what it has room for, and follows all of it. What is left of the
/// error is the encoder's rounding, 0.29 steps, and less than one more at break-away.
#[test]
fn a_file_of_set_points_is_followed() {
    needs_qemu!();
    let (board, folder, model) = board();
    let file = folder.path().join("reference.csv");
    std::fs::write(&file, format!("time_s,position\n{}", cosine(101))).unwrap();
    let (file, output) = (file.display().to_string(), folder.path().join("out").display().to_string());
    std::fs::create_dir(&output).unwrap();
    let arguments = ["track", "--model", &model, "--port", &board.port, "--follow", &file, "-o", &output];
    let done = breakaway(&arguments);
    assert_eq!((&done["set_points"], &done["dry"], &done["missing"]), (&100.into(), &0.into(), &0.into()), "{done}");
    assert!(done["rms_steps"].as_f64().unwrap() < 1.3, "{done}");
    // One second of motion, and the wait for the first four.
    assert!((1.0..1.5).contains(&done["duration_s"].as_f64().unwrap()), "{done}");
    assert!(std::path::Path::new(done["recording"].as_str().unwrap()).is_file(), "{done}");

    // A line that the board refuses is named, and the axis is stopped.
    let far = folder.path().join("far.csv").display().to_string();
    std::fs::write(&far, format!("{}0.30,90\n0.31,90\n", cosine(30))).unwrap();
    let said = refused(&["track", "--model", &model, "--port", &board.port, "--follow", &far]);
    assert!(said.contains("far.csv, line 31: ") && said.contains("set-point position is out of range"), "{said}");
    assert_eq!(board.seen().unwrap().code, 0);
}

/// `track --follow -` with a pipe that has said so much and stays open.
fn piped(board: &VirtualBoard, model: &str, lines: &str, hold: &str) -> Child {
    // What a test that was killed has left of a pseudo-terminal of this name.
    let _ = std::fs::remove_file(socket(&board.port));
    let mut child = Process::new(program())
        .args(["track", "--model", model, "--port", &board.port, "--follow", "-", "--hold", hold])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.as_mut().unwrap().write_all(lines.as_bytes()).unwrap();
    child
}

/// Its standard error, once it has ended by itself, with code 1.
fn failed(child: Child) -> String {
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    said
}

/// The socket of a pseudo-terminal that is shared.
fn socket(port: &str) -> std::path::PathBuf {
    folder().join(format!("{}.sock", port.trim_start_matches("/dev/").replace('/', "-")))
}

/// Watches beside the process that holds the port, until the axis is tracked.
fn watch(port: &str) -> Client {
    let begin = Instant::now();
    // Before that the port is free, and this process would take it.
    while !socket(port).exists() {
        assert!(begin.elapsed() < Duration::from_secs(60), "nothing to watch");
        std::thread::sleep(Duration::from_millis(5));
    }
    let mut guest = loop {
        match Client::connect(port, BAUD) {
            Ok((guest, _)) => break guest,
            // The socket has its name a moment before the process listens to it.
            Err(DeviceError::Busy { .. }) => assert!(begin.elapsed() < Duration::from_secs(60), "nobody listens"),
            Err(error) => panic!("{error}"),
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    assert!(guest.is_guest());
    loop {
        if let Some(Message::Samples(batch)) = guest.receive(Duration::from_millis(20)).unwrap()
            && batch.samples().any(|sample| sample.unwrap().mode == Mode::Track)
        {
            return guest;
        }
        assert!(begin.elapsed() < Duration::from_secs(60), "no samples");
    }
}

/// A pipe that dries up: the axis rests at the last set-point, then the run ends, and the program says so.
#[test]
fn a_pipe_that_dries_up_ends_the_run() {
    needs_qemu!();
    let (board, _folder, model) = board();
    let mut child = piped(&board, &model, &cosine(40), "0.2");
    // The pipe stays open: it is not the end of the file.
    let pipe = child.stdin.take();
    let said = failed(child);
    assert!(said.contains("no set-points for 0.200 s (--hold)"), "{said}");
    assert_eq!(board.seen().unwrap().code, 0);
    drop(pipe);
}

/// A second process watches the samples of the run that another one drives, and a third one stops it.
#[test]
fn a_run_of_one_process_is_watched_and_stopped_by_others() {
    needs_qemu!();
    let (board, _folder, model) = board();
    let child = piped(&board, &model, &cosine(60), "1000");
    let guest = watch(&board.port);
    let stopped = breakaway(&["device", "--port", &board.port, "stop"]);
    assert_eq!(stopped["way"], "holder", "{stopped}");
    let said = failed(child);
    assert!(said.contains("the run was stopped"), "{said}");
    assert_eq!(board.seen().unwrap().code, 0);
    drop(guest);
}

/// The process that drives hangs. The link's time-out of this board is 20 s of its own time, 100 s of the host's.
/// The stop, which goes past the process, ends the run.
#[test]
fn a_run_whose_process_hangs_is_stopped() {
    needs_qemu!();
    let said = stopped_past_its_process(|_| ());
    assert!(said.contains("the run was stopped") || said.contains("set-points"), "{said}");
}

/// The same where others read all that the board says meanwhile, the end of the run too. The process ends nevertheless.
#[test]
fn a_run_whose_end_others_have_read_ends() {
    needs_qemu!();
    let drain = |port: &str| {
        assert_eq!(Process::new("timeout").args(["1", "cat", port]).output().unwrap().status.code(), Some(124));
    };
    let said = stopped_past_its_process(drain);
    assert!(said.contains("set-points: the run is over"), "{said}");
}

/// Standard error of a process that hangs until another has stopped its run, and `meanwhile` is done with its port.
fn stopped_past_its_process(meanwhile: impl Fn(&str)) -> String {
    let (board, _folder, model) = board();
    let child = piped(&board, &model, &cosine(60), "1000");
    drop(watch(&board.port));
    let signal = |name: &str| {
        assert!(Process::new("kill").args([name, &child.id().to_string()]).status().unwrap().success());
    };
    signal("-STOP");
    let stopped = breakaway(&["device", "--port", &board.port, "stop"]);
    assert_eq!(stopped["way"], "past_holder", "{stopped}");
    assert_eq!(board.seen().unwrap().code, 0);
    meanwhile(&board.port);
    signal("-CONT");
    failed(child)
}
