//! Commands to the running application. Whatever is sent, each request is answered once and in order. The drive stays
//! within the settings' limit and at zero where nothing runs, and the board still answers at the end.
//!
//! An input is a list of steps: a byte of ticks to wait (times four), a byte of length, a message of that length. The
//! message is put into a frame with its CRC. A length of 251 or more is 32 bytes sent as they are.

use breakaway_core::link::{
    Command, Decoder, Event, MAX_FRAME, MAX_MESSAGE, Message, Reply, Request, Settings, encode,
};
use breakaway_firmware::app::{
    App, Channels, Identity, PowerStage, Sums, Tick, TickSettings, TrackController, Wish, guards,
};
use breakaway_firmware::storage::{Loaded, NoStore};
use breakaway_rig::{Shared, TICK_HZ};
use serde::Serialize;
use serde::ser::SerializeTuple;

use super::mass::Mass;

/// Bytes that are sent without a frame around them.
const RAW_BYTES: usize = 32;
/// Ticks within which a request is answered.
const PATIENCE: u32 = 100;

/// Bytes as postcard writes them: as they are.
struct Raw<'a>(&'a [u8]);

impl Serialize for Raw<'_> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        self.0.iter().try_for_each(|byte| tuple.serialize_element(byte))?;
        tuple.end()
    }
}

/// What the host sees.
struct Host {
    world: Shared<Mass>,
    decoder: Decoder,
    /// Ids that are to be answered.
    waiting: std::collections::VecDeque<u16>,
    /// Settings that were sent, to be in force once they are answered.
    pending: std::collections::VecDeque<(u16, Settings)>,
    drive_max: i16,
    accepted: bool,
}

impl Host {
    fn send(&mut self, message: &[u8]) {
        let mut frame = [0; MAX_FRAME];
        let used = encode(&Raw(message), &mut frame).unwrap();
        match Request::decode(message) {
            Ok(Request { id, command }) => {
                self.waiting.push_back(id);
                if let Command::SetSettings(settings) = command {
                    self.pending.push_back((id, settings));
                }
            }
            Err(rejected) => self.waiting.extend(rejected.id),
        }
        let mut world = self.world.0.borrow_mut();
        // What was sent raw before may lack its end.
        world.to_board.push_back(0);
        world.to_board.extend(&frame[..used]);
    }

    fn receive(&mut self) {
        let bytes = std::mem::take(&mut self.world.0.borrow_mut().from_board);
        for byte in bytes {
            let Some(message) = self.decoder.push(byte) else { continue };
            match Message::decode(message.unwrap()).unwrap() {
                Message::Reply { id, reply } => {
                    assert_eq!(self.waiting.pop_front(), Some(id), "{reply:?}");
                    self.accepted |= !matches!(reply, Reply::Error(_));
                    if self.pending.front().is_some_and(|(pending, _)| *pending == id)
                        && let Some((_, settings)) = self.pending.pop_front()
                        && reply == Reply::Done
                    {
                        self.drive_max = settings.drive_max_code;
                        settings.validate().unwrap();
                    }
                }
                Message::Event(Event::FaultRaised(_)) => assert_eq!(self.world.0.borrow().drive, 0),
                Message::Event(_) => {}
                Message::Samples(batch) => assert!(batch.samples().all(|sample| sample.is_ok())),
            }
        }
    }
}

/// Sends what the bytes say, and looks at what comes back.
pub fn run(bytes: &[u8]) -> bool {
    let world = Shared::<Mass>::default();
    let settings = Settings { position_per_count: 1e-3, drive_full_scale: 5.0, ..Settings::default() };
    let identity = Identity {
        board: "fuzz",
        build: "fuzz",
        tick_hz: TICK_HZ,
        drive_max_code: breakaway_core::link::FULL_SCALE_CODE,
        current_range_ma: 0,
        power_stage: PowerStage::Bridge,
    };
    let mut sums = Sums::new();
    let mut channels = Channels::new();
    let (tick_end, app_end) = channels.split();
    let at_rate = TickSettings::at_rate(TICK_HZ);
    let loaded = Loaded::defaults(settings);
    let guarding = guards(&loaded, &identity);
    let mut tick = Tick::new(world.clone(), TrackController::<f32>::default(), tick_end, at_rate, guarding);
    let mut app =
        App::new(app_end, TrackController::<f32>::default(), world.clone(), NoStore, identity, loaded, &mut sums);
    let mut host = Host {
        world: world.clone(),
        decoder: Decoder::new(),
        waiting: std::collections::VecDeque::new(),
        pending: std::collections::VecDeque::new(),
        drive_max: settings.drive_max_code,
        accepted: false,
    };
    let mut step = |host: &mut Host| {
        let running = tick.limits().drive_code;
        tick.tick();
        let wish = app.poll();
        host.receive();
        let mut world = world.0.borrow_mut();
        let asked = std::mem::take(&mut world.asked);
        assert!(asked <= u32::from(running.max(host.drive_max).unsigned_abs()), "{asked} of {running}");
        world.advance();
        wish
    };
    let mut rest = bytes;
    while let [wait, length, after @ ..] = rest {
        let length = usize::from(*length);
        if length <= MAX_MESSAGE {
            let (message, tail) = after.split_at(length.min(after.len()));
            host.send(message);
            rest = tail;
        } else {
            let (raw, tail) = after.split_at(RAW_BYTES.min(after.len()));
            // A whole frame among the raw bytes would be answered without being waited for.
            host.world.0.borrow_mut().to_board.extend(raw.iter().filter(|byte| **byte != 0));
            rest = tail;
        }
        for _ in 0..=4 * u32::from(*wait) {
            if step(&mut host) == Wish::Reboot {
                return host.accepted;
            }
        }
    }
    let accepted = host.accepted;
    for command in [Command::Stop, Command::Status] {
        let request = Request { id: u16::MAX, command };
        let mut message = [0; MAX_MESSAGE];
        let message = postcard::to_slice(&request, &mut message).unwrap().to_vec();
        host.send(&message);
        let most = PATIENCE * host.waiting.len() as u32 + bytes.len() as u32;
        for _ in 0..most {
            if step(&mut host) == Wish::Reboot {
                return accepted;
            }
        }
        assert!(host.waiting.is_empty(), "no answer to {:?}", host.waiting);
        assert_eq!(host.world.0.borrow().drive, 0, "driven after {:?}", request.command);
    }
    accepted
}
