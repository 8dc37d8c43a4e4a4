//! The Pico 2's image: what its boot ROM asks of it, and the file that is dropped on the board.

mod boots;
mod uf2;

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};
use object::read::elf::{ElfFile32, ProgramHeader};
use object::{Endianness, Object, ObjectSymbol, SymbolKind, elf};

use crate::cross::{self, Toolchain};
use crate::environment::environment;
use crate::run::{root, run};

/// Where the flash is.
const FLASH: u32 = 0x1000_0000;
/// As far as the program may go in it: what is behind is for the settings (firmware, board/pico2/constants.rs, SETTINGS_AT).
const SETTINGS: u32 = FLASH + 4 * 1024 * 1024 - 12 * 1024;
/// Where the RAM is that the program uses, and its end.
const RAM: u32 = 0x2000_0000;
const RAM_END: u32 = RAM + 512 * 1024;

/// Bytes that are loaded.
#[derive(Clone, Debug)]
struct Segment {
    /// Where they are kept.
    stored: u32,
    /// Where they are when the program runs.
    runs: u32,
    bytes: Vec<u8>,
}

/// A linked file.
#[derive(Clone, Debug, Default)]
struct Image {
    segments: Vec<Segment>,
    /// Names and addresses; those of functions have no Thumb bit.
    functions: Vec<(String, u32)>,
    vectors: Option<u32>,
}

/// Builds the image, checks it, and writes it as `images/pico2.uf2` in the target folder.
pub fn all() -> Result<()> {
    cross::build(cross::install()?, &cross::PICO2)?;
    println!("{}", write()?.display());
    Ok(())
}

/// Builds the image and checks that the boot ROM starts it; its file.
pub fn build(toolchain: Toolchain) -> Result<PathBuf> {
    cross::build(toolchain, &cross::PICO2)?;
    let file = cross::binary(&cross::PICO2, "pico2");
    boots::check(&Image::read(&file)?).with_context(|| format!("{} would not run", file.display()))?;
    Ok(file)
}

/// Runs the image on an emulated core, with a simulated axis at its pins and a host at its USB: the programs of
/// tests/pico2. `python` is what [`emulator`] has found.
pub fn emulate(python: &Path) -> Result<()> {
    let (image, tests) = (cross::binary(&cross::PICO2, "pico2"), root().join("tests/pico2"));
    let mut command = Command::new(python);
    // No folder of compiled files beside the sources.
    run(command.args(["-B", "test_image.py"]).env("IMAGE", image).current_dir(tests))
}

/// The Python that has the emulator, from PyPI in the target folder.
pub fn emulator() -> Result<PathBuf> {
    environment(&cross::target_folder().join("pico2-venv"), &root().join("tests/pico2/requirements.txt"))
}

/// Builds the image and runs it.
pub fn test() -> Result<()> {
    build(cross::install()?)?;
    emulate(&emulator()?)
}

fn write() -> Result<PathBuf> {
    let image = Image::read(&cross::binary(&cross::PICO2, "pico2"))?;
    boots::check(&image)?;
    let folder = cross::target_folder().join("images");
    std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let to = folder.join("pico2.uf2");
    // Beside, then renamed: a copy to a board may be under way.
    let beside = to.with_extension("new");
    std::fs::write(&beside, uf2::blocks(&image.flash())).with_context(|| beside.display().to_string())?;
    std::fs::rename(&beside, &to).with_context(|| to.display().to_string())?;
    Ok(to)
}

impl Image {
    fn read(file: &Path) -> Result<Self> {
        let name = || file.display().to_string();
        let data = std::fs::read(file).with_context(name)?;
        let object = ElfFile32::<Endianness>::parse(&*data).with_context(name)?;
        let endian = object.endian();
        let mut image = Self::default();
        for header in object.elf_program_headers() {
            if header.p_type(endian) != elf::PT_LOAD || header.p_filesz(endian) == 0 {
                continue;
            }
            let Ok(bytes) = header.data(endian, &*data) else { bail!("{}: a segment is cut off", name()) };
            let (stored, runs) = (header.p_paddr(endian), header.p_vaddr(endian));
            image.segments.push(Segment { stored, runs, bytes: bytes.to_vec() });
        }
        for symbol in object.symbols() {
            let (Ok(name), address) = (symbol.name(), symbol.address() as u32) else { continue };
            if symbol.kind() == SymbolKind::Text {
                image.functions.push((name.to_owned(), address & !1));
            }
            if name == "__vector_table" {
                image.vectors = Some(address);
            }
        }
        Ok(image)
    }

    /// What is in flash, by its places.
    fn flash(&self) -> Vec<(u32, &[u8])> {
        self.segments.iter().map(|segment| (segment.stored, segment.bytes.as_slice())).collect()
    }

    /// A word where it is when the program runs.
    fn word(&self, at: u32) -> Option<u32> {
        self.segments.iter().find_map(|segment| {
            let start = at.checked_sub(segment.runs)? as usize;
            Some(u32::from_le_bytes(*segment.bytes.get(start..)?.first_chunk()?))
        })
    }

    /// Where a function is.
    fn function(&self, name: &str) -> Option<u32> {
        self.functions.iter().find(|(found, _)| found == name).map(|(_, at)| *at)
    }
}
