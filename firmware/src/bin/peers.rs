//! Counts on the virtual board, under `-icount`: instructions per call of the tick's parts, and of what others would put in
//! their place. Prints `name = number` lines for `cargo xtask bench --peers` and ends QEMU.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image {
    use core::hint::black_box;

    use breakaway_core::control::{Pid, PidState, Setpoint, tune};
    use breakaway_core::estimate::sine::{BlockSums, StreamingSine};
    use breakaway_core::excite::relay::{DualRelay, DualRelayState};
    use breakaway_firmware::board::mps2_an386::{Meter, done, panicked};
    use cortex_m::peripheral::Peripherals;
    use cortex_m_rt::entry;
    use cortex_m_semihosting::hprintln;
    use dsp_process::SplitProcess;
    use idsp::Build;
    use idsp::iir::{BiquadClamp, DirectForm1, DirectForm2Transposed, pid};

    const TICK_S: f64 = 1e-3;
    /// Calls per figure.
    const CALLS: u32 = 2000;
    /// Prints the mean instructions of `call` in tenths, less what calling an empty function costs. The input is an error
    /// that swings, so that branches are taken both ways.
    fn measure(name: &str, meter: &Meter, mut call: impl FnMut(i32)) {
        let mut total = 0_u64;
        let mut wave = (0_i32, 40_i32);
        for _ in 0..CALLS {
            // A rotation by about 1/20 rad in integers.
            wave.0 += wave.1 / 20 + wave.1.signum();
            wave.1 -= wave.0 / 20 + wave.0.signum();
            let input = black_box(wave.0);
            total += u64::from(Meter::counts(|| call(input)));
        }
        let empty = u64::from(Meter::counts(|| empty(black_box(1)))) * u64::from(CALLS);
        let tenths = meter.instructions_of(total.saturating_sub(empty), 10) / u64::from(CALLS);
        hprintln!("{} = {}", name, tenths);
    }

    #[inline(never)]
    fn empty(input: i32) {
        black_box(input);
    }

    #[inline(never)]
    fn relay(relay: &DualRelay<i32>, state: &mut DualRelayState, error: i32) -> i32 {
        relay.tick(state, error)
    }

    #[inline(never)]
    fn sums(config: &StreamingSine, sums: &mut BlockSums<i32, 32>, count: i32) {
        config.push(sums, count);
    }

    /// Our PID: filtered derivative, saturation, an integral that goes back by what is cut off.
    #[inline(never)]
    fn ours(law: &Pid<f32>, state: &mut PidState<f32>, reference: f32, x: f32) -> f32 {
        let wanted = law.drive(state, Setpoint { x: reference, v: 0.0, a: 0.0 }, x);
        let applied = wanted.clamp(-law.limit(), law.limit());
        if applied == wanted {
            law.update(state)
        } else {
            law.cut(state, applied - wanted)
        }
        applied
    }

    /// `arm_pid_f32` as the CMSIS-DSP documentation has it: y[n] = y[n−1] + A0·x[n] + A1·x[n−1] + A2·x[n−2]; no limits.
    struct ThreeTerms {
        a: [f32; 3],
        state: [f32; 3],
    }

    #[inline(never)]
    fn three_terms(pid: &mut ThreeTerms, error: f32) -> f32 {
        let [x1, x2, y1] = pid.state;
        let out = pid.a[0] * error + pid.a[1] * x1 + pid.a[2] * x2 + y1;
        pid.state = [error, x1, out];
        out
    }

    #[inline(never)]
    fn biquad_1(filter: &BiquadClamp<f32>, state: &mut DirectForm1<f32>, error: f32) -> f32 {
        filter.process(state, error)
    }

    #[inline(never)]
    fn biquad_2(filter: &BiquadClamp<f32>, state: &mut DirectForm2Transposed<f32>, error: f32) -> f32 {
        filter.process(state, error)
    }

    #[entry]
    fn main() -> ! {
        let Some(peripherals) = Peripherals::take() else {
            panic!("taken twice");
        };
        let meter = Meter::new(peripherals.SYST);
        let (Ok(law), Ok(sine), Ok(gains)) =
            (DualRelay::new(12_000, 9_000, 1), StreamingSine::new(9.0, TICK_S), tune(0.027, 0.11, 10.0, TICK_S, 1))
        else {
            panic!("valid");
        };
        let Ok(pid_law) = Pid::<f32>::new(&gains, TICK_S, 5.0) else {
            panic!("valid");
        };
        let mut state = DualRelayState::default();
        measure("relay", &meter, |e| {
            black_box(relay(&law, &mut state, e));
        });
        let mut accumulators: BlockSums<i32, 32> = BlockSums::new();
        measure("sine_sums", &meter, |e| sums(&sine, &mut accumulators, e));
        let (mut state, mut accumulators) = (DualRelayState::default(), BlockSums::new());
        measure("relay_and_sums", &meter, |e| {
            black_box(relay(&law, &mut state, e));
            sums(&sine, &mut accumulators, e);
        });
        let mut state = PidState::default();
        measure("pid", &meter, |e| {
            black_box(ours(&pid_law, &mut state, 0.0, e as f32 * 1e-3));
        });
        let mut plain = ThreeTerms { a: [12.0, -20.0, 9.0], state: [0.0; 3] };
        measure("cmsis_pid", &meter, |e| {
            black_box(three_terms(&mut plain, e as f32 * 1e-3));
        });
        let settings = pid::Pid::<f32>::default().kp(2.0).ki(20.0).kd(0.05).limit_d(20.0).output_limits(-5.0, 5.0);
        let filter: BiquadClamp<f32> = settings.build(&pid::Units { t: TICK_S as f32, x: 1.0, y: 1.0 });
        let mut state = DirectForm1::default();
        measure("idsp_pid_df1", &meter, |e| {
            black_box(biquad_1(&filter, &mut state, e as f32 * 1e-3));
        });
        let mut state = DirectForm2Transposed::default();
        measure("idsp_pid_df2t", &meter, |e| {
            black_box(biquad_2(&filter, &mut state, e as f32 * 1e-3));
        });
        done()
    }

    #[panic_handler]
    fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
        panicked(info)
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("counts instructions on the virtual board: `cargo xtask bench --peers`");
}
