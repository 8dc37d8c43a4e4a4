//! Commands, refusals, faults and endings in words.

use breakaway_core::link::{
    Command, CommandError, Ending, Event, FaultCause, FaultRecord, Limit, MAX_FRAME, Mismatch, Settings,
};

use super::scale::Scale;

/// The command's name, as on the command line.
pub const fn command_name(command: &Command) -> &'static str {
    match command {
        Command::Hello => "hello",
        Command::Status => "status",
        Command::GetSettings => "settings get",
        Command::SetSettings(_) => "settings set",
        Command::GetModel => "model get",
        Command::LoadModel(_) => "model load",
        Command::Save => "save",
        Command::StartRelay(_) => "start relay",
        Command::StartDrive(_) => "start drive",
        Command::StartTrack(_) => "start track",
        Command::LoadWaveform(_) => "load waveform",
        Command::Identify => "identify",
        Command::Stop => "stop",
        Command::StreamOn { .. } => "stream on",
        Command::StreamOff => "stream off",
        Command::GetFault => "fault",
        Command::ClearFault => "clear",
        Command::Reboot => "reboot",
        Command::Zero { .. } => "zero",
        Command::Jog(_) => "jog",
        Command::Home { .. } => "home",
        Command::SetPoints(_) => "set-points",
    }
}

/// Why the device refuses, and what to do.
pub fn refusal(error: &CommandError) -> String {
    match error {
        CommandError::Malformed => {
            format!("it cannot read it (frames have at most {MAX_FRAME} bytes); please report this")
        }
        CommandError::Settings(field) => {
            format!("{} is out of range: it must be {}; no setting was changed", field.name(), field.need())
        }
        CommandError::Busy(mode) => {
            format!("it is in mode `{}`: stop it first (`breakaway device … stop`)", mode.name())
        }
        CommandError::Faulted => {
            "a fault is latched: read it (`breakaway device … fault`), remove its cause, `clear` it".into()
        }
        CommandError::OutsideTravel => {
            "the axis stands outside the travel limits: move it back, or change travel_min_counts and travel_max_counts"
                .into()
        }
        CommandError::NotZeroed => {
            "its saved travel limits count from a zero that is not known since its reset: `breakaway device … home` finds a \
             stop, `zero` says where it stands"
                .into()
        }
        other => other.to_string(),
    }
}

/// The cause's name.
pub const fn cause_name(cause: FaultCause) -> &'static str {
    match cause {
        FaultCause::EncoderFrozen => "encoder_frozen",
        FaultCause::EncoderJump => "encoder_jump",
        FaultCause::EncoderError => "encoder_error",
        FaultCause::TickOverrun => "tick_overrun",
        FaultCause::LinkLost => "link_lost",
        FaultCause::BreakInput => "break_input",
        FaultCause::Supply => "supply",
        FaultCause::DriveStage => "drive_stage",
        FaultCause::Watchdog => "watchdog",
        FaultCause::Panic => "panic",
        FaultCause::SettingsLost => "settings_lost",
        FaultCause::ModelLost => "model_lost",
        FaultCause::WrongDirection => "wrong_direction",
        FaultCause::ResetWhileDriven => "reset_while_driven",
        FaultCause::NotFinite => "not_finite",
        FaultCause::EmergencyStop => "emergency_stop",
        FaultCause::OverCurrent => "over_current",
        FaultCause::CurrentSensor => "current_sensor",
    }
}

/// What happened, with its numbers, and what to check.
pub fn fault(record: &FaultRecord) -> String {
    let FaultRecord { value, limit, .. } = record;
    match record.cause {
        FaultCause::EncoderFrozen => format!(
            "the encoder stood still for {value} ticks under drive (limit {limit}): check its cable, or the axis is blocked \
             (or `frozen_drive_code` is below its break-away force)"
        ),
        FaultCause::EncoderJump => {
            format!("the encoder jumped by {value} counts in one tick (limit {limit}): check its cable and shield")
        }
        FaultCause::EncoderError => {
            "the encoder did not answer or lost its count: check its supply, cable and shield".into()
        }
        FaultCause::TickOverrun => format!("{value} control ticks in a row were late (limit {limit})"),
        FaultCause::LinkLost => {
            format!("no command for {value} ms while moving (limit {limit}): the host or the cable was lost")
        }
        FaultCause::BreakInput => format!(
            "a protection switched the power stage off (the board's number {value}): over-temperature, or the \
             controller's own supply or clock"
        ),
        FaultCause::EmergencyStop => "the emergency stop is open: close it, then clear the fault".into(),
        FaultCause::OverCurrent => format!(
            "the current was above {limit} mA ({value} mA when it was read next): a short circuit, a blocked axis under a large \
             drive, or current_max_ma is below what the run needs"
        ),
        FaultCause::CurrentSensor => format!(
            "the current is limited to {limit} mA, and nothing measures it: check both wires of the shunt amplifier's output, \
             reboot, or set current_max_ma=0"
        ),
        FaultCause::Supply => format!("the supply was at {value} mV (limit {limit} mV)"),
        FaultCause::DriveStage => "the power stage could not be set".into(),
        FaultCause::Watchdog => "the watchdog reset the board: the control tick had stopped".into(),
        FaultCause::Panic => "the firmware panicked and was reset; please report this".into(),
        FaultCause::SettingsLost => {
            "the saved settings were damaged or of another version; defaults are in use: set and save them again".into()
        }
        FaultCause::ModelLost => {
            "the saved model was damaged or of another version; none is loaded: load and save it again".into()
        }
        FaultCause::WrongDirection => {
            format!("the axis moved {value} counts against the drive: swap the motor's leads, or set encoder_reversed")
        }
        FaultCause::ResetWhileDriven => "the board was reset (pin or supply) while the drive was on".into(),
        FaultCause::NotFinite => "the controller's output was not a finite number: check gains and model".into(),
    }
}

/// The limit's name.
pub const fn limit_name(limit: Limit) -> &'static str {
    match limit {
        Limit::Travel | Limit::Bound => "travel",
        Limit::Speed => "speed",
        Limit::Current => "current",
        Limit::MeanDrive => "mean_drive",
        Limit::SetPoints => "set_points",
    }
}

/// How an experiment ended.
pub fn ending(ending: Ending, scale: &Scale, settings: &Settings) -> String {
    match ending {
        Ending::TimeUp => "time up".into(),
        Ending::Settled { cycles } => format!("settled after {cycles} cycles"),
        Ending::Asymmetric { cycles } => format!("asymmetric after {cycles} cycles"),
        Ending::NoLimitCycle => "no limit cycle".into(),
        Ending::Limit { limit, value } => {
            let unit = scale.units.x.as_str();
            match limit {
                Limit::Travel => {
                    let (low, high) = (settings.travel_min_counts, settings.travel_max_counts);
                    format!(
                        "travel limit: at {:.4} {unit}, allowed {:.4} to {:.4} {unit} (settings travel_min_counts, \
                         travel_max_counts)",
                        scale.position(value),
                        scale.position(low),
                        scale.position(high)
                    )
                }
                Limit::Bound => {
                    format!("the experiment's travel limit: {:.4} {unit} from the start", scale.position(value))
                }
                Limit::Speed => format!(
                    "speed limit: {value} counts/s, allowed {} (setting speed_max_counts_per_s)",
                    settings.speed_max_counts_per_s
                ),
                Limit::Current => {
                    format!("current limit: {value} mA, allowed {} (setting current_max_ma)", settings.current_max_ma)
                }
                Limit::MeanDrive => format!(
                    "mean drive limit: {:.3} {u}, allowed {:.3} {u} (setting mean_drive_max_code)",
                    scale.drive(value),
                    scale.drive(settings.mean_drive_max_code.into()),
                    u = scale.units.u
                ),
                Limit::SetPoints => {
                    format!("no set-points for {:.3} s (--hold)", scale.time(u64::from(value.unsigned_abs())))
                }
            }
        }
        Ending::Stopped => "stopped".into(),
        Ending::Homed => "homed".into(),
        Ending::Fault(cause) => format!("fault {}", cause_name(cause)),
    }
}

/// An event, for a list of them.
pub fn event(event: &Event, scale: &Scale, settings: &Settings) -> String {
    match event {
        Event::Started => "board started".into(),
        Event::FaultRaised(record) => format!("FAULT {}: {}", cause_name(record.cause), fault(record)),
        Event::ExperimentEnded(ended) => {
            format!(
                "{} ended after {} ticks: {}",
                ended.mode.name(),
                ended.ticks,
                self::ending(ended.ending, scale, settings)
            )
        }
        Event::ModelMismatch(found) => mismatch(found),
    }
}

/// What the drift watch found.
pub fn mismatch(found: &Mismatch) -> String {
    let Mismatch { direction, speed_bin, position_bin, score } = *found;
    let way = match direction {
        0 => "both ways",
        1.. => "forwards",
        _ => "backwards",
    };
    // Short: the monitor shows it on one line.
    let how = if score < 0.0 { "harder" } else { "easier" };
    let sigma = score.abs();
    format!("model mismatch: moves {how} {way} ({sigma:.0} sigma; position bin {position_bin}, speed bin {speed_bin})")
}
