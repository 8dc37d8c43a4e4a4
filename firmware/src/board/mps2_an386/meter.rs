//! How many instructions a piece of code takes, under QEMU's `-icount`.

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_semihosting::{debug, hprintln};

/// The counter's 24 bits.
const RELOAD: u32 = 0x00ff_ffff;

/// SysTick counts while instructions are executed.
pub struct Meter {
    /// Counts per instruction, Q8, from a stretch of known length.
    per_instruction_q8: u32,
    /// Counts of nothing.
    overhead: u32,
}

impl Meter {
    /// Starts the counter.
    pub fn new(mut systick: SYST) -> Self {
        systick.set_clock_source(SystClkSource::Core);
        systick.set_reload(RELOAD);
        systick.clear_current();
        systick.enable_counter();
        let overhead = Self::counts(|| {});
        let many = Self::counts(|| nops());
        Self { per_instruction_q8: (many - overhead) * 256 / 202, overhead }
    }

    /// Counts during `work`, with what counting itself takes.
    #[inline]
    pub fn counts(work: impl FnOnce()) -> u32 {
        let before = SYST::get_current();
        work();
        let after = SYST::get_current();
        before.wrapping_sub(after) & RELOAD
    }

    /// The instructions of `counts`, in units of 1/`per`.
    pub fn instructions_of(&self, counts: u64, per: u32) -> u64 {
        let unit = u64::from(self.per_instruction_q8);
        (counts * u64::from(per) * 256 + unit / 2) / unit
    }

    /// Instructions of `work`.
    #[inline]
    pub fn instructions(&self, work: impl FnOnce()) -> u32 {
        self.instructions_of(u64::from(Self::counts(work).saturating_sub(self.overhead)), 1) as u32
    }
}

/// 200 instructions beside the call and the return. A function of its own: the compiler would take the repetition for
/// one line, and misplace constants beside it.
#[unsafe(naked)]
extern "C" fn nops() {
    core::arch::naked_asm!(".rept 200", "nop", ".endr", "bx lr")
}

/// Ends QEMU where an image has measured.
pub fn done() -> ! {
    end(debug::EXIT_SUCCESS)
}

/// Ends QEMU where a measuring image has panicked, and says why.
pub fn panicked(info: &core::panic::PanicInfo<'_>) -> ! {
    hprintln!("{}", info);
    end(debug::EXIT_FAILURE)
}

fn end(status: debug::ExitStatus) -> ! {
    debug::exit(status);
    loop {
        cortex_m::asm::wfi();
    }
}
