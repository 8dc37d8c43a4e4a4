//! What a device needs of the catalogue: ranges and names as numbers, without its texts (8 KiB on a microcontroller).

use super::{Kind, MAX_PARAMETERS};

const KINDS: usize = Kind::ALL.len();

/// Where the ranges of each effect start in [`RANGES`]; the next one's start is its end.
static STARTS: [u8; KINDS + 1] = starts();
/// Smallest and largest valid value of every parameter, in the order of the catalogue.
static RANGES: [[f32; 2]; STARTS_END] = ranges();
/// FNV-1a of the catalogue names.
static HASHES: [u32; KINDS] = hashes();

const STARTS_END: usize = starts()[KINDS] as usize;

const fn starts() -> [u8; KINDS + 1] {
    let mut starts = [0; KINDS + 1];
    let mut kind = 0;
    while kind < KINDS {
        starts[kind + 1] = starts[kind] + Kind::ALL[kind].definition().parameters.len() as u8;
        kind += 1;
    }
    starts
}

const fn ranges() -> [[f32; 2]; STARTS_END] {
    let mut ranges = [[0.0; 2]; STARTS_END];
    let (mut at, mut kind) = (0, 0);
    while kind < KINDS {
        let parameters = Kind::ALL[kind].definition().parameters;
        assert!(parameters.len() <= MAX_PARAMETERS);
        let mut index = 0;
        while index < parameters.len() {
            // To f32, so that a limit of the catalogue does not fail by its own rounding on the wire.
            ranges[at] = [parameters[index].min as f32, parameters[index].max as f32];
            at += 1;
            index += 1;
        }
        kind += 1;
    }
    ranges
}

const fn hashes() -> [u32; KINDS] {
    let mut hashes = [0; KINDS];
    let mut kind = 0;
    while kind < KINDS {
        hashes[kind] = crate::fnv::fnv1a(Kind::ALL[kind].name().as_bytes());
        kind += 1;
    }
    hashes
}

impl Kind {
    /// Smallest and largest valid value of each parameter, in the order of the definition, rounded to f32.
    #[must_use]
    pub fn ranges(self) -> &'static [[f32; 2]] {
        let at = |index: usize| STARTS.get(index).map_or(0, |start| usize::from(*start));
        RANGES.get(at(self as usize)..at(self as usize + 1)).unwrap_or_default()
    }

    /// FNV-1a hash of the catalogue name (32 bits): the effect's number on the wire.
    #[must_use]
    pub fn name_hash(self) -> u32 {
        HASHES.get(self as usize).copied().unwrap_or(0)
    }

    /// The effect of a [`Kind::name_hash`].
    #[must_use]
    pub fn from_name_hash(hash: u32) -> Option<Self> {
        let index = HASHES.iter().position(|known| *known == hash)?;
        Self::ALL.get(index).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tables_are_the_catalogue() {
        for (index, kind) in Kind::ALL.iter().enumerate() {
            let definition = kind.definition();
            assert_eq!(*kind as usize, index);
            assert_eq!(Kind::from_name_hash(kind.name_hash()), Some(*kind));
            assert_eq!(kind.name_hash(), crate::fnv::fnv1a(definition.name.as_bytes()));
            let limits = definition.parameters.iter().map(|parameter| [parameter.min as f32, parameter.max as f32]);
            assert!(limits.eq(kind.ranges().iter().copied()), "{}", definition.name);
        }
        assert_eq!(Kind::from_name_hash(0), None);
    }
}
