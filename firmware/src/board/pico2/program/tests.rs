//! The program on a state machine that is written after the data sheet's description of the instructions, and its
//! encodings beside those of an assembler.

use std::vec::Vec;

use pio_core::{
    Assembler, InSource, IrqIndexMode, JmpCondition, MovDestination, MovOperation, MovRxIndex, MovSource,
    SetDestination,
};

use super::{ERROR_FLAG, LAST, PROGRAM, ROUND, SLOWEST_CLOCKS, START};

/// Channels as the pins have them, B and then A, a turn forwards.
const FORWARDS: [u32; 4] = [0b00, 0b01, 0b11, 0b10];

/// A state machine of the PIO: instructions without delays, no automatic push, shifting to the left.
#[derive(Default)]
struct Machine {
    pc: u8,
    x: u32,
    y: u32,
    isr: u32,
    put: [u32; 4],
    flags: u32,
    /// Clocks since the start, and those of each sample of the pins.
    clock: u32,
    samples: Vec<u32>,
}

impl Machine {
    fn started(pins: u32) -> Self {
        let mut machine = Self::default();
        for instruction in START {
            assert!(!machine.execute(instruction, pins));
        }
        assert!(machine.execute(u16::from(ROUND), pins), "a jump's code is its target");
        machine.samples.clear();
        machine
    }

    fn run(&mut self, pins: u32, clocks: u32) {
        for _ in 0..clocks {
            let at = self.pc;
            if !self.execute(PROGRAM[usize::from(at)], pins) {
                self.pc = if at == LAST { ROUND } else { at + 1 };
            }
            self.clock += 1;
        }
    }

    /// One instruction; whether it has set the program counter.
    fn execute(&mut self, word: u16, pins: u32) -> bool {
        assert_eq!(word >> 8 & 0x1f, 0, "no delays");
        let (middle, low) = (word >> 5 & 7, word & 0x1f);
        match word >> 13 {
            0 => {
                let taken = match middle {
                    0 => true,
                    4 => {
                        let was = self.y;
                        self.y = was.wrapping_sub(1);
                        was != 0
                    }
                    other => panic!("condition {other}"),
                };
                if taken {
                    self.pc = low as u8;
                }
                return taken;
            }
            2 => {
                let source = match middle {
                    0 => {
                        self.samples.push(self.clock);
                        pins
                    }
                    1 => self.x,
                    other => panic!("source {other}"),
                };
                self.isr = self.isr << low | source & ((1 << low) - 1);
            }
            4 => {
                assert_eq!(word & 0xfc, 0x18, "an immediate index, and no push or pull");
                self.put[usize::from(word & 3)] = self.isr;
            }
            5 => {
                let source = match low & 7 {
                    2 => self.y,
                    3 => 0,
                    6 => self.isr,
                    other => panic!("source {other}"),
                };
                let value = match low >> 3 {
                    0 => source,
                    1 => !source,
                    other => panic!("operation {other}"),
                };
                match middle {
                    1 => self.x = value,
                    2 => self.y = value,
                    5 => {
                        self.pc = value as u8 & 0x1f;
                        return true;
                    }
                    6 => self.isr = value,
                    other => panic!("destination {other}"),
                }
            }
            6 => {
                assert_eq!(word & 0x78, 0, "sets a flag of its own block, and does not wait");
                self.flags |= 1 << (word & 7);
            }
            7 => {
                assert_eq!(middle, 2, "sets Y");
                self.y = u32::from(low);
            }
            other => panic!("instruction {other}"),
        }
        false
    }

    fn count(&self) -> i32 {
        self.put[0].cast_signed()
    }

    fn failed(&self) -> bool {
        self.flags >> ERROR_FLAG & 1 != 0
    }
}

/// Where the samples lead, by old and new state: from 00, 01, 10 and 11.
const JUMPS: &str = "round up down error  down round error up  up error round down  error down up round";

#[test]
fn the_encodings_are_those_of_an_assembler() {
    let mut program = Assembler::<32>::new();
    let [mut round, mut up, mut down, mut error, mut last, mut end] = [(); 6].map(|()| program.label());
    for to in JUMPS.split_whitespace() {
        let label = match to {
            "round" => &mut round,
            "up" => &mut up,
            "down" => &mut down,
            _ => &mut error,
        };
        program.jmp(JmpCondition::Always, label);
    }
    program.bind(&mut error);
    program.irq(false, false, ERROR_FLAG, IrqIndexMode::DIRECT);
    program.jmp(JmpCondition::Always, &mut round);
    program.bind(&mut down);
    program.jmp(JmpCondition::YDecNonZero, &mut round);
    program.bind(&mut round);
    program.mov(MovDestination::ISR, MovOperation::None, MovSource::Y);
    program.mov_to_rx(MovRxIndex::RXFIFO0);
    program.mov(MovDestination::ISR, MovOperation::None, MovSource::NULL);
    program.r#in(InSource::X, 2);
    program.r#in(InSource::PINS, 2);
    program.mov(MovDestination::X, MovOperation::None, MovSource::ISR);
    program.mov(MovDestination::PC, MovOperation::None, MovSource::ISR);
    program.bind(&mut up);
    program.mov(MovDestination::Y, MovOperation::Invert, MovSource::Y);
    program.jmp(JmpCondition::YDecNonZero, &mut last);
    program.bind(&mut last);
    program.mov(MovDestination::Y, MovOperation::Invert, MovSource::Y);
    program.bind(&mut end);
    let assembled = program.assemble_with_wrap(end, round);
    assert_eq!(assembled.code.as_slice(), PROGRAM);
    assert_eq!((assembled.wrap.target, assembled.wrap.source), (ROUND, LAST));

    let mut start = Assembler::<32>::new();
    start.set(SetDestination::Y, 0);
    start.mov(MovDestination::ISR, MovOperation::None, MovSource::NULL);
    start.r#in(InSource::PINS, 2);
    start.mov(MovDestination::X, MovOperation::None, MovSource::ISR);
    assert_eq!(start.assemble().as_slice(), START);
}

/// Wherever the encoder stands, it starts at 0 without an error.
#[test]
fn the_first_sample_is_where_it_stands() {
    for pins in FORWARDS {
        let mut machine = Machine::started(pins);
        machine.run(pins, 100);
        assert_eq!((machine.count(), machine.failed()), (0, false), "{pins:02b}");
    }
}

/// Steps both ways, through zero, each as short as the slowest round: none is lost, none is added. Stretches of 500 in
/// one direction, the second twice as long as it takes back to zero, and stretches of turns at random.
#[test]
fn every_step_at_full_speed_is_counted() {
    let mut machine = Machine::started(FORWARDS[0]);
    let (mut place, mut state) = (0_i32, 1_u32);
    let mut seen = Vec::new();
    for stretch in 0..40 {
        for _ in 0..500 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let forwards = match stretch % 4 {
                0 => true,
                1 | 2 => false,
                _ => state >> 31 == 0,
            };
            place += if forwards { 1 } else { -1 };
            machine.run(FORWARDS[place.rem_euclid(4) as usize], SLOWEST_CLOCKS);
        }
        // What was sampled last is put one round later.
        machine.run(FORWARDS[place.rem_euclid(4) as usize], 2 * SLOWEST_CLOCKS);
        assert_eq!((machine.count(), machine.failed()), (place, false), "stretch {stretch}");
        seen.push(place);
    }
    assert!(seen.contains(&500) && seen.contains(&-500), "{seen:?}");
}

#[test]
fn both_channels_at_once_raise_the_flag() {
    for from in 0..4 {
        let mut machine = Machine::started(FORWARDS[from]);
        machine.run(FORWARDS[from], 50);
        machine.run(FORWARDS[(from + 2) % 4], 50);
        assert_eq!((machine.count(), machine.failed()), (0, true), "{from}");
        // And it goes on counting from there.
        machine.run(FORWARDS[(from + 3) % 4], 50);
        assert_eq!(machine.count(), 1);
    }
}

/// The rounds are as long as the page says: 8 clocks without a step, 11 at the most.
#[test]
fn samples_are_eight_to_eleven_clocks_apart() {
    let apart = |steps: &dyn Fn(usize) -> u32| {
        let mut machine = Machine::started(steps(0));
        (0..100).for_each(|step| machine.run(steps(step), SLOWEST_CLOCKS));
        let apart = machine.samples.windows(2).map(|pair| pair[1] - pair[0]);
        (apart.clone().min().unwrap(), apart.max().unwrap())
    };
    assert_eq!(apart(&|_| 0), (8, 8));
    assert_eq!(apart(&|step| FORWARDS[step % 4]).1, SLOWEST_CLOCKS);
    assert_eq!(apart(&|step| FORWARDS[3 - step % 4]).1, 9);
    assert_eq!(apart(&|step| FORWARDS[step * 2 % 4]).1, 10);
}
