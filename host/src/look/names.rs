//! What names say: how much a channel is called like a time, a drive or a position.

/// The words of a name, in lower case: `motorVoltage_V` is `motor`, `voltage`, `v`.
pub(super) fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut before = ' ';
    for c in name.chars() {
        let new = !c.is_alphanumeric() || c.is_uppercase() && before.is_lowercase();
        if new && words.last().is_some_and(|word| !word.is_empty()) {
            words.push(String::new());
        }
        if c.is_alphanumeric()
            && let Some(word) = words.last_mut()
        {
            word.extend(c.to_lowercase());
        }
        before = c;
    }
    words.retain(|word| !word.is_empty());
    words
}

/// Words with what they are worth; a word that speaks against is worth less than nothing.
type Worth = &'static [(&'static str, i32)];

const TIME: Worth = &[
    ("t", 10),
    ("time", 10),
    ("timestamp", 10),
    ("stamp", 9),
    ("millis", 9),
    ("micros", 9),
    ("clock", 6),
    ("sec", 6),
    ("secs", 6),
    ("seconds", 6),
    ("ms", 5),
    ("us", 5),
    ("ns", 5),
    ("elapsed", 6),
    ("ts", 8),
    ("zeit", 8),
    ("date", 5),
    ("datetime", 8),
    ("index", -5),
    ("count", -5),
];
const POSITION: Worth = &[
    ("x", 8),
    ("position", 10),
    ("pos", 10),
    ("angle", 9),
    ("theta", 9),
    ("q", 8),
    ("encoder", 7),
    ("enc", 7),
    ("rotor", 2),
    ("joint", 1),
    ("qpos", 9),
    ("phi", 7),
    ("y", 4),
    ("theta", 9),
    ("present", 2),
    ("actual", 2),
    ("measured", 3),
    ("meas", 3),
    ("load", 1),
    ("winkel", 8),
    ("rad", 3),
    ("deg", 3),
    ("counts", 4),
    ("turns", 3),
    ("ref", -12),
    ("reference", -12),
    ("setpoint", -12),
    ("target", -12),
    ("goal", -12),
    ("cmd", -12),
    ("command", -12),
    ("commanded", -12),
    ("desired", -12),
    ("des", -10),
    ("error", -12),
    ("err", -12),
    ("vel", -12),
    ("velocity", -12),
    ("speed", -12),
    ("acc", -12),
    ("acceleration", -12),
    ("dq", -12),
    ("qd", -12),
    ("qdd", -12),
    ("current", -12),
    ("voltage", -12),
    ("torque", -12),
    ("effort", -12),
    ("temperature", -12),
    ("temp", -12),
    ("s", -4),
    ("pwm", -12),
];
const DRIVE: Worth = &[
    ("u", 10),
    ("voltage", 9),
    ("volt", 8),
    ("volts", 8),
    ("drive", 9),
    ("duty", 9),
    ("pwm", 9),
    ("iq", 9),
    ("current", 8),
    ("amps", 7),
    ("torque", 8),
    ("effort", 8),
    ("tau", 8),
    ("force", 7),
    ("input", 7),
    ("applied", 4),
    ("motor", 1),
    ("control", 4),
    ("output", 4),
    ("command", 3),
    ("cmd", 3),
    ("i", 3),
    ("v", 2),
    ("a", 1),
    ("vq", 6),
    ("spannung", 8),
    ("strom", 7),
    ("moment", 6),
    ("measured", 1),
    ("present", 1),
    ("battery", -12),
    ("supply", -12),
    ("vsupply", -12),
    ("bus", -9),
    ("vbus", -12),
    ("position", -12),
    ("pos", -12),
    ("velocity", -12),
    ("vel", -12),
    ("speed", -12),
    ("angle", -12),
    ("encoder", -12),
    ("enc", -12),
    ("temperature", -12),
    ("temp", -12),
    ("ref", -4),
    ("target", -4),
    ("desired", -4),
    ("des", -4),
    ("limit", -12),
    ("error", -12),
    ("id", -6),
    ("ff", -3),
    ("setpoint", -4),
    ("max", -8),
];

/// What a channel may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Time,
    Drive,
    Position,
}

impl Role {
    const fn worth(self) -> Worth {
        match self {
            Self::Time => TIME,
            Self::Drive => DRIVE,
            Self::Position => POSITION,
        }
    }

    /// Units that only such a channel has.
    const fn units(self) -> &'static [&'static str] {
        match self {
            Self::Time => &["s", "ms", "us", "ns", "min", "h"],
            Self::Drive => &["V", "mV", "A", "mA", "N", "Nm", "mNm", "pct", "pwm"],
            Self::Position => &["rad", "mrad", "deg", "rev", "turns", "m", "mm", "um", "counts", "ticks", "steps"],
        }
    }

    /// How much a name and a unit speak for this role, and the word that does most.
    pub(super) fn score(self, name: &str, unit: Option<&str>) -> (i32, Option<String>) {
        let words = words(name);
        let worth = |word: &String| self.worth().iter().find(|(known, _)| known == word).map_or(0, |(_, worth)| *worth);
        let best = words.iter().filter(|word| worth(word) > 0).max_by_key(|word| worth(word)).cloned();
        // Words for are counted once at their best; words against weigh each by itself.
        let against: i32 = words.iter().map(worth).filter(|worth| *worth < 0).sum();
        let sure = unit.is_some_and(|unit| self.units().contains(&unit));
        // Of one position in several units that of the equations.
        let of_equations = self == Self::Position && matches!(unit, Some("rad" | "m"));
        (best.as_ref().map_or(0, worth) + against + 4 * i32::from(sure) + i32::from(of_equations), best)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_say_what_a_channel_is() {
        let best = |role: Role, names: &[&str]| {
            names.iter().max_by_key(|name| role.score(name, None).0).map(|name| (*name).to_owned()).unwrap()
        };
        let ros = ["/joint_states/j1/position", "/joint_states/j1/velocity", "/joint_states/j1/effort"];
        assert_eq!(best(Role::Position, &ros), ros[0]);
        assert_eq!(best(Role::Drive, &ros), ros[2]);
        let bench = ["time_ms", "target_pos", "encoderPos", "vbus", "motorVoltage", "motorTemp"];
        assert_eq!(best(Role::Time, &bench), "time_ms");
        assert_eq!(best(Role::Position, &bench), "encoderPos");
        assert_eq!(best(Role::Drive, &bench), "motorVoltage");
        assert_eq!(words("motorVoltage_V [pct]"), ["motor", "voltage", "v", "pct"]);
    }
}
