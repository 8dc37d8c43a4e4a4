//! The tick alone, with its controllers in fixed point, for a core without an FPU. `cargo xtask budget` builds it.
//! The linked file proves that nothing in it computes in floating point or can panic.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image {
    use core::hint::black_box;

    use breakaway_core::link::Settings;
    use breakaway_core::scalar::Q32;
    use breakaway_firmware::app::{Channels, Guards, Tick, TickSettings, TrackController};
    use breakaway_firmware::board::{Applied, Clock, Drive, Encoder, Protection, RETAINED_WORDS, Retained, Trip};

    /// A board of which the compiler knows nothing.
    struct Opaque([u32; RETAINED_WORDS]);

    impl Encoder for Opaque {
        type Error = u8;
        fn count(&mut self) -> Result<i32, u8> {
            black_box(Ok(0))
        }
    }
    impl Drive for Opaque {
        type Error = u8;
        fn enable(&mut self) -> Result<(), u8> {
            black_box(Ok(()))
        }
        fn apply(&mut self, command: i32) -> Result<Applied, u8> {
            black_box(Ok(Applied { code: command as i16, limited: false }))
        }
        fn off(&mut self) -> Result<(), u8> {
            black_box(Ok(()))
        }
    }
    impl Clock for Opaque {
        fn now_us(&self) -> u32 {
            black_box(0)
        }
    }
    impl Protection for Opaque {
        fn tripped(&mut self) -> Option<Trip> {
            black_box(None)
        }
        fn current_ma(&mut self) -> Option<i32> {
            black_box(None)
        }
        fn feed_watchdog(&mut self) {}
    }
    impl Retained for Opaque {
        fn read(&self) -> [u32; RETAINED_WORDS] {
            black_box(self.0)
        }
        fn write(&mut self, words: [u32; RETAINED_WORDS]) {
            self.0 = black_box(words);
        }
    }
    /// Entered by nobody: the file is looked at, not run.
    #[unsafe(no_mangle)]
    pub extern "C" fn integer_tick() -> ! {
        let mut channels = Channels::new();
        let (tick_end, mut app_end) = channels.split();
        let guards = Guards::new(&black_box(SETTINGS), black_box(10_000));
        let timing = black_box(TickSettings { period_us: 100, deadline_us: 50 });
        let mut tick =
            Tick::new(Opaque([0; RETAINED_WORDS]), TrackController::<Q32>::default(), tick_end, timing, guards);
        loop {
            // Whatever the thread may have put there.
            black_box(&mut app_end);
            black_box(&mut tick).tick();
        }
    }

    /// Any will do: the compiler must not know them.
    const SETTINGS: Settings = Settings {
        drive_max_code: 1,
        travel_min_counts: 0,
        travel_max_counts: 1,
        speed_max_counts_per_s: 1,
        current_max_ma: 1,
        mean_drive_max_code: 1,
        frozen_ticks: 1,
        frozen_drive_code: 1,
        jump_counts: 1,
        overrun_limit: 1,
        command_timeout_ms: 10,
        hysteresis_counts: 1,
        encoder_reversed: false,
        counts_per_revolution: 1,
        position_per_count: 1.0,
        position_unit: breakaway_core::link::PositionUnit::Radian,
        drive_full_scale: 1.0,
        drive_unit: breakaway_core::link::DriveUnit::Volt,
        brake: true,
        supply_v: 1.0,
        motor_resistance_ohm: 1.0,
        motor_inductance_h: 0.0,
        current_bandwidth_hz: 0.0,
    };

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
    eprintln!("the tick alone, to be looked at by `cargo xtask budget`");
}
