//! Where the firmware's image is, and what else `cargo xtask image` leaves beside it.

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use super::VirtualBoardError;

/// What `cargo xtask image` calls it.
const IMAGE: &str = "mps2-an386.elf";
/// Names another.
const VARIABLE: &str = "BREAKAWAY_IMAGE";

/// The image given, or named by `BREAKAWAY_IMAGE`, or built by `cargo xtask image` in the target folder from which this
/// program runs.
///
/// # Errors
/// [`VirtualBoardError::NoImage`], [`VirtualBoardError::NotAnImage`].
pub fn find(given: Option<&Path>) -> Result<PathBuf, VirtualBoardError> {
    let named = given.map(Path::to_path_buf).or_else(|| std::env::var_os(VARIABLE).map(PathBuf::from));
    if let Some(image) = named {
        if !image.is_file() {
            return Err(VirtualBoardError::NoImage(image.display().to_string()));
        }
        // QEMU would run whatever it is given, and stop in a dump of registers.
        let mut magic = [0; 4];
        return match File::open(&image).and_then(|mut file| file.read_exact(&mut magic)) {
            Ok(()) if magic == *b"\x7fELF" => Ok(image),
            _ => Err(VirtualBoardError::NotAnImage(image.display().to_string())),
        };
    }
    in_images(IMAGE).ok_or_else(|| VirtualBoardError::NoImage(format!("images/{IMAGE}")))
}

/// A file that `cargo xtask image` leaves in `images/` of the target folder from which this program runs.
pub(super) fn in_images(name: &str) -> Option<PathBuf> {
    let program = std::env::current_exe().unwrap_or_default();
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target");
    let folders = program.ancestors().skip(1).take(4).map(Path::to_path_buf).chain([workspace]);
    folders.map(|folder| folder.join("images").join(name)).find(|file| file.is_file())
}
