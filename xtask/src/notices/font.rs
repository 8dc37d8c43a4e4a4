//! The licence of a font, which is in the font itself.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, anyhow};
use skrifa::string::StringId;
use skrifa::{FontRef, MetadataProvider as _};

/// Its copyright, and its licence.
///
/// # Errors
/// It is no font, or says nothing of its licence.
pub fn licence(path: &Path) -> Result<String> {
    let bytes = fs::read(path).with_context(|| path.display().to_string())?;
    let font = FontRef::new(&bytes).map_err(|error| anyhow!("{}: {error}", path.display()))?;
    let string = |id: StringId| font.localized_strings(id).english_or_first().map(|string| string.to_string());
    let parts = [StringId::COPYRIGHT_NOTICE, StringId::LICENSE_DESCRIPTION].map(string);
    let [Some(copyright), Some(licence)] = parts else {
        return Err(anyhow!("{}: the font does not say its licence", path.display()));
    };
    Ok(format!("{copyright}\n\n{licence}"))
}
