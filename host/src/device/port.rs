//! Opening a serial port or pseudo-terminal, for ourselves alone.

use std::time::Duration;

use serialport::{ClearBuffer, ErrorKind, SerialPort};

use super::DeviceError;

/// How long the board may take to accept bytes.
const WRITE_TIMEOUT: Duration = Duration::from_secs(1);

/// Opens `port` exclusively (lock and TIOCEXCL: also against other instances of this program, and root).
pub(super) fn open(port: &str, baud: u32) -> Result<Box<dyn SerialPort>, DeviceError> {
    let name = port.to_owned();
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
    // What was received before we came is of no use; that it cannot be cleared is no harm, the frames tell.
    let _ = opened.clear(ClearBuffer::Input);
    Ok(opened)
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
