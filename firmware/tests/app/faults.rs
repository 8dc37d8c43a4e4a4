//! Faults: the drive goes off, the cause and its numbers are kept, through a reset, until a command clears them.

use breakaway_core::excite::waveform::Shape;
use breakaway_core::link::{
    Bounds, Command, CommandError, Ending, Event, FaultCause, FaultRecord, Mode, OpenLoop, Reply, Settings, Trajectory,
};
use breakaway_core::plant::{Effect, Kind, Plant};
use breakaway_firmware::app::{
    Channels, ControlPlan, Guards, Path, Planner, PositionController, RunOrder, SetPointOutlet, Tick, TickSettings,
    TrackController, TrackPlan, remember_panic,
};
use breakaway_firmware::board::{Applied, Trip};
use breakaway_firmware::storage::Loaded;
use breakaway_rig::{Motion, code, relay};

use crate::bench::{Bench, World, settings};
use crate::track::{adaptive, model, pid, track};

/// A relay experiment in full swing.
fn running() -> Bench {
    let mut bench = Bench::new();
    assert_eq!(bench.command(Command::StreamOn { decimation: 1 }), Reply::Done);
    assert_eq!(bench.command(Command::StartRelay(relay(2.0, 1.5, 0))), Reply::Done);
    bench.steps(2000);
    bench
}

/// Breaks something and returns the fault, which must come within `ticks`.
fn after(bench: &mut Bench, ticks: u32, cause: FaultCause, fault: impl FnOnce(&mut World)) -> FaultRecord {
    let broken_at = bench.status().tick;
    bench.events.clear();
    fault(&mut bench.world.0.borrow_mut());
    let mut waited = 0;
    while bench.world.0.borrow().enabled {
        assert!(waited < ticks, "{cause:?}: the drive is still on after {ticks} ticks");
        bench.step();
        waited += 1;
    }
    assert_eq!(bench.world.0.borrow().drive, 0);
    bench.steps(10);
    let record = bench.fault().expect("a fault");
    assert_eq!((record.cause, record.mode), (cause, Mode::Relay));
    assert!(record.tick.wrapping_sub(broken_at) <= ticks + 1);
    assert!(bench.events.contains(&Event::FaultRaised(record)));
    let ended = bench.until_ended(1);
    assert_eq!(ended.ending, Ending::Fault(cause));
    // Everything up to the fault has been captured, without a gap.
    let ticks: Vec<u32> = bench.samples.iter().map(|sample| sample.tick).collect();
    assert!(ticks.windows(2).all(|pair| pair[1] == pair[0] + 1 || cause == FaultCause::EncoderError));
    record
}

#[test]
fn a_frozen_encoder() {
    let mut bench = running();
    // 200 ticks of the settings, and up to half a cycle (T = 0.72 s) until both relays push the same way.
    let record = after(&mut bench, 200 + 362, FaultCause::EncoderFrozen, |world| {
        world.frozen = Some((world.plant.state.x / 1e-3) as i32);
    });
    assert_eq!((record.value, record.limit), (200, 200));
}

/// One channel of the encoder dead: the live one makes the count toggle by 1, which is no motion.
#[test]
fn a_dead_channel_of_the_encoder() {
    let mut bench = running();
    let record = after(&mut bench, 200 + 362, FaultCause::EncoderFrozen, |world| {
        world.dead_channel = Some((world.plant.state.x / 1e-3) as i32);
    });
    assert_eq!((record.value, record.limit), (200, 200));
    // Dead from the start, under a controller. It shows from the error on at which the drive is frozen_drive_code, a
    // quarter of a turn of the sine at the most.
    let mut bench = Bench::new();
    bench.world.0.borrow_mut().dead_channel = Some(0);
    assert_eq!(bench.command(Command::LoadModel(model())), Reply::Done);
    let sine = Trajectory::Sine { amplitude: 1.0, period_s: 2.0 };
    assert_eq!(bench.command(track(sine, pid(), false)), Reply::Done);
    assert_eq!(bench.until_ended(500 + 200).ending, Ending::Fault(FaultCause::EncoderFrozen));
    assert!(!bench.world.0.borrow().enabled);
}

/// A frozen encoder under a drive that changes its sign in less than `frozen_ticks`. The drive of a sine of 5 Hz is
/// at frozen_drive_code for two thirds of its 200 ticks, never for 200 in a row.
#[test]
fn a_frozen_encoder_under_an_alternating_drive() {
    let mut bench = Bench::new();
    bench.world.0.borrow_mut().frozen = Some(0);
    let bounds = Bounds { max_ticks: 4000, ..Bounds::default() };
    let phase_step = 21_474_836; // 5 Hz at 1 kHz
    let sine = OpenLoop { shape: Shape::Sine, amplitude_code: code(2.5), phase_step, centring_q16: 0, bounds };
    assert_eq!(bench.command(Command::StartDrive(sine)), Reply::Done);
    let ended = bench.until_ended(4100);
    assert_eq!(ended.ending, Ending::Fault(FaultCause::EncoderFrozen));
    // 67 ticks of each half period, up to 5/6 of it: the 200th is in the third.
    assert!((281..=285).contains(&ended.ticks), "{ended:?}");
    // The same drive on an encoder that works: 2.5 V at 5 Hz moves the axis by 2·2.5/(b·ω²) = 0.19 rad, and friction brakes it.
    let mut bench = Bench::new();
    assert_eq!(bench.command(Command::StartDrive(sine)), Reply::Done);
    assert_eq!(bench.until_ended(4100).ending, Ending::TimeUp);
}

#[test]
fn an_encoder_that_jumps_or_dies() {
    let record = after(&mut running(), 1, FaultCause::EncoderJump, |world| world.jump = 5000);
    assert!(record.value > 4900 && record.limit == 1000, "{record:?}");
    let mut bench = running();
    after(&mut bench, 1, FaultCause::EncoderError, |world| world.dead_encoder = true);
    // Still dead: not to be cleared.
    assert_eq!(bench.command(Command::ClearFault), Reply::Error(CommandError::FaultPersists));
}

#[test]
fn a_reversed_encoder_closes_no_loop() {
    let mut bench = Bench::new();
    bench.world.0.borrow_mut().reversed = true;
    assert_eq!(bench.command(Command::StartRelay(relay(2.0, 1.5, 0))), Reply::Done);
    let ended = bench.until_ended(200);
    assert_eq!(ended.ending, Ending::Fault(FaultCause::WrongDirection));
    let record = bench.fault().unwrap();
    // 1/64 of a revolution, 0.064 rad, at full drive: 3 V / 0.02685 is 112 rad/s².
    assert_eq!((record.value.signum(), record.limit), (-1, 64));
    assert!(record.tick < 60, "{record:?}");
    // With the setting that says so the same machine runs.
    let right = breakaway_core::link::Settings { encoder_reversed: true, ..settings() };
    assert_eq!(bench.command(Command::ClearFault), Reply::Done);
    assert_eq!(bench.command(Command::SetSettings(right)), Reply::Done);
    bench.events.clear();
    assert_eq!(bench.command(Command::StartRelay(relay(2.0, 1.5, 1500))), Reply::Done);
    assert_eq!(bench.until_ended(1600).ending, Ending::TimeUp);
}

/// Noise of a count makes the drive change its sign before the axis has moved; the guard watches all the same.
#[test]
fn a_reversed_encoder_with_noise_closes_no_loop() {
    let limit = 64;
    for noise_counts in [1, 2] {
        let mut worst = [0_i32; 3];
        for seed in 0..20_u32 {
            let world = |bench: &Bench| {
                let mut world = bench.world.0.borrow_mut();
                (world.reversed, world.noise_counts, world.noise) =
                    (true, noise_counts, seed.wrapping_mul(0x9e37_79b9));
            };
            let relays = Command::StartRelay(relay(2.0, 1.5, 4000));
            let sine = Trajectory::Sine { amplitude: 1.0, period_s: 2.0 };
            let runs = [relays, track(sine, pid(), false), track(sine, adaptive(), false)];
            for (command, worst) in runs.into_iter().zip(&mut worst) {
                let mut bench = Bench::new();
                world(&bench);
                assert_eq!(bench.command(Command::LoadModel(model())), Reply::Done);
                assert_eq!(bench.command(command), Reply::Done);
                let ended = bench.until_ended(5000);
                assert_eq!(ended.ending, Ending::Fault(FaultCause::WrongDirection), "{noise_counts} {seed} {ended:?}");
                assert_eq!(bench.fault().unwrap().limit, limit);
                *worst = (*worst).max(bench.world.0.borrow().plant.counts().abs());
            }
        }
        println!("noise {noise_counts}: worst travel in counts, relay, PID, adaptive: {worst:?}");
        // Where the drive goes off: twice what is asked of the guard.
        assert!(worst.iter().all(|counts| *counts < 2 * limit), "{worst:?}");
    }
}

/// What stores energy, comes late, is loaded or swings along moves against its drive for a while; none of it is a reversed
/// encoder. At rest before each run; then a second run that starts while the axis coasts.
#[test]
fn machines_that_are_right_are_not_taken_for_reversed() {
    let machines: &[(Kind, &[f64])] = &[
        (Kind::Delay, &[0.005]),
        (Kind::ElectricalLag, &[0.004]),
        (Kind::ConstantLoad, &[0.45]),
        (Kind::ConstantLoad, &[-0.45]),
        (Kind::GravityLoad, &[0.45, 0.0]),
        (Kind::GravityLoad, &[2.0, 0.0]),
        (Kind::Spring, &[2.0, 0.0]),
        (Kind::Spring, &[0.5, 0.0]),
        (Kind::Cogging, &[0.45, 7.0, 0.5]),
        (Kind::Backlash, &[0.05, 0.6, 0.3]),
        (Kind::FlexibleCoupling, &[0.6, 60.0, 0.02]),
        (Kind::Stribeck, &[0.3, 0.5]),
        (Kind::LoadFriction, &[0.2]),
        (Kind::TimePeriodic, &[0.3, 20.0, 0.0]),
    ];
    let sine = |hz: f64| {
        let phase_step = (hz / 1000.0 * 4_294_967_296.0) as u32;
        let bounds = Bounds { max_ticks: 3000, ..Bounds::default() };
        Command::StartDrive(OpenLoop {
            shape: Shape::Sine,
            amplitude_code: code(2.5),
            phase_step,
            centring_q16: 0,
            bounds,
        })
    };
    let reference = Trajectory::Sine { amplitude: 1.0, period_s: 1.0 };
    for (kind, parameters) in machines {
        for noise_counts in [0, 2] {
            let runs = [
                Command::StartRelay(relay(2.0, 1.5, 3000)),
                sine(0.5),
                sine(3.0),
                sine(17.0),
                track(reference, pid(), false),
                track(reference, adaptive(), true),
            ];
            for (first, then) in runs.iter().zip(runs.iter().cycle().skip(1)) {
                let mut bench = Bench::new();
                {
                    let mut world = bench.world.0.borrow_mut();
                    world.noise_counts = noise_counts;
                    let axis = &mut world.plant;
                    axis.effects = vec![Effect::new(*kind, parameters)];
                    axis.state = Plant { base: axis.base, effects: &axis.effects }.at_rest(0.0);
                }
                assert_eq!(bench.command(Command::LoadModel(model())), Reply::Done);
                for command in [first, then] {
                    bench.events.clear();
                    assert_eq!(bench.command(command.clone()), Reply::Done);
                    let ended = bench.until_ended(4100);
                    // A spring holds the axis for the 200 ticks of the settings, which is a frozen encoder to the board.
                    let wrong = Ending::Fault(FaultCause::WrongDirection);
                    assert!(ended.ending != wrong, "{kind:?} {noise_counts} {command:?}: {ended:?}");
                    if bench.fault().is_some() {
                        assert_eq!(bench.command(Command::ClearFault), Reply::Done);
                    }
                }
            }
        }
    }
}

#[test]
fn a_silent_host() {
    let mut bench = running();
    bench.keep_alive = 0;
    // 1000 ms of the settings at 1 kHz.
    let record = after(&mut bench, 1001, FaultCause::LinkLost, |_| {});
    assert_eq!((record.value, record.limit), (1000, 1000));
}

#[test]
fn late_ticks() {
    let mut bench = running();
    let record = after(&mut bench, 4, FaultCause::TickOverrun, |world| world.late_us = 600);
    assert_eq!((record.value, record.limit), (3, 3));
    let fed = bench.world.0.borrow().fed;
    bench.steps(20);
    assert_eq!(bench.world.0.borrow().fed, fed, "late ticks do not feed the watchdog");
    assert!(bench.status().overruns >= 20);
}

/// What goes wrong in the world of the bench.
type Fault = fn(&mut World);

/// With the setting `brake` every end of a run holds the motor, but a trip of the power stage, which lets it coast.
#[test]
fn a_run_ends_braked_where_the_settings_say_so() {
    for brake in [false, true] {
        let trips: [(Fault, FaultCause, bool); 4] = [
            (|world| world.jump = 5000, FaultCause::EncoderJump, brake),
            (|world| world.trip = Some(Trip::Break(1)), FaultCause::BreakInput, false),
            (|world| world.trip = Some(Trip::EmergencyStop), FaultCause::EmergencyStop, false),
            (|world| world.broken_drive = true, FaultCause::DriveStage, false),
        ];
        for (fault, cause, braking) in trips {
            let mut bench = Bench::with_memory([0; 8], Settings { brake, ..settings() });
            assert_eq!(bench.command(Command::StreamOn { decimation: 1 }), Reply::Done);
            assert_eq!(bench.command(Command::StartRelay(relay(2.0, 1.5, 0))), Reply::Done);
            bench.steps(300);
            assert!(!bench.world.0.borrow().braking);
            after(&mut bench, 1, cause, fault);
            assert_eq!(bench.world.0.borrow().braking, braking, "{cause:?}");
        }
        let mut bench = Bench::with_memory([0; 8], Settings { brake, ..settings() });
        for end in [0, 100] {
            assert_eq!(bench.command(Command::StartRelay(relay(2.0, 1.5, end))), Reply::Done);
            bench.steps(120);
            assert_eq!(bench.command(Command::Stop), Reply::Done);
            assert_eq!((bench.world.0.borrow().braking, bench.world.0.borrow().drive), (brake, 0));
        }
    }
}

/// A debugger halts the core for 50 ms in mid-run, and lets it go on. The drive is off before the first tick after it
/// drives.
#[test]
fn a_halt_of_the_core_is_not_driven_on() {
    let mut bench = running();
    let before = bench.world.0.borrow().drive;
    bench.world.0.borrow_mut().now_us += 50_000;
    bench.step();
    assert!(before != 0 && bench.world.0.borrow().drive == 0 && !bench.world.0.borrow().enabled);
    let record = bench.fault().unwrap();
    // 51 periods where there should be one; three late ticks in a row are the settings' limit.
    assert_eq!((record.cause, record.value, record.limit), (FaultCause::TickOverrun, 50, 3));
    // While idle it is no fault.
    let mut bench = Bench::new();
    bench.steps(10);
    bench.world.0.borrow_mut().now_us += 50_000;
    bench.steps(10);
    assert_eq!(bench.fault(), None);
}

#[test]
fn trips_and_a_broken_power_stage() {
    let mut bench = running();
    let record = after(&mut bench, 1, FaultCause::Supply, |world| world.trip = Some(Trip::Supply(11_500)));
    assert_eq!(record.value, 11_500);
    assert_eq!(bench.command(Command::ClearFault), Reply::Error(CommandError::FaultPersists));
    bench.world.0.borrow_mut().trip = None;
    assert_eq!(bench.command(Command::ClearFault), Reply::Done);
    assert_eq!((bench.fault(), bench.status().mode), (None, Mode::Idle));
    after(&mut running(), 1, FaultCause::BreakInput, |world| world.trip = Some(Trip::Break(2)));
    let mut bench = running();
    after(&mut bench, 1, FaultCause::EmergencyStop, |world| world.trip = Some(Trip::EmergencyStop));
    assert_eq!(bench.command(Command::ClearFault), Reply::Error(CommandError::FaultPersists));
    after(&mut running(), 1, FaultCause::DriveStage, |world| world.broken_drive = true);
}

#[test]
fn a_fault_outlives_a_reset_and_nothing_starts_before_it_is_cleared() {
    let mut bench = running();
    let record = after(&mut bench, 1, FaultCause::EncoderJump, |world| world.jump = 5000);
    let retained = bench.world.0.borrow().retained;
    let mut again = Bench::with_memory(retained, settings());
    again.steps(3);
    assert_eq!(again.fault(), Some(record));
    assert!(again.events.contains(&Event::FaultRaised(record)));
    let refused = Reply::Error(CommandError::Faulted);
    assert_eq!(again.command(Command::StartRelay(relay(2.0, 1.5, 0))), refused);
    assert!(!again.world.0.borrow().enabled);
    assert_eq!(again.command(Command::ClearFault), Reply::Done);
    assert_eq!(again.command(Command::StartRelay(relay(2.0, 1.5, 10))), Reply::Done);
    // Cleared is cleared, after another reset too.
    again.until_ended(20);
    let retained = again.world.0.borrow().retained;
    assert_eq!(Bench::with_memory(retained, settings()).fault(), None);
}

#[test]
fn a_reset_during_a_run_is_a_fault() {
    let retained = running().world.0.borrow().retained;
    let mut again = Bench::with_memory(retained, settings());
    assert_eq!(again.fault().map(|record| record.cause), Some(FaultCause::ResetWhileDriven));
    assert!(!again.world.0.borrow().enabled);
}

/// What the board says after the reset of a watchdog, and of a program that has panicked.
#[test]
fn a_watchdog_and_a_panic_are_told_after_the_reset() {
    let world = World { watchdog_reset: true, retained: running().world.0.borrow().retained, ..World::default() };
    let mut again = Bench::on(world, Loaded::defaults(settings()));
    assert_eq!(again.fault().map(|record| record.cause), Some(FaultCause::Watchdog));
    assert!(!again.world.0.borrow().enabled);
    let running = running();
    remember_panic(&mut running.world.clone());
    let retained = running.world.0.borrow().retained;
    let mut again = Bench::with_memory(retained, settings());
    assert_eq!(again.fault().map(|record| record.cause), Some(FaultCause::Panic));
    assert!(!again.world.0.borrow().enabled);
}

/// A controller that is no longer finite says so by `None`, from its third tick on here.
struct Lost(u32);

#[derive(Clone)]
struct LostPlan;

impl ControlPlan for LostPlan {
    type Knot = ();
    type Current = ();
}

impl PositionController for Lost {
    type Plan = LostPlan;
    fn start(&mut self, _: &LostPlan, _: i32) {}
    fn tick(&mut self, _: i32, _: &mut SetPointOutlet<'_, ()>) -> Option<(i32, i32)> {
        self.0 += 1;
        (self.0 < 3).then_some((5000, 0))
    }
    fn start_current(&mut self, (): ()) {}
    fn voltage(&mut self, _: i32, _: i32) -> Option<i32> {
        None
    }
    fn applied(&mut self, _: i32, applied: Applied) -> i16 {
        applied.code
    }
    fn saturated(&self) -> u32 {
        0
    }
}

#[test]
fn a_controller_that_is_not_finite() {
    assert_eq!(five_ticks(Lost(0), LostPlan), ([0, 5000, 5000, 0, 0], Mode::Fault, false));
}

/// The controller of the boards with a reference that is no number. It drove 0 and went on.
#[test]
fn a_reference_that_is_not_finite() {
    let Command::StartTrack(hold) = track(Trajectory::Hold, pid(), false) else { panic!("a track") };
    for bad in [f32::NAN, f32::INFINITY] {
        let controller = TrackController::<f32>::default();
        let plan = controller.plan(&hold, Some(&model()), &settings(), 1000).unwrap();
        let plan = TrackPlan { path: Path::Step(bad), ..plan };
        assert_eq!(five_ticks(controller, plan), ([0; 5], Mode::Fault, false), "{bad}");
    }
}

/// Drive codes of the tick that starts a run and of four more, and the mode and the bridge after them.
fn five_ticks<C: PositionController>(controller: C, plan: C::Plan) -> ([i16; 5], Mode, bool) {
    let world = Bench::new().world;
    let mut channels = Channels::new();
    let (tick_end, mut app_end) = channels.split();
    let guards = Guards::new(&settings(), 1000);
    let mut tick = Tick::new(world.clone(), controller, tick_end, TickSettings::at_rate(1000), guards);
    assert!(app_end.runs.enqueue((RunOrder::Track(plan), Bounds::default(), None)).is_ok());
    let driven = [(); 5].map(|()| {
        tick.tick();
        let drive = world.0.borrow().drive;
        world.0.borrow_mut().advance();
        drive
    });
    (driven, tick.mode(), world.0.borrow().enabled)
}

/// What a cut leaves of a frame at the host, bytes without their end, does not swallow the reply after it.
#[test]
fn a_reply_after_a_frame_that_was_cut_off_arrives() {
    let mut bench = Bench::new();
    bench.cut = 1;
    bench.world.0.borrow_mut().from_board.extend([3, 1, 2]);
    assert!(matches!(bench.command(Command::Status), Reply::Status(_)));
    assert_eq!(bench.cut, 0);
}
