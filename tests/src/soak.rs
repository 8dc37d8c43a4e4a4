//! The soak: the virtual board streams at every tick over a cable that picks up noise, for as long as one likes. Nothing may
//! be lost but frames that were hit, nothing may arrive that was not sent, and the board drops nothing.

use std::collections::VecDeque;
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

use breakaway::command::run::papers_plant;
use breakaway::command::virtual_board::settings;
use breakaway::device::stream::{Row, Stream, Totals};
use breakaway::device::virtual_board::{Fault, Machine, Options, Seen, Traffic, VirtualBoard};
use breakaway::device::{Client, DeviceError};
use breakaway_core::link::{BAUD, Bounds, Command, FULL_SCALE_CODE, Message, Mode, Reference, Relay, Status};

/// Ticks per second, and of real time.
const TICK_HZ: u32 = 1000;
/// How often a command is sent that must be answered.
const ASK: Duration = Duration::from_secs(1);
/// How long the link is left alone before its frames are counted.
const QUIET: Duration = Duration::from_millis(400);
/// Ticks of the plant's side that are kept to compare with: more than are ever on their way.
const KEPT: usize = 200_000;

/// What came out.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// Bytes of a million that were hit, either way.
    pub ppm: u32,
    /// Time under noise.
    pub time: Duration,
    /// Over the cable, from the stream's start to its end.
    pub traffic: Traffic,
    /// Frames that the host received whole in that time.
    pub received: u64,
    /// Frames that it received damaged.
    pub damaged: u64,
    /// The samples.
    pub stream: Totals,
    /// Samples that were compared with the drive that the plant was given in that tick.
    pub compared: u64,
    /// Those of them that differ.
    pub wrong: u64,
    /// Commands sent, and those of them that were not answered.
    pub asked: u64,
    /// See `asked`.
    pub unanswered: u64,
    /// What the board says at the end.
    pub board: Status,
}

impl Outcome {
    /// Frames of the board that did not arrive.
    pub fn lost(&self) -> u64 {
        self.traffic.from_board.frames.saturating_sub(self.received)
    }

    /// What should not be.
    pub fn failures(&self) -> Vec<String> {
        let (up, down) = (self.traffic.from_board, self.traffic.to_board);
        let rules = [
            (self.received <= up.frames, format!("{} frames received of {}", self.received, up.frames)),
            (self.lost() <= up.hit, format!("{} frames lost where {} were hit", self.lost(), up.hit)),
            (self.stream.lost_batches <= self.lost(), format!("{} batches lost", self.stream.lost_batches)),
            (self.stream.gaps <= self.stream.lost_batches, format!("{} gaps", self.stream.gaps)),
            (self.stream.dropped == 0 && self.board.dropped == 0, format!("{} samples dropped", self.board.dropped)),
            (self.wrong == 0, format!("{} samples are not what was driven", self.wrong)),
            (2 * self.compared > self.stream.samples, format!("only {} samples were compared", self.compared)),
            (self.unanswered <= up.hit + down.hit, format!("{} commands unanswered", self.unanswered)),
            (self.stream.samples > 0 && self.board.mode == Mode::Idle, "the board did not run to the end".to_owned()),
        ];
        rules.into_iter().filter(|(holds, _)| !holds).map(|(_, what)| what).collect()
    }

    /// A table for docs/hard-to-break.md.
    pub fn table(&self) -> String {
        let (up, down) = (self.traffic.from_board, self.traffic.to_board);
        let hits = |c: breakaway::device::virtual_board::Counts| {
            format!("{} flipped, {} lost, {} with garbage before", c.flipped, c.dropped, c.inserted)
        };
        let rows = [
            ("time, noise", format!("{:.1} min, {} ppm of the bytes", self.time.as_secs_f64() / 60.0, self.ppm)),
            ("bytes from the board", format!("{}: {}", up.bytes, hits(up))),
            ("bytes to the board", format!("{}: {}", down.bytes, hits(down))),
            ("frames from the board: sent, hit, lost", format!("{}, {}, {}", up.frames, up.hit, self.lost())),
            ("samples received, missing", format!("{}, {}", self.stream.samples, self.stream.missing)),
            ("… missing outside lost frames", format!("{}", self.stream.gaps.saturating_sub(self.stream.lost_batches))),
            ("… compared with what was driven, different", format!("{}, {}", self.compared, self.wrong)),
            ("… dropped by the board", self.board.dropped.to_string()),
            ("commands asked, unanswered", format!("{}, {}", self.asked, self.unanswered)),
            ("frames the board threw away", format!("{} ({} to it were hit)", self.board.bad_frames, down.hit)),
        ];
        let lines = rows.map(|(what, value)| format!("| {what} | {value} |\n"));
        format!("| | |\n|---|---|\n{}", lines.concat())
    }
}

/// Runs it on the papers' plant, a relay experiment at 1 kHz in real time.
///
/// # Errors
/// The board or its client ends.
pub fn soak(time: Duration, ppm: u32, seed: u64) -> Result<Outcome, Box<dyn std::error::Error>> {
    let board = VirtualBoard::start(&options(seed))?;
    let (mut client, _) = Client::connect(&board.port, BAUD)?;
    std::thread::sleep(QUIET);
    let before = (board.traffic(), client.counters().good_frames(), client.counters().bad_frames());
    let mut driven = Driven { seen: board.watch(), first: 0, codes: VecDeque::new(), offset: None };
    client.done(Command::StreamOn { decimation: 1 })?;
    client.done(Command::StartRelay(relay()))?;
    board.inject(Fault::LinkNoise(ppm));
    let mut taken = Taken::default();
    let (start, mut asked_at) = (Instant::now(), Instant::now());
    let (mut asked, mut unanswered) = (0, 0);
    while start.elapsed() < time {
        taken.message(client.receive(Duration::from_millis(20))?, &mut driven);
        if asked_at.elapsed() >= ASK {
            asked_at = Instant::now();
            asked += 1;
            match client.status() {
                Ok(_) => {}
                Err(DeviceError::Silent { .. }) => unanswered += 1,
                Err(error) => return Err(error.into()),
            }
        }
    }
    let time = start.elapsed();
    board.inject(Fault::LinkNoise(0));
    std::thread::sleep(QUIET / 4);
    client.done(Command::Stop)?;
    client.done(Command::StreamOff)?;
    let quiet = Instant::now();
    while quiet.elapsed() < QUIET {
        taken.message(client.receive(Duration::from_millis(20))?, &mut driven);
    }
    let status = client.status()?;
    while let Some(message) = client.receive(QUIET / 4)? {
        taken.message(Some(message), &mut driven);
    }
    let counters = client.counters();
    Ok(Outcome {
        ppm,
        time,
        traffic: board.traffic().since(before.0),
        received: counters.good_frames() - before.1,
        damaged: counters.bad_frames() - before.2,
        stream: taken.stream.totals,
        compared: taken.compared,
        wrong: taken.wrong,
        asked,
        unanswered,
        board: status,
    })
}

fn options(seed: u64) -> Options {
    let model = papers_plant();
    let machine = Machine {
        base: model.base,
        effects: Vec::new(),
        tick_hz: TICK_HZ,
        encoder_step: 1e-3,
        noise: 0.0,
        drive_full_scale: 5.0,
        seed,
    };
    let mut settings = settings(&machine, &model, 40.0);
    // Ten lost in a row of the client's words that it is there.
    settings.command_timeout_ms = 20_000;
    Options { image: None, machine, settings, speed: 1.0, flash: None, faults: Vec::new(), cable: true }
}

fn relay() -> Relay {
    let code = |volts: f64| (volts / 5.0 * f64::from(FULL_SCALE_CODE)).round() as i16;
    Relay {
        h1_code: code(2.0),
        h2_code: code(1.5),
        hysteresis_counts: Some(1),
        reference: Reference::default(),
        until_settled: false,
        append: false,
        bounds: Bounds::default(),
    }
}

#[derive(Default)]
struct Taken {
    stream: Stream,
    rows: Vec<Row>,
    wrong: u64,
    compared: u64,
}

impl Taken {
    fn message(&mut self, message: Option<Message>, driven: &mut Driven) {
        let Some(Message::Samples(batch)) = message else { return };
        self.rows.clear();
        // A batch from before is one that was not sent.
        self.wrong += u64::from(self.stream.take(&batch, &mut self.rows).is_err());
        driven.follow(&self.rows);
        if driven.offset.is_some() {
            self.wrong += self.rows.iter().filter(|row| driven.at(row.tick) != Some(row.drive_code)).count() as u64;
            self.compared += self.rows.len() as u64;
        }
    }
}

/// The drive codes of the last ticks, as the plant was given them.
struct Driven {
    seen: Receiver<Seen>,
    /// Tick of the first code, as the plant's side counts them.
    first: u64,
    codes: VecDeque<i16>,
    /// From the board's ticks to the plant's: it is found where the drive first switches.
    offset: Option<i64>,
}

impl Driven {
    /// Takes what has been driven, and finds the offset.
    fn follow(&mut self, rows: &[Row]) {
        while let Ok(seen) = self.seen.try_recv() {
            if self.codes.is_empty() {
                self.first = seen.tick;
            }
            self.codes.push_back(seen.code);
            if self.codes.len() > KEPT {
                self.codes.pop_front();
                self.first += 1;
            }
        }
        let switches = rows.windows(2).any(|pair| pair[0].drive_code != pair[1].drive_code);
        if self.offset.is_none() && switches {
            self.offset = (-2..=2).find(|&offset| {
                rows.iter().all(|row| self.code(row.tick.cast_signed() + offset) == Some(row.drive_code))
            });
        }
    }

    fn at(&self, tick: u64) -> Option<i16> {
        self.code(tick.cast_signed() + self.offset?)
    }

    fn code(&self, tick: i64) -> Option<i16> {
        let index = tick.checked_sub_unsigned(self.first)?;
        self.codes.get(usize::try_from(index).ok()?).copied()
    }
}
