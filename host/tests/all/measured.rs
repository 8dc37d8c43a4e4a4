//! The measured recordings (`../shared/data` beside the project, or `BREAKAWAY_DATA`) are read with nothing but column flags.

use std::path::PathBuf;

use breakaway::recording::{ReadOptions, Recording, RecordingError, Warning, Wrap};

/// The folder of measured recordings. Its absence is a failure in CI; elsewhere the test says that it was not run.
pub fn data() -> Option<PathBuf> {
    let folder = std::env::var_os("BREAKAWAY_DATA")
        .map_or_else(|| PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data")), PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    assert!(std::env::var_os("CI").is_none(), "no recordings in {}", folder.display());
    eprintln!(
        "NOT RUN: no recordings in {}; EMPS is at nonlinearbenchmark.org, set BREAKAWAY_DATA to its folder",
        folder.display()
    );
    None
}

fn columns(time: &str, input: &str, position: &str) -> ReadOptions {
    ReadOptions {
        time: Some(time.to_owned()),
        input: Some(input.to_owned()),
        position: Some(position.to_owned()),
        ..ReadOptions::default()
    }
}

/// EMPS: 24 841 rows at 1 kHz (times printed to 10 digits), 50 nm per count.
#[test]
fn emps_is_evenly_sampled_and_its_encoder_step_is_found() {
    let Some(data) = data() else { return };
    let options = columns("t_s", "u_V", "x_m");
    let emps = Recording::read(&data.join("emps/emps_train.csv"), &options).unwrap();
    assert_eq!((emps.t.len(), emps.gaps.len()), (24_841, 0));
    assert_eq!((emps.units.u.as_str(), emps.units.x.as_str()), ("V", "m"));
    assert_eq!(emps.encoder_step, Some(5e-8));
    // Start and end are printed to 1e-8 s.
    assert!((emps.evenly_sampled().unwrap() - 1e-3).abs() < 1e-11);
    assert_eq!(emps.warnings(), []);
}

/// LAAS: jitter of 0.2 to 7 ms around 1.000 ms, one interval long enough to be a gap; 3.14e-4 rad per count, printed to 1e-5 rad.
#[test]
fn laas_has_jitter_a_gap_and_an_encoder_step() {
    let Some(data) = data() else { return };
    let options = columns("t_s", "iq_A", "x_rad");
    let path = data.join("laas-motor/current-sine-2hz.csv");
    let laas = Recording::read(&path, &options).unwrap();
    assert_eq!(laas.t.len(), 26_999);
    assert_eq!(laas.evenly_sampled(), None);
    let timing = laas.timing();
    assert!((timing.median_s - 1e-3).abs() < 1e-6 && timing.gaps == 1);
    // 20 000 counts per turn; the print's rounding averages out over the 4096 smallest differences.
    let step = laas.encoder_step.unwrap();
    assert!((step - std::f64::consts::TAU / 20_000.0).abs() < 3e-7, "{step}");
    assert_eq!(laas.segments().len(), 2);
    assert!(matches!(laas.warnings()[..], [Warning::Gaps { count: 1, .. }, Warning::Jitter { .. }]));
}

/// CICESE: in two of the ramps the clock stands still at the end while rows go on (678 and 882 of them); the rest is read.
#[test]
fn a_clock_that_stops_leaves_what_it_stamped() {
    let Some(data) = data() else { return };
    let options = columns("t_s", "u_Nm", "x_rad");
    for (file, rows, stopped) in [("est_j1_n05_exp2_gan", 2563, 678), ("est_j1_n05_exp3_gan", 2631, 882)] {
        let read = Recording::read(&data.join(format!("machines/cicese/{file}.csv")), &options).unwrap();
        assert_eq!(read.t.len(), rows);
        assert!(read.gaps.is_empty() && read.moves(), "{:?}", read.gaps);
        let [Warning::StampRepeated { lines, .. }] = read.found.as_slice() else { panic!("{:?}", read.found) };
        assert_eq!((lines.count(), lines.stretches()), (stopped, 1));
    }
}

/// The FRC drive's position comes every 20 ms into a log of 5 ms (WPILib's period), at slow and fast speeds. It is
/// found to 2 %, because the log's own clock is off by as much. OpenArm's sticks and slips between refreshes of two
/// or three rows (6 to 9 ms). XL330, EMPS, LAAS, ODrive and flexlink, whose encoder is coarse, have a position of
/// their own for every row.
#[test]
fn held_positions_are_told_from_coarse_encoders() {
    let Some(data) = data() else { return };
    let read = |file: &str, options: &ReadOptions| Recording::read(&data.join(file), options).unwrap();
    let held = |file: &str, options: &ReadOptions| read(file, options).held();
    let frc = columns("t_s", "u_left_V", "x_left");
    for run in ["fast_backward", "fast_forward", "slow_backward", "slow_forward"] {
        let found = held(&format!("machines/frc-swerve/11_8_StandingSwerve__{run}.csv"), &frc).unwrap();
        assert!((found.period_s / 0.02 - 1.0).abs() < 0.02 && (found.repeated - 0.75).abs() < 0.02, "{run}: {found:?}");
    }
    let openarm = held("machines/openarm/joint_5.csv", &columns("t_s", "tau_Nm", "x_rad")).unwrap();
    assert!((6e-3..9e-3).contains(&openarm.period_s), "{openarm:?}");
    // Its step is 16 384 per turn. At one speed, what a position moves by in a refresh is no step.
    let step = read("machines/openarm/joint_5.csv", &columns("t_s", "tau_Nm", "x_rad")).encoder_step.unwrap();
    assert!((step * 16_384.0 / std::f64::consts::TAU - 1.0).abs() < 1e-3, "{step}");
    assert_eq!(read("machines/frc-swerve/11_8_StandingSwerve__fast_forward.csv", &frc).encoder_step, None);
    for (file, options) in [
        ("machines/xl330/xl330_sin_sin_kp800.csv", columns("t_s", "u_V", "x_rad")),
        ("machines/xl330/xl330_lift_and_drop_kp100.csv", columns("t_s", "u_V", "x_rad")),
        ("emps/emps_train.csv", columns("t_s", "u_V", "x_m")),
        ("laas-motor/current-sine-2hz.csv", columns("t_s", "iq_A", "x_rad")),
        ("machines/odrive/spinup_4_nocomp_seg16.csv", columns("t_s", "u_set_A", "x_rad")),
        ("machines/flexlink/swept1_0_10hz.csv", columns("t_s", "u_cmd", "x_counts")),
        ("machines/so101/friction_gravity_elbow.csv", columns("t_s", "target_rad", "x_rad")),
    ] {
        assert_eq!(held(file, &options), None, "{file}");
    }
}

/// All recordings in a folder of machines.
fn files(folder: &std::path::Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    entries.map(|entry| entry.unwrap().path()).collect()
}

/// What real axes do, stick and slip, break away, spin up within a row, is no fault of a sensor and no roll-over. A sample of
/// 65 535 among them is.
#[test]
fn measured_motion_is_no_fault_and_a_glitch_in_it_is() {
    let Some(data) = data() else { return };
    let machines = [
        ("cicese", "t_s", "u_Nm", "x_rad"),
        ("flexlink", "t_s", "u_cmd", "x_counts"),
        ("frc-swerve", "t_s", "u_left_V", "x_left"),
        ("hsm150", "t_s", "u_Nm", "x_rad"),
        ("odrive", "t_s", "u_set_A", "x_rad"),
        ("openarm", "t_s", "tau_Nm", "x_rad"),
        ("pendulum-ak80", "time", "torque", "position"),
        ("so101", "t_s", "target_rad", "x_rad"),
        ("xl330", "t_s", "u_V", "x_rad"),
    ];
    for (folder, time, input, position) in machines {
        for file in files(&data.join("machines").join(folder)) {
            let options = columns(time, input, position);
            let recording = Recording::read(&file, &options).unwrap_or_else(|error| panic!("{error}"));
            let faults = |recording: &Recording| {
                recording
                    .found
                    .iter()
                    .filter(|w| matches!(w, Warning::Outliers { .. } | Warning::DriveOutliers { .. }))
                    .count()
            };
            assert_eq!(faults(&recording), 0, "{}: {:?}", file.display(), recording.found);
            let mut glitch = recording.clone();
            glitch.x[recording.x.len() / 3] = 65_535.0;
            let mut bytes = Vec::new();
            glitch.write_to(&mut bytes).unwrap();
            let again = Recording::read_from("glitch.csv", bytes.as_slice(), &ReadOptions::default()).unwrap();
            assert_eq!((faults(&again), again.x.len()), (1, recording.x.len() - 1), "{}", file.display());
        }
    }
}

/// Rotors that spin at up to 150 rad/s, 40 rows a turn, on a clock that jitters by 7 ms. Rolled into one turn of 2π
/// rad they are refused with that turn. Joined by it they are as before, but for whole turns.
#[test]
fn measured_rotors_that_roll_over_are_joined() {
    let Some(data) = data() else { return };
    for (file, input) in [
        ("laas-motor/current-sine-2hz.csv", "iq_A"),
        ("laas-motor/speed-control.csv", "iq_A"),
        ("machines/odrive/spinup_4_nocomp_seg16.csv", "u_set_A"),
        ("machines/odrive/spinup_6_nocomp_seg40.csv", "u_set_A"),
    ] {
        let measured = Recording::read(&data.join(file), &columns("t_s", input, "x_rad")).unwrap();
        let turn = std::f64::consts::TAU;
        let rolled = Recording { x: measured.x.iter().map(|x| x.rem_euclid(turn)).collect(), ..measured.clone() };
        let mut bytes = Vec::new();
        rolled.write_to(&mut bytes).unwrap();
        let read = |options: &ReadOptions| Recording::read_from(file, bytes.as_slice(), options);
        let refused = read(&ReadOptions::default()).unwrap_err();
        let RecordingError::RollsOver { modulus, .. } = refused else { panic!("{file}: {refused}") };
        assert_eq!(modulus, turn, "{file}");
        let joined = read(&ReadOptions { wrap: Some(Wrap::Modulus(modulus)), ..ReadOptions::default() }).unwrap();
        let off = joined.x[0] - measured.x[0];
        assert!(joined.x.iter().zip(&measured.x).all(|(a, b)| (a - b - off).abs() < 1e-9), "{file}");
    }
}

#[test]
fn half_of_a_laas_recording_is_picked_by_its_column() {
    let Some(data) = data() else { return };
    let mut options = columns("t_s", "iq_A", "x_rad");
    let path = data.join("laas-motor/speed-control.csv");
    let mut rows = 0;
    for half in ["anticog_on=0", "anticog_on=1"] {
        options.select = vec![half.parse().unwrap()];
        rows += Recording::read(&path, &options).unwrap().t.len();
    }
    assert_eq!(rows, 30_001);
}
