use std::time::Duration;

use breakaway_core::link::{
    BatchWriter, DriveUnit, Ended, Ending, Event, FaultCause, FaultRecord, Info, Message, Mismatch, Mode, PositionUnit,
    Reply, Sample, Settings, Status, Text,
};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::{Connection, State, draw};
use crate::device::scale::Scale;

fn info() -> Info {
    Info {
        protocol_version: 1,
        schema: 0,
        firmware: Text::try_from("0.1.0").unwrap(),
        build: Text::try_from("0a1b2c3d").unwrap(),
        board: Text::try_from("nucleo-g474re").unwrap(),
        tick_hz: 10_000,
        counts_per_revolution: 0,
        position_per_count: 0.001,
        position_unit: PositionUnit::Radian,
        drive_full_scale: 12.0,
        drive_unit: DriveUnit::Volt,
        current_range_ma: 0,
    }
}

fn state() -> State {
    State::new("/dev/ttyACM0", &info(), Scale::new(&info()).unwrap(), Settings::default())
}

/// Six seconds of a relay-like cycle at every 25th tick, with a gap of ten samples.
fn running() -> State {
    let mut state = state();
    let mut writer = BatchWriter::new(25);
    for k in (0..2400u32).filter(|k| !(1000..1010).contains(k)) {
        let phase = f64::from(k) / 290.0 * std::f64::consts::TAU;
        let sample = Sample {
            tick: 25 * k,
            count: (1257.0 * phase.sin()) as i32,
            drive_code: if phase.sin() < 0.0 { 9557 } else { -9557 },
            reference: 0,
            mode: Mode::Relay,
            current_ma: None,
        };
        if let Some(batch) = writer.push(sample, if k < 1000 { 0 } else { 10 }) {
            state.take(&Message::Samples(batch));
        }
    }
    let status = Status {
        mode: Mode::Relay,
        tick: 60_000,
        count: 0,
        drive_code: 0,
        decimation: 25,
        dropped: 10,
        bad_frames: 0,
        overruns: 0,
        unsaved: true,
        zero_needed: false,
    };
    state.take(&Message::Reply { id: 3, reply: Reply::Status(status) });
    state.traffic(Duration::from_secs(6), 12_000, 2);
    state
}

fn screen(state: &State, plain: bool, width: u16, height: u16) -> String {
    let area = Rect::new(0, 0, width, height);
    let mut buffer = Buffer::empty(area);
    draw(state, plain, area, &mut buffer);
    let lines = (0..height).map(|y| (0..width).map(|x| buffer[(x, y)].symbol()).collect::<String>());
    lines.map(|line| line.trim_end().to_owned() + "\n").collect()
}

#[test]
fn running_at_80_by_24() {
    let mut state = running();
    let ended = Ended { mode: Mode::Track, ending: Ending::TimeUp, tick: 5, ticks: 20_000, saturated: 0 };
    state.take(&Message::Event(Event::ExperimentEnded(ended)));
    let mismatch = Mismatch { direction: -1, speed_bin: 1, position_bin: 3, score: 7.25 };
    state.take(&Message::Event(Event::ModelMismatch(mismatch)));
    insta::assert_snapshot!(screen(&state, false, 80, 24));
}

#[test]
fn plain_characters() {
    insta::assert_snapshot!(screen(&running(), true, 80, 24));
}

#[test]
fn before_anything_has_come() {
    insta::assert_snapshot!(screen(&state(), false, 80, 24));
}

#[test]
fn a_fault_is_seen_with_its_numbers() {
    let mut state = running();
    let record = FaultRecord {
        cause: FaultCause::EncoderFrozen,
        mode: Mode::Relay,
        tick: 60_100,
        count: 12,
        drive_code: 9557,
        value: 5000,
        limit: 5000,
    };
    state.take(&Message::Event(Event::FaultRaised(record)));
    state.frozen = true;
    insta::assert_snapshot!(screen(&state, false, 80, 24));
}

#[test]
fn a_lost_board_is_waited_for() {
    let mut state = running();
    state.connection = Connection::Lost("/dev/ttyACM0 went away (Broken pipe): the board was unplugged".to_owned());
    insta::assert_snapshot!(screen(&state, false, 80, 24));
    state.reconnected(self::state());
    assert!(screen(&state, false, 80, 24).contains("connected again"));
}

#[test]
fn every_size_is_drawn_without_a_panic() {
    let state = running();
    for (width, height) in [(0, 0), (1, 1), (79, 24), (80, 23), (80, 24), (200, 60), (500, 24)] {
        let text = screen(&state, false, width, height);
        assert_eq!(text.contains("missing"), width >= 80 && height >= 24, "{width} × {height}");
    }
    assert!(screen(&state, false, 70, 20).contains("The monitor needs 80 × 24 characters"));
}

/// The newest 5 s of 400 samples/s are kept, however many have come.
#[test]
fn the_curves_keep_their_window() {
    let state = running();
    let (first, last) = (state.points.front().unwrap().t, state.points.back().unwrap().t);
    assert!(last - first <= 5.0 && last - first > 4.99, "{}", last - first);
    assert_eq!(state.stream.totals.missing, 10);
}
