//! The live monitor: [`State`] takes what the board sends, [`draw`] makes a screen of it, [`watch`] does both on a
//! terminal.

mod beside;
mod draw;
mod state;

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use breakaway_core::link::{Command, Reply};
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEventKind, KeyModifiers};

pub use beside::Beside;
pub use draw::draw;
pub use state::{Connection, State};

use super::scale::Scale;
use super::{Client, DeviceError};
use crate::interrupt::FinishFirst;

/// Time between two screens.
const FRAME: Duration = Duration::from_millis(50);
/// Time between two attempts to reach a board that was unplugged.
const RETRY: Duration = Duration::from_millis(500);
/// Samples per second that make a smooth curve.
const SAMPLES_PER_S: u32 = 400;

/// What a key asks for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Key {
    Quit,
    Interrupt,
    Stop,
    Clear,
    Freeze,
}

/// Watches the board on the terminal until the user quits. A port that another process shares is watched beside it.
///
/// # Errors
/// The board cannot be reached at the start, or the terminal fails. Later losses are shown and waited for.
pub fn watch(port: &str, baud: u32, plain: bool, interrupt: &FinishFirst) -> anyhow::Result<()> {
    // Before the screen changes, so that a message of why not stays to be read.
    let connected = connect(port, baud)?;
    screen(connected, port, baud, plain, interrupt, None)
}

/// Shows the board until the user quits, or until the run beside which it is shown is `over`.
fn screen(
    (mut client, mut state): (Client, State),
    port: &str,
    baud: u32,
    plain: bool,
    interrupt: &FinishFirst,
    over: Option<&AtomicBool>,
) -> anyhow::Result<()> {
    let mut connected = true;
    let mut terminal = ratatui::try_init()?;
    let mut tried = Instant::now();
    let result = loop {
        if connected {
            if let Err(error) = listen(&mut client, &mut state) {
                connected = false;
                state.connection = Connection::Lost(error.to_string());
            }
        } else if tried.elapsed() > RETRY {
            tried = Instant::now();
            // A port that is there but does not answer keeps the screen for the time of the handshake.
            if std::path::Path::new(port).exists()
                && let Ok((new_client, new_state)) = connect(port, baud)
            {
                client = new_client;
                state.reconnected(new_state);
                connected = true;
            }
        }
        if let Err(error) = terminal.draw(|frame| draw(&state, plain, frame.area(), frame.buffer_mut())) {
            break Err(error.into());
        }
        let key = match key(if connected { Duration::ZERO } else { FRAME }) {
            Ok(key) => key,
            Err(error) => break Err(error.into()),
        };
        match key {
            _ if interrupt.requested() || over.is_some_and(|over| over.load(Ordering::SeqCst)) => break Ok(()),
            Some(Key::Interrupt) => {
                // The terminal makes a key of what would be a signal: the run beside is told.
                interrupt.request();
                break Ok(());
            }
            Some(Key::Quit) => break Ok(()),
            Some(Key::Freeze) => state.frozen = !state.frozen,
            Some(Key::Stop) if connected => command(&mut client, &mut state, Command::Stop),
            Some(Key::Clear) if connected => {
                command(&mut client, &mut state, Command::ClearFault);
                if let Ok(Reply::Fault(fault)) = client.request(Command::GetFault) {
                    state.fault = fault;
                }
            }
            _ => {}
        }
    };
    ratatui::restore();
    if connected {
        // The board goes on streaming to nobody otherwise; that it does not answer any more is no loss.
        let _ = client.done(Command::StreamOff);
    }
    result
}

/// Connects, and asks for everything that does not come by itself.
fn connect(port: &str, baud: u32) -> Result<(Client, State), DeviceError> {
    let (mut client, info) = Client::connect(port, baud)?;
    let shared = client.offer();
    let scale = Scale::new(&info)?;
    let Reply::Settings(settings) = client.request(Command::GetSettings)? else {
        return Err(DeviceError::Nonsense { command: "settings get" });
    };
    let Reply::Fault(fault) = client.request(Command::GetFault)? else {
        return Err(DeviceError::Nonsense { command: "fault" });
    };
    let decimation = (info.tick_hz / SAMPLES_PER_S).clamp(1, u32::from(u16::MAX)) as u16;
    client.done(Command::StreamOn { decimation })?;
    let mut state = State::new(port, &info, scale, settings);
    state.fault = fault;
    if client.is_guest() {
        state.note("another breakaway process holds the port: this one watches, and can stop it".to_owned());
    } else if let Err(error) = shared {
        state.note(format!("the port is not shared with other processes: {error}"));
    }
    Ok((client, state))
}

/// Takes what comes during one frame.
fn listen(client: &mut Client, state: &mut State) -> Result<(), DeviceError> {
    let until = Instant::now() + FRAME;
    while let Some(left) = until.checked_duration_since(Instant::now()) {
        if let Some(message) = client.receive(left)? {
            state.take(&message);
        }
    }
    let counters = client.counters();
    state.traffic(state.started.elapsed(), counters.bytes(), counters.bad_frames());
    Ok(())
}

fn command(client: &mut Client, state: &mut State, command: Command) {
    let name = super::text::command_name(&command);
    let text = match client.done(command) {
        Ok(()) => format!("{name}: done"),
        Err(error) => error.to_string(),
    };
    state.note(text);
}

/// The key pressed within `wait`, if it means something.
fn key(wait: Duration) -> std::io::Result<Option<Key>> {
    if !event::poll(wait)? {
        return Ok(None);
    }
    let Event::Key(key) = event::read()? else { return Ok(None) };
    if key.kind != KeyEventKind::Press {
        return Ok(None);
    }
    Ok(match key.code {
        KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => Some(Key::Interrupt),
        KeyCode::Char('q') | KeyCode::Esc => Some(Key::Quit),
        KeyCode::Char('s') => Some(Key::Stop),
        KeyCode::Char('c') => Some(Key::Clear),
        KeyCode::Char(' ') => Some(Key::Freeze),
        _ => None,
    })
}

#[cfg(test)]
mod tests;
