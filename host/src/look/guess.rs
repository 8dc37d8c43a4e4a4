//! Which channels are time, drive and position: by their names, their units, and what their numbers do.

use std::fmt::Write as _;

use super::motion::gain;
use super::names::{Role, words};
use crate::recording::formats::{Channel, Group, Log};
use crate::recording::{MIN_ROWS, ReadOptions, Recording, TimeUnit};

/// Share of the rows in which a time must increase; the rest may be repeated or out of order.
const INCREASES: f64 = 0.9;
/// Most that the data add to what a name is worth, for a drive that the acceleration follows for certain.
const MOST_BY_DATA: f64 = 5.0;
/// Ratio of a gain to its standard error from which it counts fully.
const CERTAIN: f64 = 50.0;
/// What it is worth that the names of drive and position have all their words in common: they are of one joint.
const SAME_JOINT: f64 = 3.0;
/// Whole numbers over more than this are an encoder's counts.
const COUNTS: f64 = 100.0;
/// The largest duty of a PWM of eight bits.
const DUTY: f64 = 255.0;

/// A channel, and why it was taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Guess {
    /// Its full name.
    pub channel: String,
    /// Why.
    pub reason: String,
}

/// Time, drive and position; `None` where nothing is like them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Guesses {
    /// The time's channel; `None` too where the file stamps the rows itself.
    pub time: Option<Guess>,
    /// Whether the file stamps the position's rows.
    pub stamped: bool,
    /// The drive.
    pub drive: Option<Guess>,
    /// The position.
    pub position: Option<Guess>,
    /// Seconds of one unit of the time's channel.
    pub seconds_per_time_unit: f64,
}

/// A channel that may be taken.
#[derive(Clone, Copy)]
struct Candidate<'a> {
    group: &'a Group,
    channel: &'a Channel,
    numbers: &'a [f64],
}

impl Candidate<'_> {
    fn name(&self) -> String {
        self.group.full_name(self.channel)
    }

    /// Highest less lowest number.
    fn range(&self) -> f64 {
        let finite = self.numbers.iter().filter(|number| number.is_finite());
        let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
        high - low
    }

    /// Share of the rows in which it increases.
    fn increases(&self) -> f64 {
        let all = self.numbers.len().saturating_sub(1).max(1) as f64;
        self.numbers.windows(2).filter(|w| w[1] > w[0]).count() as f64 / all
    }

    fn score(&self, role: Role) -> (i32, Option<String>) {
        role.score(&self.name(), self.channel.unit.as_deref())
    }
}

/// Guesses what `options` do not name; the options with the guesses.
pub(super) fn guess(log: &Log, options: &ReadOptions) -> (Guesses, ReadOptions) {
    let candidates: Vec<Candidate<'_>> = log
        .channels()
        .filter_map(|(_, group, channel)| Some(Candidate { group, channel, numbers: channel.values.numbers()? }))
        .filter(|candidate| candidate.numbers.len() >= MIN_ROWS)
        .collect();
    // What never changes is taken only where nothing else is: that is then what is wrong.
    let (moving, still): (Vec<_>, Vec<_>) = candidates.iter().partition(|candidate| candidate.range() > 0.0);
    let mut guesses = Guesses { seconds_per_time_unit: 1.0, ..Guesses::default() };
    let mut options = options.clone();
    let given = |name: &Option<String>| {
        let (group, channel) = log.find(name.as_deref()?)?;
        Some(Candidate { group, channel, numbers: channel.values.numbers()? })
    };
    // A name that is given and not there is not replaced by a guess.
    let position = if options.position.is_some() {
        given(&options.position).map(|candidate| (candidate, "it is named by --position".to_owned()))
    } else {
        position(&moving).or_else(|| position(&still))
    };
    let Some((position, reason)) = position else { return (guesses, options) };
    guesses.position = Some(Guess { channel: position.name(), reason });
    options.position = Some(position.name());
    let times = times(&candidates, &position, given(&options.time), &mut options, &mut guesses);
    let drive = if options.input.is_some() {
        given(&options.input).map(|candidate| (candidate, "it is named by --input".to_owned()))
    } else {
        let times = times.as_deref();
        drive(&moving, &position, times).or_else(|| drive(&still, &position, times))
    };
    if let Some((drive, reason)) = drive {
        options.input = Some(drive.name());
        guesses.drive = Some(Guess { channel: drive.name(), reason });
    }
    (guesses, options)
}

/// Why a name was taken.
fn called(word: Option<&str>, role: &str, unit: Option<&str>) -> String {
    let unit = unit.map_or_else(String::new, |unit| format!(", and its unit is {unit}"));
    match word {
        Some(word) => format!("its name has `{word}`, as of a {role}{unit}"),
        None => format!("its unit is that of a {role}{unit}"),
    }
}

/// The best name; of several alike the one that moves most.
fn position<'a>(candidates: &[Candidate<'a>]) -> Option<(Candidate<'a>, String)> {
    let scored: Vec<_> = candidates.iter().map(|candidate| (candidate.score(Role::Position), candidate)).collect();
    let best = scored.iter().map(|((score, _), _)| *score).filter(|score| *score > 0).max()?;
    let alike: Vec<_> = scored.into_iter().filter(|((score, _), _)| *score == best).collect();
    let count = alike.len();
    let ((_, word), candidate) = alike.into_iter().max_by(|a, b| a.1.range().total_cmp(&b.1.range()))?;
    let mut reason = called(word.as_deref(), "position", candidate.channel.unit.as_deref());
    if count > 1 {
        // Writing to a String cannot fail.
        let _ = write!(reason, "; of {count} such channels it moves most");
    }
    Some((*candidate, reason))
}

/// The times of the position's rows, s, and where they come from.
fn times(
    candidates: &[Candidate<'_>],
    position: &Candidate<'_>,
    given: Option<Candidate<'_>>,
    options: &mut ReadOptions,
    guesses: &mut Guesses,
) -> Option<Vec<f64>> {
    if let Some(fs_hz) = options.fs_hz {
        return Some((0..position.numbers.len()).map(|row| row as f64 / fs_hz).collect());
    }
    let beside = || candidates.iter().filter(|candidate| std::ptr::eq(candidate.group, position.group));
    let named = |name: &str| beside().find(|candidate| candidate.channel.name == name);
    let (candidate, reason) = if let Some(given) = given {
        (given, "it is named by --time".to_owned())
    } else if let Some(stamps) = &position.group.stamps_s {
        let own = named("header/stamp").filter(|own| own.increases() >= INCREASES);
        let Some(own) = own else {
            guesses.stamped = true;
            return Some(stamps.clone());
        };
        (*own, "the message says itself when it was measured; the file stamps when it was received".to_owned())
    } else {
        let like_time = beside().filter(|candidate| candidate.increases() >= INCREASES);
        let scored = like_time.map(|candidate| (candidate.score(Role::Time), candidate));
        let best = scored.filter(|((score, _), _)| *score > 0).max_by_key(|((score, _), _)| *score);
        if let Some(split) = split(&beside().copied().collect::<Vec<_>>()) {
            let (seconds, part) = split;
            let reason = format!("with `{}` it is a stamp in seconds and nanoseconds", part.name());
            options.time = Some(seconds.name());
            guesses.time = Some(Guess { channel: seconds.name(), reason });
            return Some(seconds.numbers.iter().zip(part.numbers).map(|(s, ns)| s + ns / 1e9).collect());
        }
        let ((_, word), candidate) = best?;
        let share = 100.0 * candidate.increases();
        let reason = format!("it increases in {share:.0} % of the rows, and {}", called(word.as_deref(), "time", None));
        (*candidate, reason)
    };
    let name = candidate.name();
    let stated = candidate.channel.unit.as_deref().and_then(|unit| unit.parse().ok());
    let unit = options.time_unit.or(stated).or_else(|| TimeUnit::of_name(&name)).unwrap_or(TimeUnit::Seconds);
    guesses.seconds_per_time_unit = unit.seconds(1.0);
    options.time = Some(name.clone());
    guesses.time = Some(Guess { channel: name, reason });
    let same = candidate.numbers.len() == position.numbers.len();
    same.then(|| candidate.numbers.iter().map(|value| unit.seconds(*value)).collect())
}

/// Seconds and nanoseconds in two channels.
fn split<'a>(candidates: &[Candidate<'a>]) -> Option<(Candidate<'a>, Candidate<'a>)> {
    let part_of = |name: &str| {
        [("sec", "nanosec"), ("secs", "nsecs"), ("sec", "nsec")]
            .iter()
            .find_map(|(whole, part)| Some(format!("{}{part}", name.strip_suffix(whole)?)))
    };
    candidates.iter().find_map(|seconds| {
        let part = part_of(&seconds.channel.name)?;
        let part = candidates.iter().find(|candidate| candidate.channel.name == part)?;
        Some((*seconds, *part))
    })
}

/// The best name, with what the acceleration says.
fn drive<'a>(
    candidates: &[Candidate<'a>],
    position: &Candidate<'_>,
    times: Option<&[f64]>,
) -> Option<(Candidate<'a>, String)> {
    let mut best: Option<(f64, Candidate<'a>, String)> = None;
    for candidate in candidates.iter().filter(|candidate| !std::ptr::eq(candidate.channel, position.channel)) {
        let (score, word) = candidate.score(Role::Drive);
        if score <= 0 {
            continue;
        }
        let mut worth = f64::from(score);
        let mut reason = called(word.as_deref(), "drive", candidate.channel.unit.as_deref());
        worth += SAME_JOINT * shared(&candidate.name(), &position.name());
        if std::ptr::eq(candidate.group, position.group)
            && let Some(times) = times
        {
            let gain = gain(times, candidate.numbers, position.numbers, None);
            worth += MOST_BY_DATA * (gain.t.abs() / CERTAIN).min(1.0);
            if gain.t.abs() > CERTAIN / 10.0 {
                let _ = write!(reason, "; the acceleration follows it ({:.0} standard errors)", gain.t.abs());
            }
        }
        if best.as_ref().is_none_or(|(most, ..)| worth > *most) {
            best = Some((worth, *candidate, reason));
        }
    }
    best.map(|(_, candidate, reason)| (candidate, reason))
}

/// Share of the words of a shorter name that are in the other one too, as `left` of `u_left_V` and `x_left`.
fn shared(a: &str, b: &str) -> f64 {
    let (a, b) = (words(a), words(b));
    let both = a.iter().filter(|word| b.contains(word)).count();
    both as f64 / a.len().min(b.len()).max(1) as f64
}

/// What a user may want to add.
pub(super) fn hints(recording: &Recording) -> Vec<String> {
    let whole = |values: &[f64]| values.iter().all(|value| value.fract() == 0.0);
    let range = |values: &[f64]| {
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)))
    };
    let mut hints = Vec::new();
    let (low, high) = range(&recording.x);
    if recording.radians_per_unit().is_none()
        && recording.counts_per_turn.is_none()
        && whole(&recording.x)
        && high - low > COUNTS
    {
        hints.push(
            "--counts-per-turn N: the position is whole numbers, as an encoder's counts; with N an angle is known"
                .to_owned(),
        );
    }
    let (low, high) = range(&recording.u);
    if whole(&recording.u) && -DUTY <= low && high <= DUTY && high - low > COUNTS {
        hints.push(format!(
            "the drive is whole numbers from {low} to {high}, as a duty of 8 bits; b, c and f1 are then in steps of duty"
        ));
    }
    hints
}
