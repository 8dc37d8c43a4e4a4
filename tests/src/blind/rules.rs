//! How an answer is scored: docs/blind.md, section *How it is scored*.

use breakaway_hidden::CATALOGUE;

use super::rows::Row;

/// Names of a position or drive that comes late; where the sensor itself is late they are one.
const LATE: [&str; 2] = ["delay", "electrical_lag"];
/// What a supply that sags may be called: less drive at large drive, and less under load.
const SAGGING: [&str; 2] = ["saturation", "load_friction"];

/// A spring's rest position is moved by a constant load, −k·(x − x0) + f0 = −k·(x − x0 − f0/k): the two are one spring.
const SPRING: [&str; 2] = ["spring", "constant_load"];

/// Whether the row's world has this item.
pub fn has(row: &Row, item: &str) -> bool {
    row.drawn.split(' ').any(|word| word.split('=').next() == Some(item))
}

/// Whether the name is a hidden effect, or one that cannot be told from it in this world.
fn is_hidden(row: &Row, name: &String) -> bool {
    let late = |name: &String| LATE.contains(&name.as_str());
    row.hidden.contains(name) || (has(row, "delay") && late(name) && row.hidden.iter().any(late))
}

/// The names with a constant load beside a spring left out.
fn without_rest(names: &[String]) -> impl Iterator<Item = &String> {
    let [spring, load] = SPRING;
    let beside = names.iter().any(|name| name == spring);
    names.iter().filter(move |name| !(beside && *name == load))
}

/// Whether the name is no hidden effect, but says what the world does.
fn is_excused(row: &Row, name: &String) -> bool {
    let world = |item: &str, names: [&str; 2]| has(row, item) && names.contains(&name.as_str());
    !is_hidden(row, name) && (world("delay", LATE) || world("sag", SAGGING))
}

/// Which of the names is the lead: the first that the world does not excuse.
pub fn lead(row: &Row) -> Option<usize> {
    row.named.iter().position(|name| !is_excused(row, name))
}

impl Row {
    /// Whether the lead is hidden, or tied with what is hidden.
    pub fn lead_right(&self) -> bool {
        lead(self)
            .is_some_and(|lead| is_hidden(self, &self.named[lead]) || self.lead_tied.iter().any(|n| is_hidden(self, n)))
    }

    /// Whether all hidden effects were named, and nothing else. A ripple counts once: the hidden one has two waves in it,
    /// and each may be named.
    pub fn right(&self) -> bool {
        let sorted = |names: &[String]| {
            let one = |name: &String| {
                let late = has(self, "delay") && LATE.contains(&name.as_str());
                if late { LATE[0].to_owned() } else { name.clone() }
            };
            let mut names: Vec<String> = without_rest(names).filter(|name| !is_excused(self, name)).map(one).collect();
            names.sort_unstable();
            names.dedup();
            names
        };
        !self.without_answer() && sorted(&self.hidden) == sorted(&self.named)
    }

    /// Whether there was no answer to score: an error, or too much time.
    pub fn without_answer(&self) -> bool {
        matches!(self.verdict.as_str(), "error" | "given_up")
    }

    /// Whether something was named that is neither hidden nor excused, even if what is hidden is listed as tied with it.
    pub fn wrong(&self) -> bool {
        self.named.iter().any(|name| !is_hidden(self, name) && !is_excused(self, name))
    }

    /// Whether it is wrong, and what is hidden was listed as tied with what was named in its place: "these recordings cannot tell".
    pub fn wrong_but_tied(&self) -> bool {
        let said = |name: &String| self.named.contains(name) || self.tied.contains(name);
        self.wrong() && self.named.len() <= self.hidden.len() && self.hidden.iter().all(said)
    }

    /// Whether every hidden effect is in the catalogue, and there is one.
    pub fn is_catalogued(&self) -> bool {
        !self.hidden.is_empty() && self.hidden.iter().all(|h| CATALOGUE.contains(&h.as_str()))
    }

    /// Whether the verdict is the right one.
    pub fn verdict_right(&self) -> bool {
        let said = |hidden: &&String| -> bool {
            let names = || self.named.iter().chain(&self.tied);
            let late = LATE.contains(&hidden.as_str()) && has(self, "delay");
            names().any(|name| name == *hidden || (late && LATE.contains(&name.as_str())))
        };
        let verdict = self.verdict.as_str();
        if self.hidden.is_empty() {
            let only_the_world = !self.named.is_empty() && lead(self).is_none();
            return verdict == "nothing_missing" || (verdict == "explained" && only_the_world);
        }
        if !self.is_catalogued() {
            return matches!(verdict, "unknown" | "partly_explained");
        }
        let hidden: Vec<&String> = without_rest(&self.hidden).collect();
        match hidden.iter().copied().filter(said).count() {
            0 => false,
            all if all == hidden.len() => verdict == "explained",
            _ => verdict == "partly_explained",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of this world, with what is hidden, said and tied.
    fn row(drawn: &str, hidden: &str, verdict: &str, named: &str, lead_tied: &str) -> Row {
        let numbers = "NaN,NaN,NaN,NaN,NaN,1.0";
        Row::parse(&format!(
            "suite,{hidden},10,1,{verdict},{named},{lead_tied},{numbers},unkind,{drawn},{lead_tied},1.0"
        ))
        .unwrap()
    }

    #[test]
    fn kind_rows_are_scored_as_before() {
        let row = row("", "stribeck+cogging", "partly_explained", "stribeck+delay", "lugre");
        assert!(row.wrong() && !row.right() && !row.wrong_but_tied());
        assert!(Row { tied: vec!["cogging".into()], ..row.clone() }.wrong_but_tied());
        // A name too much is wrong, whatever is tied with the others.
        let more = Row { hidden: vec!["stribeck".into()], tied: vec!["stiction".into()], ..row };
        assert!(more.wrong() && !more.wrong_but_tied());
    }

    #[test]
    fn a_tie_that_holds_the_truth_is_a_right_lead() {
        let tied = row("", "stiction", "explained", "stribeck", "stiction");
        assert!(tied.lead_right() && tied.wrong() && tied.wrong_but_tied() && tied.verdict_right());
        let other = row("", "stiction", "explained", "stribeck", "lugre");
        assert!(!other.lead_right() && !other.verdict_right());
        // The second name does not lead.
        let second = row("", "cogging", "explained", "delay+cogging", "");
        assert!(!second.lead_right() && second.wrong() && second.verdict_right());
    }

    #[test]
    fn the_world_excuses_its_own_names_and_no_others() {
        for (drawn, name) in [("delay=2ms", "delay"), ("delay=2ms", "electrical_lag"), ("sag=1%", "saturation")] {
            let excused = row(drawn, "cogging", "explained", &format!("{name}+cogging"), "");
            assert!(excused.lead_right() && excused.right() && !excused.wrong(), "{excused:?}");
            let strict = row("held=4ms zero", "cogging", "explained", &format!("{name}+cogging"), "");
            assert!(!strict.lead_right() && !strict.right() && strict.wrong(), "{strict:?}");
            let nothing = row(drawn, "cogging", "explained", name, "");
            assert!(!nothing.lead_right() && !nothing.wrong() && !nothing.verdict_right(), "{nothing:?}");
            let clean = row(drawn, "", "explained", name, "");
            assert!(clean.right() && clean.verdict_right() && !clean.wrong(), "{clean:?}");
        }
        assert!(row("sag=1%", "cogging", "explained", "delay+cogging", "").wrong());
    }

    #[test]
    fn a_late_sensor_makes_delay_and_lag_one() {
        let late = row("rate=200Hz delay=2ms", "electrical_lag", "explained", "delay", "");
        assert!(late.lead_right() && late.right() && !late.wrong() && late.verdict_right());
        let strict = row("rate=200Hz", "electrical_lag", "explained", "delay", "");
        assert!(!strict.lead_right() && !strict.right() && strict.wrong() && !strict.verdict_right());
    }

    /// The hidden cogging of 22 waves in a turn has 44 waves too, of .3 of its amplitude. They are two names of one effect.
    #[test]
    fn the_waves_of_a_ripple_are_one_effect() {
        assert!(row("", "cogging", "explained", "cogging+cogging", "").right());
        assert!(!row("", "cogging+spring", "explained", "cogging+cogging", "").right());
    }

    #[test]
    fn a_constant_load_beside_a_spring_is_its_rest_position() {
        let row = row("", "spring+constant_load", "explained", "spring", "");
        assert!(row.right() && row.verdict_right());
        let load = Row { named: vec!["constant_load".into()], ..row };
        assert!(!load.right() && !load.verdict_right());
    }

    #[test]
    fn verdicts() {
        let right = |hidden, verdict, named| row("", hidden, verdict, named, "").verdict_right();
        assert!(right("", "nothing_missing", "") && !right("", "unknown", "") && !right("", "explained", "delay"));
        assert!(right("dahl", "explained", "dahl") && !right("dahl", "partly_explained", "dahl"));
        assert!(!right("dahl", "unknown", "") && !right("dahl", "nothing_missing", ""));
        assert!(right("dahl+spring", "partly_explained", "dahl") && !right("dahl+spring", "explained", "dahl"));
        assert!(right("force_well", "unknown", "") && right("force_well", "partly_explained", "cogging"));
        assert!(!row("", "", "error", "", "").right() && !row("", "", "given_up", "", "").right());
        assert!(!right("force_well", "explained", "cogging") && !right("force_well", "nothing_missing", ""));
    }
}
