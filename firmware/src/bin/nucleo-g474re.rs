//! The NUCLEO-G474RE's image: see `docs/board-nucleo-g474re.md`.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image {
    use breakaway_core::link::Settings;
    use breakaway_firmware::app::{
        App, Channels, Identity, PositionController, PowerStage, Sums, Tick, TickSettings, TrackController, Wish,
        guards, remember_panic,
    };
    use breakaway_firmware::board::RetainedRam;
    use breakaway_firmware::board::nucleo_g474re::constants::{DRIVE_MAX_CODE, NAME, SETTINGS_BYTES, TICK_HZ};
    use breakaway_firmware::board::nucleo_g474re::{
        Nucleo, Parts, Serial, SettingsFlash, TickSlot, acknowledge_ecc, open_all_switches, start,
    };
    use breakaway_firmware::storage::FlashStore;
    use cortex_m::asm::wfi;
    use cortex_m::peripheral::SCB;
    use cortex_m::singleton;
    use cortex_m_rt::{ExceptionFrame, entry, exception};
    use defmt_rtt as _;
    use embassy_stm32::interrupt;

    type BoardApp = App<'static, 'static, TrackController, Serial, FlashStore<SettingsFlash>>;
    type BoardTick = Tick<'static, 'static, Nucleo, TrackController>;
    type BoardChannels = Channels<'static, <TrackController as PositionController>::Plan>;

    static TICK: TickSlot<BoardTick> = TickSlot::empty();

    #[entry]
    fn main() -> ! {
        let Parts { board, ticks, serial, flash, current_range_ma } = start();
        let identity = Identity {
            board: NAME,
            build: env!("BREAKAWAY_BUILD"),
            tick_hz: TICK_HZ,
            drive_max_code: DRIVE_MAX_CODE,
            current_range_ma,
            power_stage: PowerStage::Bridge,
        };
        defmt::info!("{=str} {=str}: {=u32} ticks/s", identity.board, identity.build, identity.tick_hz);
        if current_range_ma == 0 {
            defmt::info!("no shunt amplifier: the current is not measured");
        }
        let Some(mut store) = FlashStore::new(flash, 0..SETTINGS_BYTES) else {
            panic!("the settings have two pages");
        };
        let defaults = Settings::default();
        let loaded = store.load(Settings { drive_max_code: defaults.drive_max_code.min(DRIVE_MAX_CODE), ..defaults });
        if let Some((_, found)) = loaded.lost {
            defmt::warn!("stored settings or model lost, version found {=i32}", found);
        }
        let (Some(channels), Some(sums)) =
            (singleton!(: BoardChannels = Channels::new()), singleton!(: Sums = Sums::new()))
        else {
            panic!("started twice");
        };
        let (tick_end, app_end) = channels.split();
        let guards = guards(&loaded, &identity);
        let tick =
            Tick::new(board, TrackController::<f32>::default(), tick_end, TickSettings::at_rate(TICK_HZ), guards);
        let app = App::new(app_end, TrackController::<f32>::default(), serial, store, identity, loaded, sums);
        let (Some(tick), Some(app)) = (singleton!(: BoardTick = tick), singleton!(: BoardApp = app)) else {
            panic!("started twice");
        };
        ticks.run(&TICK, tick);
        defmt::info!("ticking");
        loop {
            let wish = app.poll();
            if wish == Wish::Reboot {
                stop();
            }
            // The tick wakes it, at the latest.
            wfi();
        }
    }

    #[interrupt]
    fn TIM6_DAC() {
        TICK.on_interrupt(BoardTick::tick);
    }

    /// Switches off, then resets.
    fn stop() -> ! {
        cortex_m::interrupt::disable();
        open_all_switches();
        SCB::sys_reset();
    }

    /// What a broken program does: off at once, then a reset, after which the fault is reported.
    fn give_up() -> ! {
        cortex_m::interrupt::disable();
        open_all_switches();
        remember_panic(&mut RetainedRam);
        SCB::sys_reset();
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        give_up()
    }

    #[exception]
    unsafe fn HardFault(_: &ExceptionFrame) -> ! {
        give_up()
    }

    #[exception]
    unsafe fn DefaultHandler(_: i16) {
        give_up()
    }

    #[exception]
    unsafe fn NonMaskableInt() {
        if !acknowledge_ecc() {
            give_up()
        }
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("an image for a microcontroller: see docs/board-nucleo-g474re.md");
}
