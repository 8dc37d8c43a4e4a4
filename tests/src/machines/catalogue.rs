//! The machines, one entry each. What is known of them is from the README of the measured data, unless a source says
//! otherwise.

use breakaway_core::plant::Kind;

use super::truth::{Known, Truth};
use super::{Columns, Group, Machine};

/// Every machine, in the order of the page.
pub const MACHINES: [&Machine; 13] = [
    &EMPS,
    &LAAS_SINE,
    &LAAS_SPEED,
    &XL330,
    &FLEXLINK,
    &CICESE,
    &ODRIVE,
    &HSM150,
    &FRC_LEFT,
    &FRC_RIGHT,
    &AK80,
    &OPENARM,
    &SO101,
];

const README: &str = "data README";
const PUBLISHED: &str = "published, in the data README";
const JANOT: &str = "Janot, Gautier, Brunot 2019, over 35.15065 N/V";
/// Newtons per volt of the EMPS drive.
const EMPS_N_PER_V: f64 = 35.15065;

const fn columns(input: &'static str, position: &'static str) -> Columns {
    Columns { time: "t_s", input: Some(input), position, select: None, units: None }
}

/// Closed loop, 1 kHz, one file of 25 s.
pub const EMPS: Machine = Machine {
    name: "emps",
    title: "EMPS, ball-screw axis (Janot, Gautier, Brunot 2019)",
    folder: "emps",
    prefix: "emps_",
    files: 1,
    columns: columns("u_V", "x_m"),
    groups: &[],
    truth: Truth::Effects {
        lead: &[Kind::AsymmetricViscous, Kind::ConstantLoad],
        needed: &[Kind::AsymmetricViscous],
        // The screw's force repeats every 2.5 mm (ball_screw.rs).
        also: &[Kind::Cogging],
    },
    known: &[
        Known::new(None, "b", 95.1089 / EMPS_N_PER_V, JANOT),
        Known::new(None, "c", 203.5034 / EMPS_N_PER_V, JANOT),
        Known::new(None, "f1", 20.3935 / EMPS_N_PER_V, JANOT),
        Known::new(Some(Kind::ConstantLoad), "f0", -3.1648 / EMPS_N_PER_V, JANOT),
    ],
};

/// Open-loop current sine of 2 Hz, up to 150 rad/s.
pub const LAAS_SINE: Machine = Machine {
    name: "laas-sine",
    title: "bare brushless motor, current sine (LAAS)",
    folder: "laas-motor",
    prefix: "current-sine",
    files: 1,
    columns: columns("iq_A", "x_rad"),
    groups: &[],
    truth: Truth::lead(&[Kind::Cogging], &[]),
    known: LAAS_COGGING,
};

/// One way at 2π rad/s.
pub const LAAS_SPEED: Machine = Machine {
    name: "laas-speed",
    title: "bare brushless motor, speed control (LAAS)",
    prefix: "speed-control",
    ..LAAS_SINE
};

const LAAS_COGGING: &[Known] = &[
    Known::new(Some(Kind::Cogging), "n", 72.0, README),
    Known::new(Some(Kind::Cogging), "A", 0.183, README).unsigned(),
];

/// Position loop in the servo; the rows without torque have no meaningful drive.
pub const XL330: Machine = Machine {
    name: "xl330",
    title: "Dynamixel XL330 with a pendulum (Rhoban)",
    folder: "machines/xl330",
    prefix: "xl330_",
    files: 8,
    columns: Columns { select: Some("torque_enable=1"), ..columns("u_V", "x_rad") },
    groups: &[Group { name: "kp100+200", holds: &["kp100", "kp200"] }],
    truth: Truth::lead(&[Kind::GravityLoad], &[Kind::LoadFriction]),
    known: &[Known::new(Some(Kind::GravityLoad), "m", 5.7, README).unsigned()],
};

/// Closed loop, 500 Hz, counts of a coarse encoder.
pub const FLEXLINK: Machine = Machine {
    name: "flexlink",
    title: "DC motor with a flexible ruler as link (ryanGT)",
    folder: "machines/flexlink",
    prefix: "",
    files: 8,
    columns: columns("u_cmd", "x_counts"),
    groups: &[],
    // What tells a lag from a delay happens within the 2 ms of a sample.
    truth: Truth::lead(&[Kind::FlexibleCoupling], &[Kind::Delay, Kind::ElectricalLag]),
    known: &[
        Known::new(Some(Kind::FlexibleCoupling), "omega_r", 16.0, README),
        Known::new(Some(Kind::FlexibleCoupling), "mu", 0.64, README),
        Known::within(Some(Kind::Delay), "tau", [0.002, 0.004], README),
    ],
};

/// Presliding and break-away at 15 ms a sample, mostly at rest.
pub const CICESE: Machine = Machine {
    name: "cicese",
    title: "direct-drive arm, joint 1 (CICESE)",
    folder: "machines/cicese",
    prefix: "",
    files: 16,
    columns: columns("u_Nm", "x_rad"),
    groups: &[
        Group { name: "est", holds: &["est_"] },
        Group { name: "sig0", holds: &["sig0_"] },
        Group { name: "sig1", holds: &["sig1_"] },
    ],
    // The joint breaks away in jumps: a level at rest above that of sliding.
    truth: Truth::lead(&[Kind::Dahl, Kind::LuGre], &[Kind::Stiction, Kind::Stribeck]),
    known: &[Known::within(None, "f1", [8.4, 10.6], README)],
};

/// Open-loop current steps, one a file.
pub const ODRIVE: Machine = Machine {
    name: "odrive",
    title: "hobby brushless motor, 7 pole pairs (gchenfc/ODrive)",
    folder: "machines/odrive",
    prefix: "spinup_",
    files: 68,
    columns: columns("u_set_A", "x_rad"),
    groups: &[],
    truth: Truth::lead(&[Kind::Cogging], &[]),
    known: &[
        Known::new(None, "b", 3.4e-3, README),
        Known::new(Some(Kind::Cogging), "n", 7.0, README),
        Known::new(Some(Kind::Cogging), "A", 0.86, README).unsigned(),
    ],
};

/// One torque step a file, one way.
pub const HSM150: Machine = Machine {
    name: "hsm150",
    title: "two-motor bench, torque steps one way (HSM150)",
    folder: "machines/hsm150",
    prefix: "",
    files: 3,
    columns: columns("u_Nm", "x_rad"),
    groups: &[],
    // The steady speeds of these files tell an asymmetry too. Between two of them the drive rises by 0.09 mN·m·s/rad one
    // way, and by 0.19 and 0.22 the other. Order tracking shows forces once and twice a turn in each file (its test).
    truth: Truth::lead(&[Kind::ConstantLoad], &[Kind::AsymmetricViscous, Kind::Cogging]),
    known: &[Known::new(Some(Kind::ConstantLoad), "f0", 0.009, README).unsigned()],
};

/// Left wheels; a position that is refreshed every 20 ms, logged at 200 Hz.
pub const FRC_LEFT: Machine = Machine {
    name: "frc-left",
    title: "robot drive, left wheels (WPILib SysId)",
    folder: "machines/frc-swerve",
    prefix: "",
    files: 4,
    columns: columns("u_left_V", "x_left"),
    groups: &[],
    truth: Truth::Nothing,
    known: &[Known::new(None, "c", 0.67, README), Known::new(None, "f1", 0.26, README)],
};

/// Right wheels of the same files.
pub const FRC_RIGHT: Machine = Machine {
    name: "frc-right",
    title: "robot drive, right wheels (WPILib SysId)",
    columns: columns("u_right_V", "x_right"),
    ..FRC_LEFT
};

/// Gravity and a delay of 16 ms, which must be found together.
pub const AK80: Machine = Machine {
    name: "ak80",
    title: "T-Motor AK80-6 with a pendulum (DFKI)",
    folder: "machines/pendulum-ak80",
    prefix: "",
    files: 2,
    columns: Columns { time: "time", units: Some(["Nm", "rad"]), ..columns("torque", "position") },
    groups: &[],
    // The offset is published; a lag of 16 ms does as a delay does.
    truth: Truth::lead(&[Kind::GravityLoad], &[Kind::Delay, Kind::ElectricalLag, Kind::ConstantLoad]),
    known: &[
        Known::new(None, "b", 0.0626, PUBLISHED),
        Known::new(None, "c", 0.047, PUBLISHED),
        Known::new(None, "f1", 0.184, PUBLISHED),
        Known::new(Some(Kind::GravityLoad), "m", 1.0, README).unsigned(),
        Known::new(Some(Kind::Delay), "tau", 0.016, README),
        Known::new(Some(Kind::ConstantLoad), "f0", 0.076, PUBLISHED).unsigned(),
    ],
};

/// Positions held over several samples, a jittered clock.
pub const OPENARM: Machine = Machine {
    name: "openarm",
    title: "OpenArm, joint 5 (Damiao motor)",
    folder: "machines/openarm",
    prefix: "joint_5",
    files: 1,
    columns: columns("tau_Nm", "x_rad"),
    groups: &[],
    truth: Truth::lead(&[Kind::Stiction, Kind::Stribeck, Kind::LuGre, Kind::Dahl], &[]),
    known: &[Known::new(None, "f1", 0.15, README)],
};

/// A target in place of the drive.
pub const SO101: Machine = Machine {
    name: "so101",
    title: "LeRobot SO-101, Feetech servos (NVIDIA SAGE)",
    folder: "machines/so101",
    prefix: "",
    files: 6,
    columns: Columns { time: "t_s", input: None, position: "x_rad", select: None, units: None },
    groups: &[],
    truth: Truth::NoDrive,
    known: &[],
};
