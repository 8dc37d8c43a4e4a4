//! Opening a serial port or pseudo-terminal, for ourselves alone.

use std::time::Duration;

use serialport::{ClearBuffer, ErrorKind, SerialPort};

use super::DeviceError;

/// How long the board may take to accept bytes.
pub(super) const WRITE_TIMEOUT: Duration = Duration::from_secs(1);

/// Opens `port` for this process alone: a lock (flock) keeps off every program that asks for it, root's too. The port
/// itself is not closed to others (TIOCEXCL): `device stop` must reach the board when the process that holds the port
/// hangs.
pub(super) fn open(port: &str, baud: u32) -> Result<Box<dyn SerialPort>, DeviceError> {
    let name = port.to_owned();
    // Opened before the port is closed to others, to open it to them again.
    #[cfg(unix)]
    let second = raw(port).ok();
    let opened = serialport::new(port, baud).timeout(WRITE_TIMEOUT).open();
    let opened = opened.map_err(|error| match error.kind() {
        ErrorKind::NoDevice => DeviceError::Busy { port: name.clone() },
        ErrorKind::Io(std::io::ErrorKind::NotFound) => DeviceError::NoPort { port: name.clone() },
        ErrorKind::Io(std::io::ErrorKind::PermissionDenied) => DeviceError::Permission { port: name.clone() },
        _ => {
            let reason = match error.description.as_str() {
                // What the system calls ENOTTY.
                "Not a typewriter" => "it is an ordinary file or a device of another kind".to_owned(),
                other => other.to_owned(),
            };
            DeviceError::NotAPort { port: name.clone(), reason }
        }
    })?;
    #[cfg(unix)]
    if let Some(second) = second {
        // Where it fails the port stays closed to others, which costs `device stop` its last way.
        let _ = rustix::termios::ioctl_tiocnxcl(&second);
    }
    // What was received before we came is of no use; that it cannot be cleared is no harm, the frames tell.
    let _ = opened.clear(ClearBuffer::Input);
    Ok(opened)
}

/// The port beside whoever holds it, without waiting for anything.
///
/// # Errors
/// The system's.
#[cfg(unix)]
pub(super) fn raw(port: &str) -> std::io::Result<std::os::fd::OwnedFd> {
    use rustix::fs::{Mode, OFlags};
    Ok(rustix::fs::open(port, OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC, Mode::empty())?)
}

/// Waits until the port exists, as long as `go_on` says; whether it does.
pub fn wait_for(port: &str, mut go_on: impl FnMut() -> bool) -> bool {
    loop {
        if std::path::Path::new(port).exists() {
            return true;
        }
        if !go_on() {
            return false;
        }
        std::thread::sleep(Duration::from_millis(100));
    }
}
