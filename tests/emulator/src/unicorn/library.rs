//! The shared library: where it is, and its functions.

use std::env::consts::DLL_SUFFIX;
use std::ffi::{c_int, c_void};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use libloading::Library;

use super::{Code, Engine};

/// Names another library.
const VARIABLE: &str = "BREAKAWAY_UNICORN";
/// What `cargo xtask test` leaves in `images/` of the target folder.
const FILE: &str = "libunicorn";

/// Functions of the library (unicorn.h).
pub(super) struct Functions {
    pub(super) open: unsafe extern "C" fn(c_int, c_int, *mut Engine) -> Code,
    pub(super) control: unsafe extern "C" fn(Engine, c_int, ...) -> Code,
    pub(super) start: unsafe extern "C" fn(Engine, u64, u64, u64, usize) -> Code,
    pub(super) stop: unsafe extern "C" fn(Engine) -> Code,
    pub(super) close: unsafe extern "C" fn(Engine) -> Code,
    pub(super) map: unsafe extern "C" fn(Engine, u64, u64, u32) -> Code,
    pub(super) map_device: unsafe extern "C" fn(Engine, u64, u64, *const c_void, Engine, *const c_void, Engine) -> Code,
    pub(super) read: unsafe extern "C" fn(Engine, u64, *mut c_void, u64) -> Code,
    pub(super) write: unsafe extern "C" fn(Engine, u64, *const c_void, u64) -> Code,
    pub(super) get: unsafe extern "C" fn(Engine, c_int, *mut c_void) -> Code,
    pub(super) set: unsafe extern "C" fn(Engine, c_int, *const c_void) -> Code,
    pub(super) hook: unsafe extern "C" fn(Engine, *mut usize, c_int, *const c_void, Engine, u64, u64, ...) -> Code,
}

/// Why there is no Unicorn.
#[derive(Clone, Debug, thiserror::Error)]
pub enum NoUnicorn {
    /// Nowhere.
    #[error("no {FILE} in images/ of the target folder, and {VARIABLE} names none: `cargo xtask emulator` fetches it")]
    Missing,
    /// It is there and cannot be used.
    #[error("{file}: {reason}")]
    Unusable {
        /// The library.
        file: String,
        /// What the loader says.
        reason: String,
    },
}

/// The library's functions, loaded once.
pub(super) fn functions() -> Result<&'static Functions, NoUnicorn> {
    static LOADED: OnceLock<Result<Functions, NoUnicorn>> = OnceLock::new();
    let loaded = LOADED.get_or_init(|| {
        let file = find().ok_or(NoUnicorn::Missing)?;
        let unusable = |error: libloading::Error| NoUnicorn::Unusable {
            file: file.display().to_string(),
            reason: error.to_string(),
        };
        // SAFETY: Unicorn's initialisers do nothing but set up its own tables; the signatures are those of unicorn.h.
        unsafe {
            let library = Library::new(&file).map_err(unusable)?;
            macro_rules! function {
                ($name:literal) => {
                    *library.get($name).map_err(unusable)?
                };
            }
            let functions = Functions {
                open: function!(b"uc_open"),
                control: function!(b"uc_ctl"),
                start: function!(b"uc_emu_start"),
                stop: function!(b"uc_emu_stop"),
                close: function!(b"uc_close"),
                map: function!(b"uc_mem_map"),
                map_device: function!(b"uc_mmio_map"),
                read: function!(b"uc_mem_read"),
                write: function!(b"uc_mem_write"),
                get: function!(b"uc_reg_read"),
                set: function!(b"uc_reg_write"),
                hook: function!(b"uc_hook_add"),
            };
            // Until the program ends.
            std::mem::forget(library);
            Ok(functions)
        }
    });
    loaded.as_ref().map_err(Clone::clone)
}

/// The library that `BREAKAWAY_UNICORN` names, else the one that xtask has fetched.
fn find() -> Option<PathBuf> {
    if let Some(named) = std::env::var_os(VARIABLE) {
        return Some(named.into());
    }
    in_images(&format!("{FILE}{DLL_SUFFIX}"))
}

/// A file that `cargo xtask test` leaves in `images/` of the target folder from which this program runs.
pub fn in_images(name: &str) -> Option<PathBuf> {
    let program = std::env::current_exe().unwrap_or_default();
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target");
    let folders = program.ancestors().skip(1).take(4).map(Path::to_path_buf).chain([workspace]);
    folders.map(|folder| folder.join("images").join(name)).find(|file| file.is_file())
}

/// Whether there is a Unicorn.
///
/// # Errors
/// [`NoUnicorn`].
pub fn available() -> Result<(), NoUnicorn> {
    functions().map(|_| ())
}
