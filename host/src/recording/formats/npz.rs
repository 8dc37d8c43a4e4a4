//! Archives of NumPy's arrays (`.npz`): a zip archive with one `.npy` file for each array, packed or not.

use std::io::{Cursor, Read};

use zip::ZipArchive;

use super::fault::Fault;
use super::log::Log;
use super::{Format, MAX_BYTES, npy};

/// Reads the archive's arrays.
pub(super) fn read(bytes: &[u8]) -> Result<Log, Fault> {
    let damaged = |_| Fault::Damaged { at: 0, what: "the archive's table of contents is not there or not whole" };
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(damaged)?;
    let (mut channels, mut passed_over) = (Vec::new(), Vec::new());
    let mut left = MAX_BYTES as u64;
    for index in 0..archive.len() {
        let unpacked =
            |_: zip::result::ZipError| Fault::Damaged { at: 0, what: "a file of the archive cannot be unpacked" };
        let mut file = archive.by_index(index).map_err(unpacked)?;
        let full = file.name().map_err(unpacked)?.into_owned();
        let Some(name) = full.strip_suffix(".npy") else {
            passed_over.push(format!("`{full}`: no array"));
            continue;
        };
        let at = file.header_start();
        let mut content = Vec::new();
        let read = file.by_ref().take(left + 1).read_to_end(&mut content);
        read.map_err(|_| Fault::Damaged { at, what: "a file of the archive cannot be unpacked" })?;
        left = left
            .checked_sub(content.len() as u64)
            .ok_or(Fault::TooLarge { what: "bytes, unpacked", most: MAX_BYTES })?;
        npy::array(name, &content, &mut channels, &mut passed_over)?;
    }
    let mut log = Log::of_arrays(Format::Npz, channels)?;
    log.passed_over = passed_over;
    Ok(log)
}
