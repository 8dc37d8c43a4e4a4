//! A session and what became of it, as a row of docs/mujoco.csv.

use breakaway_core::plant::Kind;
use serde::{Deserialize, Serialize};

use crate::machines::discovery::Said;
use crate::machines::rows::{cell, names};
use crate::machines::score::{Named, Score, score};
use crate::machines::truth::Truth;

/// One row. A session's `truth.csv` has its first eight columns.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Row {
    /// Name of the scenario.
    pub scenario: String,
    /// Seed of everything random.
    pub seed: u64,
    /// What the machine is.
    pub about: String,
    /// Effects that are missing, one of which must lead, joined by `+`; `dahl~lugre` is one that has either name. Empty where
    /// nothing of the catalogue is missing.
    pub lead: String,
    /// Further names that are true, joined by `+`.
    pub also: String,
    /// Whether something is missing that the catalogue does not have.
    pub outside: bool,
    /// Size of what is missing, per cent of the largest drive.
    pub size_percent: f64,
    /// Rate, encoder, random torque and clock.
    pub world: String,
    /// Commit that was run.
    pub commit: String,
    /// Verdict, or `refused`, `panicked`.
    pub verdict: String,
    /// Effects in order, as the rows of the real machines have them.
    pub named: String,
    /// Seconds of the clock.
    pub seconds: f64,
    /// Why the discovery was refused.
    pub note: String,
}

impl Row {
    /// The row with what a discovery said.
    #[must_use]
    pub fn discovered(self, commit: &str, said: Said) -> Self {
        Self {
            commit: commit.to_owned(),
            verdict: said.verdict,
            named: cell(&said.named),
            seconds: (10.0 * said.seconds).round() / 10.0,
            note: said.refusal.unwrap_or_default(),
            ..self
        }
    }

    /// Whether it is of the same session.
    pub fn is_of(&self, other: &Self) -> bool {
        (&self.scenario, self.seed) == (&other.scenario, other.seed)
    }

    /// The score by what is true.
    ///
    /// # Errors
    /// A name that no effect has.
    pub fn score(&self) -> Result<Score, String> {
        let (lead, also) = (kinds(&self.lead)?, kinds(&self.also)?);
        let truth = match (lead.is_empty(), self.outside) {
            (true, true) => Truth::Outside { also: &also },
            (true, false) => Truth::Nothing,
            (false, _) => Truth::lead(&lead, &also),
        };
        Ok(score(&truth, &self.verdict, &names(&self.named)?))
    }

    /// The effects that are missing, and were neither named nor tied with a name. A session may hide two.
    ///
    /// # Errors
    /// A name that no effect has.
    pub fn unnamed(&self) -> Result<Vec<Kind>, String> {
        let said = names(&self.named)?;
        let holds = |kind: &Kind| said.iter().any(|Named { kind: of, tied }| of == kind || tied.contains(kind));
        let has_name = |own: &Named| holds(&own.kind) || own.tied.iter().any(holds);
        Ok(names(&self.lead)?.into_iter().filter(|own| !has_name(own)).map(|own| own.kind).collect())
    }
}

fn kinds(cell: &str) -> Result<Vec<Kind>, String> {
    Ok(names(cell)?.into_iter().flat_map(|name| std::iter::once(name.kind).chain(name.tied)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(lead: &str, outside: bool, verdict: &str, named: &str) -> Row {
        Row { lead: lead.into(), outside, verdict: verdict.into(), named: named.into(), ..Row::default() }
    }

    /// The rule of the real machines, for the truths that a scenario can have.
    #[test]
    fn sessions_are_scored_as_the_real_machines() {
        assert_eq!(row("", false, "nothing_missing", "").score(), Ok(Score::Right));
        assert_eq!(row("", false, "explained", "dahl").score(), Ok(Score::Wrong));
        assert_eq!(row("", true, "unknown", "").score(), Ok(Score::Right));
        assert_eq!(row("", true, "nothing_missing", "").score(), Ok(Score::FalseNothing));
        assert_eq!(row("gravity_load", false, "explained", "spring~gravity_load").score(), Ok(Score::Right));
        assert_eq!(row("gravity_load", false, "unknown", "").score(), Ok(Score::Abstains));
        assert!(row("magic", false, "unknown", "").score().is_err());
    }

    #[test]
    fn of_two_effects_the_one_without_a_name_is_said() {
        let both = row("gravity_load+cogging", false, "partly_explained", "spring~gravity_load");
        assert_eq!((both.score(), both.unnamed()), (Ok(Score::Right), Ok(vec![Kind::Cogging])));
        let bristle = row("dahl~lugre", false, "explained", "lugre");
        assert_eq!((bristle.score(), bristle.unnamed()), (Ok(Score::Right), Ok(Vec::new())));
    }
}
