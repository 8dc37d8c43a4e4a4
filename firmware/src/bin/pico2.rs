//! The image of the Raspberry Pi Pico 2: see `docs/board-pico2.md`.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image {
    use breakaway_firmware::app::{
        App, Channels, Identity, PositionController, PowerStage, Sums, Tick, TickSettings, TrackController, Wish,
        guards, remember_panic,
    };
    use breakaway_firmware::board::RetainedRam;
    use breakaway_firmware::board::pico2::constants::{DRIVE_MAX_CODE, NAME, SETTINGS_BYTES, TICK_HZ};
    use breakaway_firmware::board::pico2::{
        Parts, Pico2, Serial, SettingsFlash, TickSlot, defaults, on_stop, reset, start, switch_off,
    };
    use breakaway_firmware::storage::FlashStore;
    use cortex_m::asm::wfi;
    use cortex_m::singleton;
    use cortex_m_rt::{entry, exception};
    use rp235x_hal::pac::interrupt;

    type BoardApp = App<'static, 'static, TrackController, Serial, FlashStore<SettingsFlash>>;
    type BoardTick = Tick<'static, 'static, Pico2, TrackController>;
    type BoardChannels = Channels<'static, <TrackController as PositionController>::Plan>;

    static TICK: TickSlot<BoardTick> = TickSlot::empty();

    #[entry]
    fn main() -> ! {
        let Parts { board, ticks, serial, flash } = start();
        let identity = Identity {
            board: NAME,
            build: env!("BREAKAWAY_BUILD"),
            tick_hz: TICK_HZ,
            drive_max_code: DRIVE_MAX_CODE,
            current_range_ma: 0,
            power_stage: PowerStage::Bridge,
        };
        let Some(mut store) = FlashStore::new(flash, 0..SETTINGS_BYTES) else {
            panic!("the settings have two sectors");
        };
        let loaded = store.load(defaults());
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
        loop {
            if app.poll() == Wish::Reboot {
                reset();
            }
            // The tick wakes it, at the latest.
            wfi();
        }
    }

    #[interrupt]
    fn PWM_IRQ_WRAP_0() {
        TICK.on_interrupt(BoardTick::tick);
    }

    #[interrupt]
    fn IO_IRQ_BANK0() {
        on_stop();
    }

    /// What a broken program does: off at once, then a reset, after which the fault is reported.
    extern "C" fn give_up() -> ! {
        switch_off();
        remember_panic(&mut RetainedRam);
        reset()
    }

    // A stack that is full is a fault whose handler needs some of it, so the limit is lifted first. What is below the
    // stack is the program's own memory, which is lost with the reset.
    core::arch::global_asm!(
        ".section .text.HardFault, \"ax\", %progbits",
        ".global HardFault",
        ".type HardFault, %function",
        ".thumb_func",
        "HardFault:",
        "movs r0, #0",
        "msr msplim, r0",
        "b {give_up}",
        ".size HardFault, . - HardFault",
        ".text",
        give_up = sym give_up,
    );

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        give_up()
    }

    #[exception]
    unsafe fn DefaultHandler(_: i16) {
        give_up()
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("an image for a microcontroller: see docs/board-pico2.md");
}
