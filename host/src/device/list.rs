//! The serial ports of this machine, and which of them answers.

use std::path::{Path, PathBuf};
use std::time::Duration;

use serialport::SerialPortType;

use super::{Client, share};

/// How long a board may take to answer: it is up, and answers within milliseconds. All ports are asked at once.
const PROBE: Duration = Duration::from_millis(700);
/// Ending of the files that name the pseudo-terminals of virtual boards.
const VIRTUAL: &str = "virtual";

/// A port, and what is behind it.
#[derive(Clone, Debug)]
pub struct Listed {
    /// The port's name.
    pub port: String,
    /// What its USB device calls itself, or that it is a virtual board's.
    pub device: Option<String>,
    /// The board that answers, or why none does.
    pub answer: Result<Answer, String>,
}

/// A board that answers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// Name of the board.
    pub board: String,
    /// Version of its firmware.
    pub firmware: String,
    /// Build of its firmware.
    pub build: String,
    /// Another process holds the port and shares it.
    pub held: bool,
}

/// All ports, each asked once.
pub fn list(baud: u32) -> Vec<Listed> {
    let mut ports: Vec<(String, Option<String>)> = serialport::available_ports()
        .unwrap_or_default()
        .into_iter()
        .map(|found| (found.port_name, usb(&found.port_type)))
        .collect();
    ports.extend(virtual_boards().into_iter().map(|port| (port, Some("virtual board".to_owned()))));
    ports.sort();
    std::thread::scope(|scope| {
        let asked: Vec<_> = ports
            .into_iter()
            .map(|(port, device)| {
                let name = port.clone();
                (port, device, scope.spawn(move || ask(&name, baud)))
            })
            .collect();
        asked
            .into_iter()
            .map(|(port, device, answer)| {
                let answer = answer.join().unwrap_or_else(|_| Err("it could not be asked".to_owned()));
                Listed { port, device, answer }
            })
            .collect()
    })
}

fn ask(port: &str, baud: u32) -> Result<Answer, String> {
    let (client, info) = Client::probe(port, baud, PROBE).map_err(|error| error.to_string())?;
    Ok(Answer {
        board: info.board.as_str().to_owned(),
        firmware: info.firmware.as_str().to_owned(),
        build: info.build.as_str().to_owned(),
        held: client.is_guest(),
    })
}

/// What a USB device calls itself.
fn usb(kind: &SerialPortType) -> Option<String> {
    let SerialPortType::UsbPort(usb) = kind else { return None };
    let names: Vec<&str> = [&usb.manufacturer, &usb.product, &usb.serial_number]
        .into_iter()
        .filter_map(|name| name.as_deref().map(str::trim).filter(|name| !name.is_empty()))
        .collect();
    let id = format!("USB {:04x}:{:04x}", usb.vid, usb.pid);
    Some(if names.is_empty() { id } else { format!("{} ({id})", names.join(" ")) })
}

/// The file by which a virtual board is found, until it is dropped.
#[derive(Debug)]
pub struct Registered(PathBuf);

/// Lets [`list`] find the pseudo-terminal of a virtual board.
///
/// # Errors
/// The file cannot be written.
pub fn register(port: &str) -> std::io::Result<Registered> {
    let path = share::make_folder()?.join(format!("{}.{VIRTUAL}", share::name(port)?));
    std::fs::write(&path, format!("{port}\n{}\n", std::process::id()))?;
    Ok(Registered(path))
}

impl Drop for Registered {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// The pseudo-terminals of the virtual boards that run.
fn virtual_boards() -> Vec<String> {
    let Ok(entries) = std::fs::read_dir(share::folder()) else { return Vec::new() };
    let files =
        entries.flatten().map(|entry| entry.path()).filter(|path| path.extension().is_some_and(|e| e == VIRTUAL));
    files.filter_map(|path| alive(&path)).collect()
}

/// The port in a file, if its process lives. One that was killed has left its file: its pseudo-terminal may be another's by now.
fn alive(path: &Path) -> Option<String> {
    let text = std::fs::read_to_string(path).ok()?;
    let (port, process) = text.trim().split_once('\n')?;
    if lives(process.parse().ok()?) {
        return Some(port.to_owned());
    }
    let _ = std::fs::remove_file(path);
    None
}

#[cfg(unix)]
fn lives(process: i32) -> bool {
    rustix::process::Pid::from_raw(process).is_some_and(|pid| rustix::process::test_kill_process(pid).is_ok())
}

#[cfg(not(unix))]
fn lives(_: i32) -> bool {
    true
}
