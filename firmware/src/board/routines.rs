//! Routines that the compiler calls, in 290 bytes in place of compiler-builtins' 4.4 KB, which are built for speed
//! whatever the image is built for. They are `memcpy` and its like without unrolled loops, and the division of 64-bit
//! integers bit by bit. The longest copy in a tick has some hundred bytes, and goes by eight words. Reports of faults
//! and settings divide, in 600 instructions.
//!
//! In assembly, as a loop in Rust that copies becomes a call of `memcpy`. ARMv7-M reads and writes words at any address.

use core::hint::black_box;

core::arch::global_asm!(
    ".macro define name",
    ".global \\name",
    ".type \\name, %function",
    ".thumb_func",
    "\\name:",
    ".endm",
    ".section .text.breakaway_memmove, \"ax\", %progbits",
    "define memmove",
    "define __aeabi_memmove",
    "define __aeabi_memmove4",
    "define __aeabi_memmove8",
    // Forwards is right unless the target starts inside the source.
    "sub r3, r0, r1",
    "cmp r3, r2",
    "bhs 4f",
    "1: subs r2, #1",
    "it lo",
    "bxlo lr",
    "ldrb r3, [r1, r2]",
    "strb r3, [r0, r2]",
    "b 1b",
    "define memcpy",
    "define __aeabi_memcpy",
    "define __aeabi_memcpy4",
    "define __aeabi_memcpy8",
    "4: mov r12, r0",
    // Eight words at a time, where both are aligned as LDM asks: a plan of 400 bytes is copied in a tick.
    "orr r3, r0, r1",
    "lsls r3, r3, #30",
    "bne 9f",
    "subs r2, #32",
    "blo 3f",
    "push {{r4, r5, r6, r7, r8, r9, r10}}",
    "2: ldmia r1!, {{r3, r4, r5, r6, r7, r8, r9, r10}}",
    "stmia r12!, {{r3, r4, r5, r6, r7, r8, r9, r10}}",
    "subs r2, #32",
    "bhs 2b",
    "pop {{r4, r5, r6, r7, r8, r9, r10}}",
    "3: adds r2, #32",
    "9: subs r2, #4",
    "blo 6f",
    "5: ldr r3, [r1], #4",
    "str r3, [r12], #4",
    "subs r2, #4",
    "bhs 5b",
    "6: adds r2, #4",
    "7: subs r2, #1",
    "it lo",
    "bxlo lr",
    "ldrb r3, [r1], #1",
    "strb r3, [r12], #1",
    "b 7b",
    ".section .text.breakaway_memset, \"ax\", %progbits",
    "define __aeabi_memclr",
    "define __aeabi_memclr4",
    "define __aeabi_memclr8",
    "movs r2, #0",
    "define __aeabi_memset",
    "define __aeabi_memset4",
    "define __aeabi_memset8",
    "mov r3, r1",
    "mov r1, r2",
    "mov r2, r3",
    "define memset",
    "mov r12, r0",
    "and r1, r1, #255",
    "mov r3, #0x01010101",
    "mul r1, r1, r3",
    "subs r2, #4",
    "blo 2f",
    "1: str r1, [r12], #4",
    "subs r2, #4",
    "bhs 1b",
    "2: adds r2, #4",
    "3: subs r2, #1",
    "it lo",
    "bxlo lr",
    "strb r1, [r12], #1",
    "b 3b",
    ".section .text.breakaway_division, \"ax\", %progbits",
    // r1:r0 / r3:r2: quotient to r1:r0, remainder to r3:r2. The quotient's bits move in where the dividend's move out. By
    // zero: all ones and the dividend; Rust asks before.
    "define __aeabi_uldivmod",
    "push {{r4, r5, r6, r7, r8, lr}}",
    "movs r4, #0",
    "movs r5, #0",
    "movs r8, #64",
    "1: adds r0, r0, r0",
    "adcs r1, r1, r1",
    "adcs r4, r4, r4",
    "adcs r5, r5, r5",
    // A bit that leaves the remainder makes it larger than any divisor.
    "bcs 2f",
    "subs r6, r4, r2",
    "sbcs r7, r5, r3",
    "blo 3f",
    "2: subs r4, r4, r2",
    "sbc r5, r5, r3",
    "adds r0, #1",
    "3: subs r8, r8, #1",
    "bne 1b",
    "mov r2, r4",
    "mov r3, r5",
    "pop {{r4, r5, r6, r7, r8, pc}}",
    // The same with signs: the quotient rounds to zero, the remainder has the dividend's sign.
    "define __aeabi_ldivmod",
    "push {{r4, r5, r6, lr}}",
    "mov r4, r1",
    "eor r5, r1, r3",
    "cmp r1, #0",
    "bpl 1f",
    "rsbs r0, r0, #0",
    "sbc r1, r1, r1, lsl #1",
    "1: cmp r3, #0",
    "bpl 2f",
    "rsbs r2, r2, #0",
    "sbc r3, r3, r3, lsl #1",
    "2: bl __aeabi_uldivmod",
    "cmp r5, #0",
    "bpl 3f",
    "rsbs r0, r0, #0",
    "sbc r1, r1, r1, lsl #1",
    "3: cmp r4, #0",
    "bpl 4f",
    "rsbs r2, r2, #0",
    "sbc r3, r3, r3, lsl #1",
    "4: pop {{r4, r5, r6, pc}}",
    ".purgem define",
    ".text",
);

/// Whether they do what they are for, on numbers, lengths and places that are known to none of them. Run by the measuring
/// image.
#[must_use]
pub fn hold() -> bool {
    let mut state = 1_u64;
    let mut next = || {
        // Knuth's MMIX generator; the shift gives numbers of every length.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        state >> (state >> 58)
    };
    (0..2000).all(|_| divides(next(), next().max(1)))
        && (0..40).all(|length| moves(length % 20, length / 20, length))
        && (0..200).all(copies_words)
}

/// From one aligned place to another, which goes by eight words: all of it, and nothing beyond.
fn copies_words(length: usize) -> bool {
    let from: [u32; 50] = core::array::from_fn(|i| (i as u32 + 1) * 0x0101_0101);
    let mut to = [0_u32; 50];
    let (from, to) = (black_box(&from), black_box(&mut to));
    // SAFETY: both have 200 bytes, and `length` is less.
    unsafe {
        core::ptr::copy_nonoverlapping(from.as_ptr().cast::<u8>(), to.as_mut_ptr().cast::<u8>(), black_box(length))
    };
    (0..200).all(|i| to[i / 4].to_le_bytes()[i % 4] == if i < length { from[i / 4].to_le_bytes()[i % 4] } else { 0 })
}

fn divides(number: u64, by: u64) -> bool {
    let (quotient, rest) = (black_box(number) / black_box(by), black_box(number) % black_box(by));
    let unsigned = rest < by && quotient.checked_mul(by).and_then(|whole| whole.checked_add(rest)) == Some(number);
    [(1, 1), (1, -1), (-1, 1), (-1, -1)].into_iter().all(|(sign, by_sign)| {
        // Their magnitudes fit an i64.
        let (number, by) = (sign * (number >> 1) as i64, by_sign * ((by >> 1).max(1)) as i64);
        let (quotient, rest) = (black_box(number) / black_box(by), black_box(number) % black_box(by));
        let sound = rest.unsigned_abs() < by.unsigned_abs() && (rest == 0 || rest.signum() == number.signum());
        sound && quotient.wrapping_mul(by).wrapping_add(rest) == number
    }) && unsigned
}

/// Within 64 bytes, `length` of them from `from` to `to` places and back, one place apart or none.
fn moves(from: usize, apart: usize, length: usize) -> bool {
    let bytes: [u8; 64] = core::array::from_fn(|i| i as u8 + 1);
    let expected = |i: usize, from: usize, to: usize| {
        if (to..to + length).contains(&i) { bytes[i - to + from] } else { bytes[i] }
    };
    [(from, from + apart), (from + apart, from)].into_iter().all(|(from, to)| {
        let mut moved = bytes;
        moved.copy_within(black_box(from)..black_box(from + length), black_box(to));
        let mut filled = bytes;
        filled[black_box(from)..black_box(from + length)].fill(black_box(7));
        let mut copied = [0; 64];
        copied[black_box(to)..black_box(to + length)]
            .copy_from_slice(&bytes[black_box(from)..black_box(from + length)]);
        let within = |i: usize, start: usize| (start..start + length).contains(&i);
        (0..64).all(|i| {
            moved[i] == expected(i, from, to)
                && filled[i] == if within(i, from) { 7 } else { bytes[i] }
                && copied[i] == if within(i, to) { bytes[i - to + from] } else { 0 }
        })
    })
}
