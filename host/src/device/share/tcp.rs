//! The socket of a shared port where there are no Unix domain sockets: TCP on loopback. The file has the socket's number and
//! a secret, which a guest says first: the file is the user's own, loopback is everybody's.

use std::hash::{BuildHasher, RandomState};
use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::Path;
use std::time::Duration;

/// A connection.
pub(in crate::device) type Stream = TcpStream;

/// Bytes of the secret.
const SECRET: usize = 32;
/// How long a guest may take to say it.
const SAID_WITHIN: Duration = Duration::from_millis(200);

/// The holder's end.
pub(super) struct Listener {
    socket: TcpListener,
    secret: [u8; SECRET],
}

impl Listener {
    /// Listens, and writes to `path` where.
    pub(super) fn bind(path: &Path) -> io::Result<Self> {
        let socket = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
        let mut secret = [0; SECRET];
        for (k, part) in secret.chunks_exact_mut(8).enumerate() {
            // The standard library's hash has a key from the system's randomness, and cannot be told without it.
            part.copy_from_slice(&RandomState::new().hash_one(k).to_le_bytes());
        }
        let mut file = socket.local_addr()?.port().to_le_bytes().to_vec();
        file.extend(secret);
        std::fs::write(path, file)?;
        Ok(Self { socket, secret })
    }

    /// The next guest.
    pub(super) fn accept(&self) -> io::Result<Stream> {
        loop {
            let (mut stream, _) = self.socket.accept()?;
            let mut said = [0; SECRET];
            stream.set_read_timeout(Some(SAID_WITHIN))?;
            if stream.read_exact(&mut said).is_ok() && said == self.secret {
                stream.set_read_timeout(None)?;
                stream.set_nodelay(true)?;
                return Ok(stream);
            }
        }
    }
}

/// A connection to the holder.
pub(super) fn connect(path: &Path) -> io::Result<Stream> {
    let file = std::fs::read(path)?;
    let Some(([low, high], secret)) = file.split_first_chunk() else {
        return Err(io::Error::other("the file is cut short"));
    };
    let mut stream = TcpStream::connect((Ipv4Addr::LOCALHOST, u16::from_le_bytes([*low, *high])))?;
    stream.set_nodelay(true)?;
    stream.write_all(secret)?;
    Ok(stream)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A guest with the file's secret gets in, one without it does not, and the next one does again.
    #[test]
    fn a_guest_needs_the_secret() {
        let folder = tempfile::tempdir().unwrap();
        let (path, wrong) = (folder.path().join("a"), folder.path().join("b"));
        let listener = Listener::bind(&path).unwrap();
        let mut file = std::fs::read(&path).unwrap();
        file[10] ^= 1;
        std::fs::write(&wrong, file).unwrap();
        let mut stranger = connect(&wrong).unwrap();
        let mut guest = connect(&path).unwrap();
        let mut accepted = listener.accept().unwrap();
        guest.write_all(b"here").unwrap();
        let mut bytes = [0; 4];
        accepted.read_exact(&mut bytes).unwrap();
        assert_eq!(&bytes, b"here");
        // Its connection is closed.
        assert!(matches!(stranger.read(&mut bytes), Ok(0) | Err(_)));
    }
}
