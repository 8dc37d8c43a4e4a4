//! What a block of Thumb instructions costs: how many there are, and an estimate of the cycles from above.
//!
//! Cycles are those of the Cortex-M4's reference manual (instruction set summary), with the larger number where it gives
//! two. A division takes 12, and a branch that is taken refills the pipeline in 2. Code in flash waits 4 states
//! (170 MHz, RM0440) for each 8 bytes, as if there were neither cache nor prefetch. Code in CCM SRAM does not wait.

/// Wait states of the flash at 170 MHz (RM0440, number of wait states, range 1 boost).
pub const FLASH_WAIT: u32 = 4;
/// A peripheral's register is behind a bridge: cycles beyond those of the load or store.
pub const BRIDGE_WAIT: u32 = 4;
/// Entering and leaving an exception, with 17 words of the floating-point unit (lazy stacking).
pub const EXCEPTION: u32 = 12 + 12 + 17;
/// Bytes that the flash gives at once, with two banks.
const LINE: u32 = 8;
/// Refilling the pipeline after a branch.
const REFILL: u32 = 2;
/// A store with a constant offset: the store buffer takes it.
const STORE: u32 = 1;
const DIVISION: u32 = 12;
/// Division and root of the floating-point unit.
const LONG: u32 = 14;

/// Of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Its bytes; 0: not known yet.
    pub bytes: u32,
    /// Instructions.
    pub instructions: u32,
    /// Cycles, with the waits for its code, and with its last branch taken.
    pub cycles: u32,
    /// Cycles less where its last branch is not taken.
    pub not_taken: u32,
}

/// The cost of the block `code` at `address`.
pub fn cost(address: u32, code: &[u8], in_flash: bool) -> Cost {
    let (halves, _) = code.as_chunks::<2>();
    let mut halves = halves.iter().map(|half| u16::from_le_bytes(*half));
    let mut cost = Cost { bytes: code.len() as u32, ..Cost::default() };
    while let Some(first) = halves.next() {
        cost.instructions += 1;
        let wide_one = first >> 11 >= 0b11101;
        // The conditional branches: B in both widths (whose condition is not 111x), CBZ, CBNZ.
        let conditional = matches!(first, 0xd000..=0xddff) || first & 0xf500 == 0xb100 && first & 0xf000 == 0xb000;
        let conditional = conditional
            || first & 0xf800 == 0xf000
                && first & 0x0380 != 0x0380
                && halves.clone().next().is_some_and(|second| second & 0xd000 == 0x8000);
        cost.not_taken = if conditional { REFILL } else { 0 };
        cost.cycles += if wide_one { wide(first, halves.next().unwrap_or(0)) } else { narrow(first) };
    }
    if in_flash && !code.is_empty() {
        let lines = (address + cost.bytes - 1) / LINE - address / LINE + 1;
        cost.cycles += lines * FLASH_WAIT;
    }
    cost
}

fn narrow(code: u16) -> u32 {
    let listed = (code & 0x1ff).count_ones();
    match code {
        0x4700..=0x47ff | 0xd000..=0xddff | 0xe000..=0xe7ff => 1 + REFILL,
        // A store with a constant offset; then loads, and stores with a register's.
        0x6000..=0x67ff | 0x7000..=0x77ff | 0x8000..=0x87ff | 0x9000..=0x97ff => STORE,
        0x4800..=0x9fff => 2,
        0xb400..=0xb5ff => 1 + listed,
        0xbc00..=0xbdff => 1 + listed + if code & 0x100 == 0 { 0 } else { REFILL },
        0xc000..=0xcfff => 1 + (code & 0xff).count_ones(),
        _ if code & 0xf500 == 0xb100 => 1 + REFILL,
        _ => 1,
    }
}

fn wide(first: u16, second: u16) -> u32 {
    let to_pc = if second & 0xf000 == 0xf000 { REFILL } else { 0 };
    match first {
        // Table branch; then pairs and exclusive ones.
        0xe8d0..=0xe8df if second & 0xffe0 == 0xf000 => 3 + REFILL,
        0xe800..=0xe9ff if first & 0x40 != 0 => 3,
        0xe800..=0xe9ff => 1 + second.count_ones() + if first & 0x10 != 0 && second & 0x8000 != 0 { REFILL } else { 0 },
        0xf880..=0xf88f | 0xf8a0..=0xf8af | 0xf8c0..=0xf8cf => STORE,
        0xf800..=0xf9ff => 2 + to_pc,
        0xfb90..=0xfb9f | 0xfbb0..=0xfbbf => DIVISION,
        0xec40..=0xec5f => 2,
        0xed00..=0xedff if first & 0x20 == 0 => 2 + u32::from(second & 0x100 != 0),
        0xec00..=0xedff => 1 + u32::from(second & 0xff),
        0xee00..=0xeeff if second & 0x10 == 0 => floating(first, second),
        0xf3bf => 4,
        0xf000..=0xf7ff if second & 0x8000 != 0 => 1 + REFILL,
        _ => 1,
    }
}

fn floating(first: u16, second: u16) -> u32 {
    match (first >> 4) & 0xb {
        // Multiply and add, in all its forms.
        0x0 | 0x1 | 0x9 | 0xa => 3,
        0x8 => LONG,
        0xb if first & 0xf == 1 && second & 0xc0 == 0xc0 => LONG,
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(halves: &[u16]) -> (u32, u32) {
        let code: Vec<u8> = halves.iter().flat_map(|half| half.to_le_bytes()).collect();
        let cost = cost(0x1000_0000, &code, false);
        (cost.instructions, cost.cycles)
    }

    #[test]
    fn the_manuals_cycles() {
        // push {r4, r5, lr}; ldr r0, [r1]; udiv r0, r0, r1; pop {r4, r5, pc}.
        assert_eq!(of(&[0xb530, 0x6808, 0xfbb0, 0xf0f1, 0xbd30]), (4, 4 + 2 + 12 + 4 + 2));
        // vadd.f32 s0, s0, s1; vdiv.f32 s0, s0, s1; vsqrt.f32 s0, s0; vfma.f32 s0, s1, s2.
        assert_eq!(of(&[0xee30, 0x0a20, 0xee80, 0x0a20, 0xeeb1, 0x0ac0, 0xeea0, 0x0a81]), (4, 1 + 14 + 14 + 3));
        // ldmia r1!, {r3, r4}; bne.
        assert_eq!(of(&[0xc918, 0xd1fd]), (2, 3 + 3));
        let not_taken = |halves: &[u16]| {
            let code: Vec<u8> = halves.iter().flat_map(|half| half.to_le_bytes()).collect();
            cost(0x1000_0000, &code, false).not_taken
        };
        // bne; cbz; bne.w; b; bx lr; bl.
        assert_eq!([not_taken(&[0xd1fd]), not_taken(&[0xb120]), not_taken(&[0xf47f, 0xaffe])], [REFILL; 3]);
        assert_eq!([not_taken(&[0xe7fd]), not_taken(&[0x4770]), not_taken(&[0xf000, 0xf800])], [0; 3]);
        // bl; ldrd r0, r1, [r2]; ldmia.w r0!, {r4-r7}.
        assert_eq!(of(&[0xf000, 0xf800, 0xe9d2, 0x0100, 0xe8b0, 0x00f0]), (3, 3 + 3 + 5));
    }

    /// Ten bytes from the last half of a line touch two lines.
    #[test]
    fn flash_makes_code_wait() {
        let code = [0x00, 0xbf].repeat(5);
        assert_eq!(cost(0x0800_0004, &code, true).cycles, 5 + 2 * FLASH_WAIT);
    }
}
