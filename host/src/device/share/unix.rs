//! The socket of a shared port where there are Unix domain sockets.

use std::io;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::Path;

/// A connection.
pub(in crate::device) type Stream = UnixStream;

/// The holder's end.
pub(super) struct Listener(UnixListener);

impl Listener {
    /// Listens at `path`. A socket that a process has left behind is replaced: who holds the port is alone here.
    pub(super) fn bind(path: &Path) -> io::Result<Self> {
        match std::fs::remove_file(path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
        UnixListener::bind(path).map(Self)
    }

    /// The next guest.
    pub(super) fn accept(&self) -> io::Result<Stream> {
        self.0.accept().map(|(stream, _)| stream)
    }
}

/// A connection to the holder.
pub(super) fn connect(path: &Path) -> io::Result<Stream> {
    UnixStream::connect(path)
}
