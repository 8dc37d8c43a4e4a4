//! QEMU, as a child that does not outlive us.

use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use rand::{Rng as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::VirtualBoardError;
use super::image::in_images;
use super::lockstep::Lockstep;

const QEMU: &str = "qemu-system-arm";
/// Names another program.
const VARIABLE: &str = "BREAKAWAY_QEMU";
/// How long QEMU may take to come up.
const START: Duration = Duration::from_secs(20);

/// Ends QEMU when this program's end of the pipe is closed, also by a kill that leaves no time to clean up.
const SHELL: &str =
    r#"exec 3<&0; "$@" </dev/null 3<&- & qemu=$!; cat <&3 >/dev/null; kill $qemu 2>/dev/null; wait $qemu"#;

/// A running QEMU.
#[derive(Debug)]
pub(super) struct Qemu {
    child: Child,
    /// The pseudo-terminal of the link.
    pub port: String,
    monitor: UnixStream,
    log: PathBuf,
    /// Sockets and log; removed at the end.
    _folder: tempfile::TempDir,
}

impl Qemu {
    /// Starts it; the lock-step is connected, the firmware about to announce itself.
    pub(super) fn start(image: &Path, flash: Option<&Path>) -> Result<(Self, Lockstep), VirtualBoardError> {
        let program = find()?;
        let folder = tempfile::Builder::new().prefix("breakaway").tempdir()?;
        let plant = UnixListener::bind(folder.path().join("plant"))?;
        let control = UnixListener::bind(folder.path().join("monitor"))?;
        let log = folder.path().join("log");
        let output = std::fs::File::create(&log)?;
        let socket = |name: &str| format!("socket,id={name},path={}", folder.path().join(name).display());
        let mut semihosting = "enable=on,target=native,arg=image".to_owned();
        if let Some(flash) = flash {
            if !flash.exists() {
                std::fs::write(flash, [])?;
            }
            // A comma is doubled in QEMU's options.
            let name = std::fs::canonicalize(flash)?.display().to_string().replace(',', ",,");
            semihosting = format!("{semihosting},arg={name}");
        }
        let mut command = Command::new("sh");
        command.args(["-c", SHELL, "sh"]).arg(program);
        command.args(["-M", "mps2-an386", "-display", "none", "-nodefaults", "-kernel"]).arg(image);
        command.args(["-chardev", "pty,id=link", "-serial", "chardev:link"]);
        command.args(["-chardev", &socket("plant"), "-serial", "chardev:plant"]);
        command.args(["-chardev", &socket("monitor"), "-mon", "chardev=monitor,mode=readline"]);
        command.args(["-semihosting-config", &semihosting]);
        command.stdin(Stdio::piped()).stdout(output.try_clone()?).stderr(output);
        let mut child = command.spawn()?;
        let connected =
            accept(&plant, &mut child, &log).and_then(|plant| Ok((plant, accept(&control, &mut child, &log)?)));
        let (plant, monitor) = match connected {
            Ok(connected) => connected,
            Err(error) => {
                let _ = child.kill();
                let _ = child.wait();
                return Err(error);
            }
        };
        let mut qemu = Self { child, port: String::new(), monitor, log, _folder: folder };
        qemu.port = qemu.pseudo_terminal()?;
        Ok((qemu, Lockstep::new(plant)?))
    }

    /// What QEMU prints of its pseudo-terminal: `char device redirected to /dev/pts/3 (label link)`.
    fn pseudo_terminal(&self) -> Result<String, VirtualBoardError> {
        let start = Instant::now();
        while start.elapsed() < START {
            let log = BufReader::new(std::fs::File::open(&self.log)?);
            for line in log.lines() {
                let line = line?;
                let rest = line.split_once("redirected to ").map(|(_, rest)| rest);
                if let Some((port, _)) = rest.and_then(|rest| rest.split_once(' ')) {
                    return Ok(port.to_owned());
                }
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        Err(VirtualBoardError::NotStarted("it names no pseudo-terminal".into()))
    }

    /// Resets the board, as its reset pin would.
    pub(super) fn reset(&mut self) -> Result<(), VirtualBoardError> {
        self.monitor.write_all(b"system_reset\n").map_err(|error| VirtualBoardError::Lost(error.to_string()))?;
        // The monitor echoes; nobody else reads it.
        self.monitor.set_read_timeout(Some(Duration::from_millis(20)))?;
        let mut echo = [0; 1024];
        while matches!(self.monitor.read(&mut echo), Ok(1..)) {}
        Ok(())
    }

    /// Noise on the link, as if the host had sent it: the same at every call.
    pub(super) fn garbage(&self, bytes: u16) -> Result<(), VirtualBoardError> {
        let mut noise = vec![0; bytes.into()];
        ChaCha8Rng::seed_from_u64(0).fill_bytes(&mut noise);
        let mut port = std::fs::OpenOptions::new().write(true).open(&self.port)?;
        // The board reads between its ticks, which are not to wait for it. If it ends before, nobody misses the noise.
        std::thread::spawn(move || drop(port.write_all(&noise)));
        Ok(())
    }

    /// Why it ended, with what QEMU said.
    pub(super) fn epitaph(&mut self, what: &str) -> VirtualBoardError {
        let said = std::fs::read_to_string(&self.log).unwrap_or_default();
        let said: Vec<&str> = said.lines().filter(|line| !line.contains("redirected to")).collect();
        let said = if said.is_empty() { String::new() } else { format!(": {}", said.join("; ")) };
        VirtualBoardError::Lost(format!("{what}{said}"))
    }
}

impl Drop for Qemu {
    fn drop(&mut self) {
        // The shell ends QEMU.
        drop(self.child.stdin.take());
        let _ = self.child.wait();
    }
}

/// The program that `BREAKAWAY_QEMU` names; else the script that `cargo xtask image` has written beside the image, where it
/// found none installed; else the one installed.
///
/// # Errors
/// [`VirtualBoardError::NotQemu`], [`VirtualBoardError::NoQemu`].
pub fn find() -> Result<PathBuf, VirtualBoardError> {
    let starts = |program: &PathBuf| {
        let said = Command::new(program).arg("--version").stdin(Stdio::null()).output();
        said.is_ok_and(|output| output.status.success())
    };
    if let Some(named) = std::env::var_os(VARIABLE).map(PathBuf::from) {
        return if starts(&named) { Ok(named) } else { Err(VirtualBoardError::NotQemu(named.display().to_string())) };
    }
    let mut programs = in_images(QEMU).into_iter().chain([PathBuf::from(QEMU)]);
    programs.find(starts).ok_or(VirtualBoardError::NoQemu)
}

/// Waits for QEMU to connect, unless it ends before.
fn accept(listener: &UnixListener, child: &mut Child, log: &Path) -> Result<UnixStream, VirtualBoardError> {
    listener.set_nonblocking(true)?;
    let start = Instant::now();
    loop {
        match listener.accept() {
            Ok((stream, _)) => {
                stream.set_nonblocking(false)?;
                return Ok(stream);
            }
            Err(error) if error.kind() == std::io::ErrorKind::WouldBlock => {}
            Err(error) => return Err(error.into()),
        }
        let ended = child.try_wait()?.is_some();
        let said = std::fs::read_to_string(log).unwrap_or_default();
        if ended || start.elapsed() > START || said.contains("qemu-system-arm: -") {
            return Err(VirtualBoardError::NotStarted(said.trim().replace('\n', "; ")));
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}
