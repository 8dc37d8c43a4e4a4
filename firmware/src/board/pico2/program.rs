//! The quadrature decoder, for a state machine of the RP2350's PIO.
//!
//! It samples both channels, and jumps by the old and the new sample into a table of sixteen. From there the count,
//! which the machine keeps in Y, goes up, down, or stays. Where both channels have changed at once a flag is raised: a
//! count was lost or added. The count is put in a register (RP2350, PIO, RX FIFO as storage: `put`), where the tick
//! reads it like a timer's. So nothing waits, and nothing read is older than a round.
//!
//! Samples are 8 clocks apart, 11 after a count up: 73 ns at 150 MHz, and 13 million counts per second at the most.
//! Encodings: RP2350 data sheet, PIO, instruction set; a test compares them with those of an assembler.

/// Where a round starts, and where the last instruction leads.
pub const ROUND: u8 = 19;
/// The last instruction.
pub const LAST: u8 = 28;
/// The flag of two channels that have changed at once.
pub const ERROR_FLAG: u8 = 0;
/// Clocks from one sample to the next, at most.
pub const SLOWEST_CLOCKS: u32 = 11;

const ERROR: u8 = 16;
const DOWN: u8 = 18;
const UP: u8 = 26;

/// Where the samples lead, by old and new state, each channel B and then A. Up is A before B, as with the STM32's timers.
const TABLE: [u8; 16] = [
    ROUND, UP, DOWN, ERROR, // from 00
    DOWN, ROUND, ERROR, UP, // from 01
    UP, ERROR, ROUND, DOWN, // from 10
    ERROR, DOWN, UP, ROUND, // from 11
];

/// The program, from address 0: its table is found by the address alone.
pub const PROGRAM: [u16; 29] = {
    let mut program = [0; 29];
    let mut state = 0;
    while state < TABLE.len() {
        program[state] = jump(TABLE[state]);
        state += 1;
    }
    program[ERROR as usize] = RAISE_ERROR;
    program[17] = jump(ROUND);
    // Goes on at ROUND whether Y was 0 or not.
    program[DOWN as usize] = DECREMENT_Y_AND_JUMP | ROUND as u16;
    program[ROUND as usize] = MOVE_Y_TO_ISR;
    program[20] = PUT_ISR;
    program[21] = CLEAR_ISR;
    program[22] = SHIFT_IN_OLD;
    program[23] = SHIFT_IN_PINS;
    program[24] = MOVE_ISR_TO_X;
    program[25] = MOVE_ISR_TO_PC;
    // There is no increment: −(−y − 1) … by complements.
    program[UP as usize] = COMPLEMENT_Y;
    program[27] = DECREMENT_Y_AND_JUMP | LAST as u16;
    program[LAST as usize] = COMPLEMENT_Y;
    program
};

/// To be executed before the start, in this order: the count is 0, and the first sample finds the state as it is.
pub const START: [u16; 4] = [SET_Y_ZERO, CLEAR_ISR, SHIFT_IN_PINS, MOVE_ISR_TO_X];

const fn jump(to: u8) -> u16 {
    to as u16
}
const DECREMENT_Y_AND_JUMP: u16 = 0x0080;
/// X is the sample before in its two lowest bits.
const SHIFT_IN_OLD: u16 = 0x4022;
const SHIFT_IN_PINS: u16 = 0x4002;
const PUT_ISR: u16 = 0x8018;
const MOVE_ISR_TO_X: u16 = 0xa026;
const COMPLEMENT_Y: u16 = 0xa04a;
const MOVE_ISR_TO_PC: u16 = 0xa0a6;
const MOVE_Y_TO_ISR: u16 = 0xa0c2;
const CLEAR_ISR: u16 = 0xa0c3;
const RAISE_ERROR: u16 = 0xc000 | ERROR_FLAG as u16;
const SET_Y_ZERO: u16 = 0xe040;

#[cfg(test)]
mod tests;
