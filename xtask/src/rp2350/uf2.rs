//! UF2: blocks of 512 bytes, each with 256 bytes for one place in flash. The boot ROM of the board takes such a file on
//! its drive (RP2350, boot ROM, UF2 format details).

use std::collections::BTreeMap;

/// Bytes of flash in a block.
const PAGE: u32 = 256;
/// Room for a page in a block, bytes.
const ROOM: usize = 476;
const START: [u32; 2] = [0x0a32_4655, 0x9e5d_5157];
const END: u32 = 0x0ab1_6f30;
/// The block says which chip it is for.
const HAS_FAMILY: u32 = 0x2000;
/// An Arm program in Secure state for an RP2350.
const FAMILY: u32 = 0xe48b_ff59;

/// The file of a program: what is between its parts in a page is zero.
pub(super) fn blocks(parts: &[(u32, &[u8])]) -> Vec<u8> {
    let mut pages: BTreeMap<u32, [u8; PAGE as usize]> = BTreeMap::new();
    for (start, bytes) in parts {
        for (at, byte) in (*start..).zip(*bytes) {
            pages.entry(at - at % PAGE).or_insert([0; PAGE as usize])[(at % PAGE) as usize] = *byte;
        }
    }
    let count = pages.len() as u32;
    let mut file = Vec::new();
    for (number, (at, page)) in (0..).zip(&pages) {
        let head = [START[0], START[1], HAS_FAMILY, *at, PAGE, number, count, FAMILY];
        file.extend(head.iter().flat_map(|word| word.to_le_bytes()));
        file.extend(page);
        file.resize(file.len() + ROOM - page.len(), 0);
        file.extend(END.to_le_bytes());
    }
    file
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A reader of its own: what comes out of the blocks is what went in.
    #[test]
    fn blocks_hold_every_byte_at_its_place() {
        let long: Vec<u8> = (0..1000_u32).map(|i| (i * 3 + 1) as u8).collect();
        let parts: [(u32, &[u8]); 2] = [(0x1000_0000, &[7; 160]), (0x1000_0200, &long)];
        let file = blocks(&parts);
        // One page for the first part, four for the second.
        assert_eq!(file.len(), 5 * 512);
        let mut flash = BTreeMap::new();
        for (number, block) in file.chunks(512).enumerate() {
            let word = |at: usize| u32::from_le_bytes(block[at..at + 4].try_into().unwrap());
            assert_eq!((word(0), word(4), word(508)), (0x0a32_4655, 0x9e5d_5157, 0x0ab1_6f30));
            assert_eq!((word(8), word(16), word(28)), (0x2000, 256, 0xe48b_ff59));
            assert_eq!((word(20), word(24)), (number as u32, 5));
            assert!(word(12).is_multiple_of(256), "the boot ROM programs whole pages");
            flash.extend((word(12)..).zip(block[32..32 + 256].iter().copied()));
        }
        for (start, bytes) in parts {
            assert!((start..).zip(bytes).all(|(at, byte)| flash[&at] == *byte));
        }
        assert_eq!(flash[&0x1000_00a0], 0);
    }
}
