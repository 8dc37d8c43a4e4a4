//! What a linked file says of itself.

use std::path::Path;

use anyhow::{Context, Result, bail};
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, elf};

/// CCM SRAM of the STM32G4 (memory.x); elsewhere, nothing is at these addresses.
const CCM: std::ops::Range<u64> = 0x1000_0000..0x1000_8000;

/// Bytes of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sizes {
    /// In flash: code, constants, initial values.
    pub flash: u64,
    /// Statics in RAM.
    pub ram: u64,
    /// Code that is copied to CCM SRAM of the STM32G4.
    pub ccm: u64,
}

/// Flash and static RAM: the sections that are loaded, and those that are writable.
pub fn sizes(file: &Path) -> Result<Sizes> {
    let data = std::fs::read(file).with_context(|| file.display().to_string())?;
    let object = object::File::parse(&*data).with_context(|| file.display().to_string())?;
    let mut sizes = Sizes { flash: 0, ram: 0, ccm: 0 };
    for section in object.sections() {
        let SectionFlags::Elf { sh_flags, .. } = section.flags() else { continue };
        if sh_flags & u64::from(elf::SHF_ALLOC) == 0 {
            continue;
        }
        let in_file = section.file_range().is_some_and(|(_, size)| size > 0);
        if in_file {
            sizes.flash += section.size();
        }
        if CCM.contains(&section.address()) {
            sizes.ccm += section.size();
        }
        if sh_flags & u64::from(elf::SHF_WRITE) != 0 {
            sizes.ram += section.size();
        }
    }
    Ok(sizes)
}

/// Proves that nothing in a linked file computes in floating point or can panic.
pub fn integers_only(file: &Path) -> Result<()> {
    let data = std::fs::read(file).with_context(|| file.display().to_string())?;
    let object = object::File::parse(&*data).with_context(|| file.display().to_string())?;
    let names: Vec<&str> = object.symbols().filter_map(|symbol| symbol.name().ok()).collect();
    // A file in which the tick is not would prove nothing.
    if !names.contains(&"integer_tick") {
        bail!("{} holds no tick", file.display());
    }
    let bad: Vec<&str> = names.into_iter().filter(|name| is_float(name) || is_panic(name)).collect();
    if bad.is_empty() { Ok(()) } else { bail!("{} holds {}", file.display(), bad.join(", ")) }
}

/// A routine of the run-time ABI for floating point (`__aeabi_fadd`, `__aeabi_dmul`, `__aeabi_i2f`, …), or of libgcc's
/// names (`__addsf3`, …).
fn is_float(name: &str) -> bool {
    let aeabi = name.strip_prefix("__aeabi_").is_some_and(|rest| {
        let converts =
            ["i2f", "i2d", "ui2f", "ui2d", "l2f", "l2d", "ul2f", "ul2d", "cfcmp", "cdcmp", "cfrcmp", "cdrcmp"];
        rest.starts_with(['f', 'd']) || converts.iter().any(|prefix| rest.starts_with(prefix))
    });
    aeabi || ["sf2", "sf3", "df2", "df3", "sisf", "sidf", "disf", "didf"].iter().any(|end| name.ends_with(end))
}

fn is_panic(name: &str) -> bool {
    name.contains("panicking") || name.contains("the_tick_must_not_panic") || name.contains("rust_begin_unwind")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_and_panics_are_known_by_their_names() {
        for bad in [
            "__aeabi_fadd",
            "__aeabi_dmul",
            "__aeabi_i2f",
            "__aeabi_ul2d",
            "__aeabi_cdcmple",
            "__addsf3",
            "__floatsidf",
        ] {
            assert!(is_float(bad), "{bad}");
        }
        for good in
            ["__aeabi_uidiv", "__aeabi_uldivmod", "__aeabi_lmul", "__aeabi_memcpy", "__aeabi_llsl", "integer_tick"]
        {
            assert!(!is_float(good) && !is_panic(good), "{good}");
        }
        assert!(is_panic("_ZN4core9panicking9panic_fmt17h0E"));
    }
}
