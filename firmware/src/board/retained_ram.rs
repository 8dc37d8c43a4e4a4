//! Words in RAM that start-up code leaves alone.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

use crate::board::{RETAINED_WORDS, Retained};

struct Words(UnsafeCell<MaybeUninit<[u32; RETAINED_WORDS]>>);

// SAFETY: all accesses are volatile ones of whole words on a single core. Tick and panic handler are the only users, and
// after the panic handler nothing runs.
unsafe impl Sync for Words {}

#[unsafe(link_section = ".uninit.retained")]
static WORDS: Words = Words(UnsafeCell::new(MaybeUninit::uninit()));

/// The retained words.
pub struct RetainedRam;

impl Retained for RetainedRam {
    fn read(&self) -> [u32; RETAINED_WORDS] {
        let words = WORDS.0.get().cast::<u32>();
        // SAFETY: inside WORDS; after power-on RAM holds some bits or other, and any are a valid u32. Volatile, so that
        // the compiler does not take them for undefined.
        core::array::from_fn(|i| unsafe { words.add(i).read_volatile() })
    }

    fn write(&mut self, values: [u32; RETAINED_WORDS]) {
        let words = WORDS.0.get().cast::<u32>();
        for (i, value) in values.into_iter().enumerate() {
            // SAFETY: inside WORDS.
            unsafe { words.add(i).write_volatile(value) };
        }
    }
}
