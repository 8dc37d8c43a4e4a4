//! The virtual board's image: see `docs/virtual-board.md`.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image {
    use breakaway_firmware::app::{
        App, Channels, Identity, PowerStage, Sums, Tick, TickSettings, TrackController, Wish, guards, remember_panic,
    };
    use breakaway_firmware::board::mps2_an386::{Link, Lockstep, Received, SimulatedFlash, Uart, Virtual};
    use breakaway_firmware::storage::FlashStore;
    use cortex_m::asm::wfi;
    use cortex_m::peripheral::SCB;
    use cortex_m_rt::entry;

    #[entry]
    fn main() -> ! {
        let mut lockstep = Lockstep::new(Uart::plant());
        let (tick_hz, defaults) = loop {
            if let Some(Received::Start(tick_hz, settings)) = lockstep.poll() {
                break (tick_hz.max(1), settings);
            }
            wfi();
        };
        let identity = Identity {
            board: "mps2-an386",
            build: env!("BREAKAWAY_BUILD"),
            tick_hz,
            drive_max_code: breakaway_core::link::FULL_SCALE_CODE,
            current_range_ma: 0,
            power_stage: PowerStage::AsSet,
        };
        let Some(mut store) = FlashStore::new(SimulatedFlash::open(true), 0..4096) else {
            panic!("the simulated flash has two pages");
        };
        let loaded = store.load(defaults);
        let mut channels = Channels::new();
        let (tick_end, app_end) = channels.split();
        let mut sums = Sums::new();
        let timing = TickSettings::at_rate(tick_hz);
        let start = guards(&loaded, &identity);
        let mut tick = Tick::new(Virtual::default(), TrackController::<f32>::default(), tick_end, timing, start);
        let mut app =
            App::new(app_end, TrackController::<f32>::default(), Link::new(), store, identity, loaded, &mut sums);
        loop {
            match lockstep.poll() {
                Some(Received::Tick(next)) => {
                    tick.board().next(&next, timing.period_us);
                    tick.tick();
                    lockstep.answer(tick.board().code());
                }
                Some(Received::Start(..)) | None => {}
            }
            if app.poll() == Wish::Reboot {
                SCB::sys_reset();
            }
            // A byte of the plant or of the link wakes it. QEMU would take a whole core of the host otherwise.
            wfi();
        }
    }

    /// The drive goes off with the reset: the board then asks for a start, and drives nothing.
    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        remember_panic(&mut Virtual::default());
        SCB::sys_reset();
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("an image for a microcontroller: build it by `cargo xtask image`, run it by `breakaway virtual-board`");
}
