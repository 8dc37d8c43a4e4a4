//! What outlives a reset: the fault, or that a run was under way.

use breakaway_core::link::{FaultCause, FaultRecord, Mode};

use crate::board::{RETAINED_WORDS, Retained};

/// Marks retained words as ours; a change of their layout changes it.
const MAGIC: u32 = 0x42_72_6b_01;
/// In the place of a cause.
const NOTHING: u32 = 0;
const RUNNING: u32 = 0x100;
const PANIC: u32 = 0x101;

const MODES: [Mode; 6] = [Mode::Idle, Mode::Relay, Mode::Drive, Mode::Track, Mode::Hold, Mode::Fault];

/// What the retained memory says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Remembered {
    /// Nothing, or nothing valid (power-on).
    Nothing,
    /// A run was under way, started at this tick.
    Running(u32),
    /// The program panicked.
    Panic,
    /// A fault was latched.
    Fault(FaultRecord),
}

/// For the panic handler, after it has switched the drive off: the next start reports [`FaultCause::Panic`].
pub fn remember_panic(memory: &mut impl Retained) {
    memory.write(Remembered::Panic.to_words());
}

impl Remembered {
    pub(super) fn to_words(self) -> [u32; RETAINED_WORDS] {
        let mut words = match self {
            Self::Nothing => [MAGIC, NOTHING, 0, 0, 0, 0, 0, 0],
            Self::Running(tick) => [MAGIC, RUNNING, tick, 0, 0, 0, 0, 0],
            Self::Panic => [MAGIC, PANIC, 0, 0, 0, 0, 0, 0],
            Self::Fault(fault) => [
                MAGIC,
                number(&FaultCause::ALL, &fault.cause) + 1,
                fault.tick,
                fault.count as u32,
                u32::from(fault.drive_code as u16) | number(&MODES, &fault.mode) << 16,
                fault.value as u32,
                fault.limit as u32,
                0,
            ],
        };
        words[RETAINED_WORDS - 1] = check(&words);
        words
    }

    pub(super) fn from_words(words: [u32; RETAINED_WORDS]) -> Self {
        let [magic, cause, tick, count, drive_and_mode, value, limit, sum] = words;
        if magic != MAGIC || sum != check(&words) {
            return Self::Nothing;
        }
        match cause {
            RUNNING => return Self::Running(tick),
            PANIC => return Self::Panic,
            _ => {}
        }
        let cause = FaultCause::ALL.get((cause as usize).wrapping_sub(1));
        let mode = MODES.get((drive_and_mode >> 16) as usize);
        let (Some(&cause), Some(&mode)) = (cause, mode) else {
            return Self::Nothing;
        };
        Self::Fault(FaultRecord {
            cause,
            mode,
            tick,
            count: count as i32,
            drive_code: drive_and_mode as u16 as i16,
            value: value as i32,
            limit: limit as i32,
        })
    }
}

/// The place in the list, which must therefore only grow at its end.
fn number<T: PartialEq>(list: &[T], item: &T) -> u32 {
    list.iter().position(|entry| entry == item).unwrap_or(list.len()) as u32
}

/// FNV-1a over all words but the last.
fn check(words: &[u32; RETAINED_WORDS]) -> u32 {
    words.iter().take(RETAINED_WORDS - 1).fold(0x811c_9dc5, |sum, word| (sum ^ word).wrapping_mul(0x0100_0193))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_remembered_is_what_was_written_and_noise_is_nothing() {
        for cause in FaultCause::ALL {
            let mode = Mode::Track;
            let fault =
                FaultRecord { cause, mode, tick: u32::MAX, count: -5, drive_code: -7, value: i32::MIN, limit: 9 };
            let words = Remembered::Fault(fault).to_words();
            assert_eq!(Remembered::from_words(words), Remembered::Fault(fault));
            for bit in 0..32 * RETAINED_WORDS {
                let mut spoilt = words;
                spoilt[bit / 32] ^= 1 << (bit % 32);
                assert_eq!(Remembered::from_words(spoilt), Remembered::Nothing, "bit {bit} of {cause:?}");
            }
        }
        for state in [Remembered::Running(3), Remembered::Panic, Remembered::Nothing] {
            assert_eq!(Remembered::from_words(state.to_words()), state);
        }
        assert_eq!(Remembered::from_words([0; RETAINED_WORDS]), Remembered::Nothing);
        assert_eq!(Remembered::from_words([u32::MAX; RETAINED_WORDS]), Remembered::Nothing);
    }
}
