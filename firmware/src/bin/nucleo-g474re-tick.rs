//! The tick of the NUCLEO-G474RE alone, with its drivers. `cargo xtask test` builds it. It links only if no panic can
//! be reached from the tick.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image {
    use breakaway_firmware::app::{Tick, TrackController};
    use breakaway_firmware::board::nucleo_g474re::Nucleo;

    /// Entered by nobody: the file is linked, not run.
    #[unsafe(no_mangle)]
    pub extern "C" fn nucleo_tick(tick: &mut Tick<'static, 'static, Nucleo, TrackController>) {
        tick.tick();
    }

    unsafe extern "C" {
        /// Nowhere defined: linking fails where a panic is reachable, and names it.
        safe fn the_tick_must_not_panic() -> !;
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        the_tick_must_not_panic()
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("the tick alone, to be linked by `cargo xtask test`");
}
