//! The other end of a port: it answers requests from a table and sends what it is told.

use std::fs::File;
use std::io::{Read as _, Write as _};
use std::process::{Child, Command as Process, Output, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use breakaway_core::link::*;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode as Permissions, OFlags};
use rustix::io::ioctl_fionread;
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};

/// Ticks per second of the scripted board.
pub const TICK_HZ: u32 = 1000;

pub fn info() -> Info {
    Info {
        protocol_version: PROTOCOL_VERSION,
        schema: SCHEMA,
        firmware: "0.0.1".try_into().unwrap(),
        build: "abcdef".try_into().unwrap(),
        board: "script".try_into().unwrap(),
        tick_hz: TICK_HZ,
        counts_per_revolution: 0,
        position_per_count: 0.001,
        position_unit: PositionUnit::Radian,
        drive_full_scale: 12.0,
        drive_unit: DriveUnit::Volt,
        current_range_ma: 0,
    }
}

pub fn status(mode: Mode) -> Reply {
    Reply::Status(Status {
        mode,
        tick: 0,
        count: 0,
        drive_code: 0,
        decimation: 0,
        dropped: 0,
        bad_frames: 0,
        overruns: 0,
        unsaved: false,
        zero_needed: false,
    })
}

/// What a board answers that has nothing to say.
pub fn reply(command: &Command) -> Reply {
    match command {
        Command::Hello => Reply::Info(info()),
        Command::Status => status(Mode::Idle),
        Command::GetSettings => Reply::Settings(Settings::default()),
        Command::GetModel => Reply::Model(None),
        Command::GetFault => Reply::Fault(None),
        _ => Reply::Done,
    }
}

pub fn frame(message: &impl serde::Serialize) -> Vec<u8> {
    let mut frame = [0; MAX_FRAME];
    let used = encode(message, &mut frame).unwrap();
    frame[..used].to_vec()
}

/// Batches of `samples` samples in mode `mode` from tick `first` on: position k·0.001 rad, drive ±1 V turning every 50.
pub fn batches(first: u32, samples: u32, mode: Mode) -> Vec<Batch> {
    let mut writer = BatchWriter::new(1);
    let sample = |k: u32| Sample {
        tick: first + k,
        count: k.cast_signed(),
        drive_code: if (k / 50).is_multiple_of(2) { 2731 } else { -2731 },
        reference: 0,
        mode,
        current_ma: None,
    };
    let mut batches: Vec<Batch> = (0..samples).filter_map(|k| writer.push(sample(k), 0)).collect();
    batches.extend(writer.flush(0));
    batches
}

pub fn samples_of(batches: &[Batch]) -> usize {
    batches.iter().map(|batch| batch.samples().count()).sum()
}

/// The far end of a pseudo-terminal, for as long as it lives.
pub struct Peer {
    pub port: String,
    unplug: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// What to do after the bytes have been sent.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Then {
    Stay,
    Unplug,
}

impl Peer {
    /// A peer that sends what `script` makes of each request; before anything, `greeting`.
    pub fn new(greeting: Vec<u8>, mut script: impl FnMut(Request) -> (Vec<u8>, Then) + Send + 'static) -> Self {
        // Close-on-exec, both: the program under test must not hold the far end of its own port.
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC).unwrap();
        grantpt(&master).unwrap();
        unlockpt(&master).unwrap();
        let port = ptsname(&master, Vec::new()).unwrap().into_string().unwrap();
        // Kept open, or the master hangs up whenever the program under test closes it.
        let slave =
            rustix::fs::open(&port, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Permissions::empty()).unwrap();
        let mut master = File::from(master);
        let unplug = Arc::new(AtomicBool::new(false));
        let ending = Arc::clone(&unplug);
        let thread = std::thread::spawn(move || {
            let mut decoder = Decoder::new();
            let mut buffer = [0; 1024];
            let mut greeting = Some(greeting);
            while !ending.load(Ordering::Relaxed) {
                let wait = Timespec { tv_sec: 0, tv_nsec: 10_000_000 };
                if poll(&mut [PollFd::new(&master, PollFlags::IN)], Some(&wait)).unwrap() == 0 {
                    continue;
                }
                let count = master.read(&mut buffer).unwrap();
                if let Some(greeting) = greeting.take() {
                    master.write_all(&greeting).unwrap();
                }
                for byte in &buffer[..count] {
                    let Some(Ok(bytes)) = decoder.push(*byte) else { continue };
                    let (answer, then) = script(Request::decode(bytes).unwrap());
                    master.write_all(&answer).unwrap();
                    if then == Then::Unplug {
                        // What has been sent is read first: a real cable has delivered its bytes when it is pulled.
                        while ioctl_fionread(&slave).unwrap() > 0 {
                            std::thread::sleep(Duration::from_millis(5));
                        }
                        std::thread::sleep(Duration::from_millis(100));
                        return;
                    }
                }
            }
        });
        Self { port, unplug, thread: Some(thread) }
    }

    /// A peer that answers every request with `answer` and, after that to `StreamOn`, sends `stream`.
    pub fn answering(answer: impl Fn(&Command) -> Reply + Send + 'static, stream: Vec<u8>, then: Then) -> Self {
        Self::new(Vec::new(), move |Request { id, command }| {
            let mut bytes = frame(&Message::Reply { id, reply: answer(&command) });
            if !matches!(command, Command::StreamOn { .. }) {
                return (bytes, Then::Stay);
            }
            bytes.extend(&stream);
            (bytes, then)
        })
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        self.unplug.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let result = thread.join();
            if !std::thread::panicking() {
                result.unwrap();
            }
        }
    }
}

pub fn start(arguments: &[&str]) -> Child {
    Process::new(env!("CARGO_BIN_EXE_breakaway"))
        .args(arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

pub fn breakaway(arguments: &[&str]) -> Output {
    start(arguments).wait_with_output().unwrap()
}

/// Standard error of a run that must have failed with `code`. Standard output is empty, or has the error as a document.
pub fn failure(output: &Output, code: i32) -> String {
    let stderr = String::from_utf8(output.stderr.clone()).unwrap();
    assert_eq!(output.status.code(), Some(code), "{stderr}");
    if !output.stdout.is_empty() {
        let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(stderr.contains(document["error"]["message"].as_str().unwrap()), "{document}");
    }
    stderr
}

pub fn signal(child: &Child, name: &str) {
    let status = Process::new("kill").args([&format!("-{name}"), &child.id().to_string()]).status().unwrap();
    assert!(status.success());
}
