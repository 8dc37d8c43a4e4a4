//! The nearest valid name, for error messages.

/// Least similarity (Jaro–Winkler, 0 to 1) at which a name is worth suggesting: `t` finds `t_s` (0.8), `foo` does not find `bar`.
const WORTH_SUGGESTING: f64 = 0.6;

/// The candidate most like `name`, upper and lower case alike, or `None` when nothing is near.
pub fn nearest<'a, I>(name: &str, candidates: I) -> Option<&'a str>
where
    I: IntoIterator<Item = &'a str>,
{
    let wanted = name.to_lowercase();
    candidates
        .into_iter()
        .map(|candidate| {
            let likeness = strsim::jaro_winkler(&wanted, &candidate.to_lowercase());
            (likeness, candidate)
        })
        .filter(|(likeness, _)| *likeness >= WORTH_SUGGESTING)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

/// `"; did you mean `x`?"`, or nothing when nothing is near.
pub(crate) fn did_you_mean(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |name| format!("; did you mean `{name}`?"))
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn finds_the_column_a_person_meant() {
        let columns = ["t_s", "x_rad", "v_rad_s", "iq_A"];
        assert_eq!(nearest("t", columns), Some("t_s"));
        assert_eq!(nearest("x", columns), Some("x_rad"));
        assert_eq!(nearest("IQ", columns), Some("iq_A"));
        assert_eq!(nearest("x_rda", columns), Some("x_rad"));
        assert_eq!(nearest("pressure", ["t", "u"]), None);
    }
}
