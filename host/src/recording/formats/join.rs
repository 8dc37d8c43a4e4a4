//! Channels of a log joined to the rows of one: the position's, which is never interpolated.
//!
//! The drive is held from one of its values to the next. A row has its mean until the next row, which moves the axis as far
//! as the drive itself did. Where drive and position have the same stamps, this is the drive's value of that row.

use std::rc::Rc;

use super::log::{Channel, Group, Log, Values};
use crate::nearest::nearest;
use crate::recording::error::{LogError, RecordingError};
use crate::recording::field;
use crate::recording::options::ReadOptions;
use crate::recording::table::Wanted;

/// Channels that a message lists.
const LISTED: usize = 24;

/// Wanted channels of a log on the rows of the last of them.
#[derive(Debug, Default)]
pub(in crate::recording) struct Joined {
    /// The rows' times as the file has them: a channel's raw numbers, or the stamps, s.
    pub times: Times,
    /// The wanted channels; NaN where a row has no value.
    pub columns: Vec<Vec<f64>>,
    /// Whether a row meets the conditions.
    pub selected: Vec<bool>,
    /// Values of the conditions' channels, for a message.
    pub seen: Vec<String>,
    /// Units of the wanted channels, where the file says them.
    pub units: Vec<Option<String>>,
    /// The channel whose values were joined to another's rows, and that other.
    pub clocks_of: Option<(String, String)>,
}

/// Where the rows' times come from.
#[derive(Debug, Default)]
pub(in crate::recording) enum Times {
    /// Counted from the rows.
    #[default]
    Rows,
    /// A channel: its name, its unit where the file says it, and its numbers.
    Channel(String, Option<String>, Vec<f64>),
    /// The stamps of a group, s.
    Stamps(String, Vec<f64>),
}

impl Log {
    /// The channel `wanted`.
    fn channel(&self, file: &str, wanted: &str, flag: &'static str) -> Result<(&Group, &Channel), LogError> {
        self.find(wanted).ok_or_else(|| {
            let all: Vec<String> = self.channels().map(|(name, ..)| name).collect();
            let mut channels: Vec<String> = all.iter().take(LISTED).map(|name| field::shown(name)).collect();
            if all.len() > LISTED {
                channels.push(format!("and {} more", all.len() - LISTED));
            }
            LogError::NoChannel {
                file: file.to_owned(),
                wanted: wanted.to_owned(),
                flag,
                nearest: nearest(wanted, all.iter().map(String::as_str)).map(field::shown),
                channels,
            }
        })
    }

    /// The wanted channels on the rows of the last of them.
    pub(in crate::recording) fn join(
        &self,
        file: &str,
        options: &ReadOptions,
        wanted: &[Wanted<'_>],
    ) -> Result<Joined, RecordingError> {
        let mut found = Vec::new();
        for Wanted { name, flag } in wanted {
            let (group, channel) = self.channel(file, name, flag)?;
            let not_numbers = || LogError::NotNumbers { file: file.to_owned(), channel: (*name).to_owned() };
            found.push((group, channel, channel.values.numbers().ok_or_else(not_numbers)?));
        }
        let Some(&(rows_of, position, _)) = found.last() else { return Ok(Joined::default()) };
        let name_of = |group: &Group, channel: &Channel| group.full_name(channel);
        let mut joined = Joined { times: self.times(file, options, rows_of)?, ..Joined::default() };
        for (group, channel, numbers) in &found {
            joined.units.push(channel.unit.clone());
            if same_rows(group, rows_of) {
                joined.columns.push(numbers.to_vec());
                continue;
            }
            let (first, second) = (name_of(group, channel), name_of(rows_of, position));
            let (Some(own), Some(stamps)) = (&group.stamps_s, &rows_of.stamps_s) else {
                let rows = (group.rows(), rows_of.rows());
                return Err(LogError::NoCommonClock { file: file.to_owned(), first, second, rows }.into());
            };
            let column = held_means(own, numbers, stamps);
            if column.iter().all(|value| value.is_nan()) {
                return Err(LogError::Apart { file: file.to_owned(), drive: first, position: second }.into());
            }
            joined.columns.push(column);
            joined.clocks_of = Some((first, second));
        }
        self.select(file, options, rows_of, &mut joined)?;
        Ok(joined)
    }

    /// Where the rows of `group` have their times from.
    fn times(&self, file: &str, options: &ReadOptions, group: &Group) -> Result<Times, LogError> {
        if options.fs_hz.is_some() {
            return Ok(Times::Rows);
        }
        if options.time.is_none()
            && let Some(stamps) = &group.stamps_s
        {
            let name = if group.name.is_empty() { "time stamp".to_owned() } else { format!("stamp of {}", group.name) };
            return Ok(Times::Stamps(name, stamps.clone()));
        }
        let name = options.time_column();
        let (of, channel) = self.channel(file, name, "--time (or give --fs)")?;
        let numbers = channel.values.numbers();
        let numbers =
            numbers.ok_or_else(|| LogError::NotNumbers { file: file.to_owned(), channel: name.to_owned() })?;
        if !same_rows(of, group) {
            let (first, rows) = (of.full_name(channel), (of.rows(), group.rows()));
            let second = group.channels.first().map(|c| group.full_name(c)).unwrap_or_default();
            return Err(LogError::NoCommonClock { file: file.to_owned(), first, second, rows });
        }
        Ok(Times::Channel(name.to_owned(), channel.unit.clone(), numbers.to_vec()))
    }

    /// Which rows meet the conditions. A condition's channel with a clock of its own is held from value to value.
    fn select(
        &self,
        file: &str,
        options: &ReadOptions,
        rows_of: &Group,
        joined: &mut Joined,
    ) -> Result<(), RecordingError> {
        joined.selected = vec![true; rows_of.rows()];
        for condition in &options.select {
            let (group, channel) = self.channel(file, &condition.column, "--where")?;
            let same = same_rows(group, rows_of);
            let clocks = group.stamps_s.as_ref().zip(rows_of.stamps_s.as_ref());
            let order = clocks.map(|(own, _)| in_order(own)).unwrap_or_default();
            for (row, selected) in joined.selected.iter_mut().enumerate() {
                let at = match clocks {
                    _ if same => Some(row),
                    Some((own, stamps)) => last_before(own, &order, stamps[row]).map(|k| order[k]),
                    None => {
                        let (first, second) = (group.full_name(channel), rows_of.name.clone());
                        let rows = (group.rows(), rows_of.rows());
                        return Err(LogError::NoCommonClock { file: file.to_owned(), first, second, rows }.into());
                    }
                };
                let text: Rc<str> = match (&channel.values, at) {
                    (Values::Numbers(numbers), Some(at)) => Rc::from(numbers[at].to_string()),
                    (Values::Texts(texts), Some(at)) => Rc::clone(&texts[at]),
                    (_, None) => Rc::from(""),
                };
                if !condition.matches(text.as_bytes()) {
                    *selected = false;
                    crate::recording::rows::note(&mut joined.seen, text.as_bytes());
                }
            }
        }
        Ok(())
    }
}

/// Whether two groups have one clock.
fn same_rows(a: &Group, b: &Group) -> bool {
    std::ptr::eq(a, b) || a.rows() == b.rows() && a.stamps_s == b.stamps_s
}

/// The rows in the order of their stamps, those without one left out.
fn in_order(stamps: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..stamps.len()).filter(|&k| stamps[k].is_finite()).collect();
    order.sort_by(|a, b| stamps[*a].total_cmp(&stamps[*b]));
    order
}

/// Place in `order` of the last stamp that is not after `t`.
fn last_before(stamps: &[f64], order: &[usize], t: f64) -> Option<usize> {
    order.partition_point(|&k| stamps[k] <= t).checked_sub(1)
}

/// The mean of a signal from each of `times` to the next, the signal being held from each of its values to the next.
///
/// NaN before its first value, and past its last one by more than the longest interval between its values.
fn held_means(stamps: &[f64], values: &[f64], times: &[f64]) -> Vec<f64> {
    let order: Vec<usize> = in_order(stamps).into_iter().filter(|&k| values[k].is_finite()).collect();
    let own: Vec<(f64, f64)> = order.iter().map(|&k| (stamps[k], values[k])).collect();
    let longest = own.windows(2).map(|w| w[1].0 - w[0].0).fold(0.0, f64::max);
    let Some(&(end, _)) = own.last() else { return vec![f64::NAN; times.len()] };
    // Rows in order take each value once or twice; rows in no order would take all of them each.
    let mut steps_left = 16 * (own.len() + times.len());
    let mut mean_from = |row: usize| {
        let from = times[row];
        let Some(mut k) = own.partition_point(|(t, _)| *t <= from).checked_sub(1) else { return f64::NAN };
        if !from.is_finite() || from > end + longest {
            return f64::NAN;
        }
        // A row that no later one follows has the value of its instant.
        let until = times.get(row + 1).copied().filter(|until| *until > from).unwrap_or(from);
        let next = |k: usize| own.get(k + 1).map_or(f64::INFINITY, |(t, _)| *t);
        if next(k) >= until || steps_left == 0 {
            return own[k].1;
        }
        let (mut impulse, mut at) = (0.0, from);
        while at < until {
            steps_left = steps_left.saturating_sub(1);
            let to = next(k).min(until);
            impulse += own[k].1 * (to - at);
            at = to;
            k += 1;
        }
        impulse / (until - from)
    };
    (0..times.len()).map(&mut mean_from).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A drive of 1 until 2 s and 3 from there: a row from 1.5 to 2.5 s has 2, whichever way the drive is stamped.
    #[test]
    fn a_row_has_the_mean_of_the_held_drive() {
        let times = [0.0, 0.5, 1.5, 2.5, 3.5];
        assert_eq!(held_means(&[0.0, 2.0], &[1.0, 3.0], &times), [1.0, 1.0, 2.0, 3.0, 3.0]);
        let twice = held_means(&[0.0, 1.0, 2.0, 2.0, 3.0], &[1.0, 1.0, 7.0, 3.0, 3.0], &times);
        assert_eq!(twice, [1.0, 1.0, 2.0, 3.0, 3.0]);
    }

    /// Nothing is made up before the first value, nor later than the longest interval after the last one.
    #[test]
    fn a_drive_that_has_not_begun_or_has_ended_is_not_made_up() {
        let column = held_means(&[1.0, 2.0], &[5.0, 6.0], &[0.0, 1.0, 2.9, 3.1]);
        assert!(column[0].is_nan() && column[3].is_nan());
        // 5 for one second of 1.9, then 6.
        assert!((column[1] - (5.0 + 6.0 * 0.9) / 1.9).abs() < 1e-15 * 6.0 && column[2] == 6.0);
    }
}
