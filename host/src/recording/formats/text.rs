//! Fields of text files that are no plain numbers: lists, dates, times of day.

/// Element `element`, from 0, of the list in a field, as in `[0.1, 0.2]`, `(0.1, 0.2)`, `[0.1 0.2]` and
/// `array('d', [0.1, 0.2])`.
///
/// # Errors
/// How many elements there are, if that is too few.
pub(in crate::recording) fn cell_of_list(field: &[u8], element: usize) -> Result<&[u8], usize> {
    let items = items(field);
    items.get(element).copied().ok_or(items.len())
}

/// The elements of the list in a field; the field itself if it is no list.
pub(super) fn items(field: &[u8]) -> Vec<&[u8]> {
    let field = field.trim_ascii();
    let open = field.iter().rposition(|byte| b"[(".contains(byte)).map_or(0, |at| at + 1);
    let close = field[open..].iter().position(|byte| b"])".contains(byte)).map_or(field.len(), |at| open + at);
    let separates = |byte: &u8| b",; \t\n".contains(byte);
    field[open..close].split(separates).filter(|item| !item.is_empty()).collect()
}

/// Days from 1970-01-01 to a day of the Gregorian calendar (Hinnant's algorithm: years begin in March).
fn days(year: i64, month: i64, day: i64) -> i64 {
    let year = if month <= 2 { year - 1 } else { year };
    let (era, of_era) = (year.div_euclid(400), year.rem_euclid(400));
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468
}

/// Seconds of a time of day `12:34:56.789`, with a point or a comma, with or without seconds.
fn of_day(text: &str) -> Option<f64> {
    let mut parts = text.split(':');
    let (hours, minutes, seconds) = (parts.next()?, parts.next()?, parts.next().unwrap_or("0"));
    let plain = |part: &str| (1..=2).contains(&part.len()) && part.bytes().all(|byte| byte.is_ascii_digit());
    let digits = |byte: u8| byte.is_ascii_digit() || byte == b'.' || byte == b',';
    if parts.next().is_some() || !plain(hours) || !plain(minutes) || !seconds.bytes().all(digits) {
        return None;
    }
    let number = |part: &str| part.parse::<f64>().ok();
    let (hours, minutes, seconds) = (number(hours)?, number(minutes)?, number(&seconds.replace(',', "."))?);
    // A leap second is the 60th.
    (hours < 24.0 && minutes < 60.0 && seconds < 61.0).then(|| hours.mul_add(3600.0, minutes * 60.0) + seconds)
}

/// Seconds since 1970 of `2024-05-01T12:00:00.5Z`, with a blank for the `T`, an offset or none; of a time of day alone, since
/// midnight. `None` for everything else.
pub(in crate::recording) fn seconds_of_date(field: &[u8]) -> Option<f64> {
    let field = field.trim_ascii();
    // Most stamps are plain numbers.
    if !field.contains(&b':') {
        return None;
    }
    let text = std::str::from_utf8(field).ok()?;
    let Some((date, time)) = text.split_once(['T', ' ']) else { return of_day(text) };
    let mut parts = date.split(['-', '/']);
    let mut next = || parts.next().filter(|p| (1..=4).contains(&p.len()))?.parse::<u16>().ok().map(i64::from);
    let (year, month, day) = (next()?, next()?, next()?);
    if parts.next().is_some() || year < 1000 || !(1..=12).contains(&month) || !(1..=31).contains(&day) {
        return None;
    }
    let time = time.trim();
    let (time, offset_s) = match time.strip_suffix('Z').or_else(|| time.strip_suffix(" UTC")) {
        Some(time) => (time, 0.0),
        None => match time.rfind(['+', '-']) {
            Some(at) => {
                let (time, offset) = time.split_at(at);
                let sign = if offset.starts_with('-') { -1.0 } else { 1.0 };
                let offset = &offset[1..];
                let colon = if offset.contains(':') { offset.to_owned() } else { hours_and_minutes(offset)? };
                (time, sign * of_day(&colon)?)
            }
            None => (time, 0.0),
        },
    };
    Some(days(year, month, day) as f64 * 86_400.0 + of_day(time.trim())? - offset_s)
}

/// `0130` and `01` as `01:30` and `01:00`.
fn hours_and_minutes(offset: &str) -> Option<String> {
    let hours = offset.get(..2)?;
    let minutes = offset.get(2..).filter(|minutes| !minutes.is_empty()).unwrap_or("00");
    Some(format!("{hours}:{minutes}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers from `date -u -d … +%s`.
    #[test]
    fn dates_are_seconds_since_1970() {
        let seconds = |text: &str| seconds_of_date(text.as_bytes());
        assert_eq!(seconds("1970-01-01T00:00:00Z"), Some(0.0));
        assert_eq!(seconds("2024-02-29T12:00:00.25Z"), Some(1_709_208_000.25));
        assert_eq!(seconds("2024-02-29 12:00:00,25"), Some(1_709_208_000.25));
        assert_eq!(seconds("2024-02-29T13:30:00+01:30"), Some(1_709_208_000.0));
        assert_eq!(seconds("2024-02-29T07:00:00-0500"), Some(1_709_208_000.0));
        assert_eq!(seconds("2000/3/1 0:00:01"), Some(951_868_801.0));
        assert_eq!(seconds("1:02:03.5"), Some(3723.5));
        for text in ["0.5", "12", "a:b", "25:00:00", "2024-13-01T00:00:00", "2024-02-29T", "", "1:2:3:4", "1e3:00"] {
            assert_eq!(seconds(text), None, "{text}");
        }
    }

    #[test]
    fn lists_have_elements_however_they_are_written() {
        for list in ["[0.1, 0.2]", "(0.1,0.2)", "[0.1 0.2]", "array('d', [0.1, 0.2])", " [ 0.1 , 0.2 ] "] {
            assert_eq!(cell_of_list(list.as_bytes(), 1), Ok(b"0.2".as_slice()), "{list}");
            assert_eq!(cell_of_list(list.as_bytes(), 2), Err(2), "{list}");
        }
        assert_eq!(cell_of_list(b"[]", 0), Err(0));
        assert_eq!(cell_of_list(b"", 0), Err(0));
    }
}
