//! Measures on the virtual board, under `-icount`: instructions per tick, and how deep the stack goes. Prints
//! `name = number` lines for `cargo xtask budget` and ends QEMU.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image {
    use breakaway_core::link::{
        Adaptive, Bounds, Command, ControllerGains, ErrorRate, FULL_SCALE_CODE, MAX_FRAME, Mode, Model, Reference,
        Relay, Request, Settings, Track, Trajectory, encode,
    };
    use breakaway_firmware::app::{
        App, Channels, Identity, PowerStage, Sums, Tick, TickSettings, TrackController, TrackPlan, guards,
    };
    use breakaway_firmware::board::mps2_an386::{Meter, Next, SimulatedFlash, Virtual, done, panicked};
    use breakaway_firmware::board::{Board, Encoder, Retained, Wire, routines};
    use breakaway_firmware::storage::FlashStore;
    use cortex_m::peripheral::Peripherals;
    use cortex_m_rt::entry;
    use cortex_m_semihosting::hprintln;

    const TICK_HZ: u32 = 1000;
    /// What unused stack is filled with.
    const PAINT: u32 = 0xa5a5_a5a5;

    /// What the host sends.
    #[derive(Default)]
    struct Host {
        frame: heapless::Vec<u8, MAX_FRAME>,
        sent: usize,
    }

    /// The link, in memory.
    struct Line<'a>(&'a core::cell::RefCell<Host>);

    impl Wire for Line<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> usize {
            let mut host = self.0.borrow_mut();
            let rest = host.frame.get(host.sent..).unwrap_or_default();
            let read = rest.len().min(buffer.len());
            rest.iter().zip(buffer).for_each(|(byte, slot)| *slot = *byte);
            host.sent += read;
            read
        }

        fn write(&mut self, bytes: &[u8]) -> usize {
            bytes.len()
        }
    }

    /// A plant in integers: an inertia with Coulomb friction, enough for a limit cycle.
    #[derive(Default)]
    struct Plant {
        speed_q16: i32,
        position_q16: i64,
    }

    impl Plant {
        fn advance(&mut self, code: i16) -> i32 {
            let friction = FULL_SCALE_CODE / 10;
            let against = i32::from(friction) * self.speed_q16.signum();
            self.speed_q16 += (i32::from(code) - against) / 4 - self.speed_q16 / 256;
            self.position_q16 += i64::from(self.speed_q16);
            (self.position_q16 >> 16) as i32
        }
    }

    unsafe extern "C" {
        static mut _stack_end: u32;
    }

    /// Fills the stack below this function's frame.
    #[inline(never)]
    fn paint() {
        let mut word = &raw mut _stack_end;
        let top = cortex_m::register::msp::read() as usize - 256;
        while (word as usize) < top {
            // SAFETY: between the end of the statics and 256 bytes below the stack pointer: memory nobody uses yet.
            unsafe { word.write_volatile(PAINT) };
            // SAFETY: stays below the stack pointer.
            word = unsafe { word.add(1) };
        }
    }

    /// Bytes of stack that have been used since it was painted.
    fn high_water() -> u32 {
        let mut word = &raw mut _stack_end;
        let start = breakaway_stack_start();
        // SAFETY: inside the stack, whose start bounds it.
        while (word as u32) < start && unsafe { word.read_volatile() } == PAINT {
            // SAFETY: as above.
            word = unsafe { word.add(1) };
        }
        start - word as u32
    }

    /// The first word of the vector table.
    fn breakaway_stack_start() -> u32 {
        // SAFETY: the vector table is at address 0 here.
        unsafe {
            let mut first: u32;
            core::arch::asm!("ldr {0}, [{0}]", inout(reg) 0_u32 => first);
            first
        }
    }

    fn relay(h1: i16, h2: i16) -> Command {
        Command::StartRelay(Relay {
            h1_code: h1,
            h2_code: h2,
            hysteresis_counts: Some(1),
            reference: Reference::default(),
            until_settled: false,
            append: true,
            bounds: Bounds { max_ticks: 6000, ..Bounds::default() },
        })
    }

    /// A model for the integer plant, in volts and radians of the settings: only its size matters here.
    fn model() -> Model {
        Model { b: 0.03, c: 0.1, f1: 0.5, effects: heapless::Vec::new() }
    }

    /// The adaptive law along a sine, with compensation.
    fn adaptive() -> Command {
        Command::StartTrack(Track {
            trajectory: Trajectory::Sine { amplitude: 1.0, period_s: 2.0 },
            controller: ControllerGains::Adaptive(Adaptive {
                kv: 50.0,
                lambda1: 100.0,
                lambda2: 50.0,
                delta: 0.5,
                error_rate: ErrorRate { filter_s: 1e-3, observer_rad_s: 500.0 },
                rates: [0.5; 5],
            }),
            feed_forward: true,
            compensation: true,
            bounds: Bounds { max_ticks: 3000, ..Bounds::default() },
        })
    }

    #[entry]
    fn main() -> ! {
        paint();
        let Some(peripherals) = Peripherals::take() else {
            panic!("taken twice");
        };
        assert!(routines::hold(), "a routine of board/routines.rs is wrong");
        let meter = Meter::new(peripherals.SYST);
        Virtual::default().retained().write([0; 8]);
        let identity = Identity {
            board: "budget",
            build: "",
            tick_hz: TICK_HZ,
            drive_max_code: FULL_SCALE_CODE,
            current_range_ma: 0,
            power_stage: PowerStage::AsSet,
        };
        let settings = Settings {
            drive_max_code: FULL_SCALE_CODE,
            mean_drive_max_code: FULL_SCALE_CODE,
            travel_min_counts: i32::MIN,
            travel_max_counts: i32::MAX,
            command_timeout_ms: 3_600_000,
            ..Settings::default()
        };
        let Some(mut store) = FlashStore::new(SimulatedFlash::open(false), 0..4096) else {
            panic!("two pages");
        };
        let loaded = store.load(settings);
        let timing = TickSettings::at_rate(TICK_HZ);
        let channels = cortex_m::singleton!(: Channels<'static, TrackPlan> = Channels::new());
        let (Some(channels), Some(sums)) = (channels, cortex_m::singleton!(: Option<Sums> = None)) else {
            panic!("taken twice");
        };
        let sums = sums.insert(Sums::new());
        let (tick_end, app_end) = channels.split();
        let start = guards(&loaded, &identity);
        let mut tick = Tick::new(Virtual::default(), TrackController::<f32>::default(), tick_end, timing, start);
        let host = core::cell::RefCell::new(Host::default());
        let mut app = App::new(app_end, TrackController::<f32>::default(), Line(&host), store, identity, loaded, sums);
        let mut plant = Plant::default();
        let (mut ticks, mut total, mut worst, mut idle) = (0_u32, 0_u64, 0, 0);
        let commands = [
            relay(12_000, 9_000),
            relay(6_000, 6_500),
            Command::Identify,
            Command::LoadModel(model()),
            Command::Save,
            adaptive(),
        ];
        let (mut tracked, mut track_total, mut track_worst) = (0_u32, 0_u64, 0);
        for (id, command) in commands.into_iter().enumerate() {
            let mut frame = [0; MAX_FRAME];
            let used = encode(&Request { id: id as u16, command }, &mut frame).unwrap_or(0);
            {
                let mut host = host.borrow_mut();
                host.frame = heapless::Vec::from_slice(&frame[..used]).unwrap_or_default();
                host.sent = 0;
            }
            for _ in 0..6200 {
                let code = tick.board().code();
                let next = Next { count: Some(plant.advance(code)), late_us: 0, trip: None };
                tick.board().next(&next, timing.period_us);
                let before = tick.mode();
                let spent = meter.instructions(|| tick.tick());
                match (before, tick.mode()) {
                    (Mode::Relay, Mode::Relay) => {
                        ticks += 1;
                        total += u64::from(spent);
                        worst = worst.max(spent);
                    }
                    (Mode::Track, Mode::Track) => {
                        tracked += 1;
                        track_total += u64::from(spent);
                        track_worst = track_worst.max(spent);
                    }
                    (Mode::Idle, _) => idle = idle.max(spent),
                    _ => {}
                }
                app.poll();
            }
        }
        let _ = tick.board().encoder().count();
        hprintln!("relay_ticks = {}", ticks);
        hprintln!("relay_tick_mean = {}", total / u64::from(ticks.max(1)));
        hprintln!("relay_tick_worst = {}", worst);
        hprintln!("adaptive_ticks = {}", tracked);
        hprintln!("adaptive_tick_mean = {}", track_total / u64::from(tracked.max(1)));
        hprintln!("adaptive_tick_worst = {}", track_worst);
        hprintln!("idle_tick_worst = {}", idle);
        hprintln!("tick_bytes = {}", size_of_val(&tick));
        hprintln!("app_bytes = {}", size_of_val(&app));
        hprintln!("channels_bytes = {}", size_of::<Channels<'static, TrackPlan>>());
        hprintln!("sums_bytes = {}", size_of::<Sums>());
        hprintln!("stack_bytes = {}", high_water());
        done()
    }

    #[panic_handler]
    fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
        panicked(info)
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("an image for the virtual board: run it by `cargo xtask budget`");
}
