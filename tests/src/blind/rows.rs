//! The blind matrix as rows of a file: written as cases end, read back to go on and to draw the table.

use std::fmt::Write as _;

use breakaway_hidden::Experiment;

use super::Scored;

/// Header of the file.
pub const HEADER: &str = "experiment,hidden,size_percent,seed,verdict,named,tied,parameter_error,shrink,over_noise,over_truth,\
                          visibility,seconds";

/// A case and what became of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Kind of experiment.
    pub experiment: String,
    /// Hidden effects; empty for a clean record.
    pub hidden: Vec<String>,
    /// Size, per cent of the drive amplitude.
    pub size_percent: f64,
    /// Seed.
    pub seed: u64,
    /// Verdict, or `error`.
    pub verdict: String,
    /// Effects named.
    pub named: Vec<String>,
    /// Effects listed as tied with them.
    pub tied: Vec<String>,
    /// Relative error of the first hidden effect's main parameter; NaN if it was not named.
    pub parameter_error: f64,
    /// Held-out error over the base's, over the noise floor, and over the truth's own.
    pub shrink: f64,
    /// See `shrink`.
    pub over_noise: f64,
    /// See `shrink`.
    pub over_truth: f64,
    /// Root mean square of what the effect changes over the noise, see the hidden plant.
    pub visibility: f64,
    /// Seconds taken.
    pub seconds: f64,
}

fn list(names: &[&'static str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}

impl Row {
    /// The row of a scored case.
    pub fn new(experiment: Experiment, size_percent: f64, scored: &Scored) -> Self {
        Self {
            experiment: experiment.name().to_owned(),
            hidden: list(&scored.hidden),
            size_percent,
            seed: scored.seed,
            verdict: scored.verdict.name().to_owned(),
            named: list(&scored.named),
            tied: list(&scored.tied),
            parameter_error: scored.parameter_error.unwrap_or(f64::NAN),
            shrink: scored.shrink,
            over_noise: scored.over_noise,
            over_truth: scored.over_truth,
            visibility: scored.visibility,
            seconds: scored.seconds,
        }
    }

    /// The row of a case that ended in an error.
    pub fn error(experiment: Experiment, hidden: &[&'static str], size_percent: f64, seed: u64) -> Self {
        let nothing = f64::NAN;
        Self {
            experiment: experiment.name().to_owned(),
            hidden: list(hidden),
            size_percent,
            seed,
            verdict: "error".to_owned(),
            named: Vec::new(),
            tied: Vec::new(),
            parameter_error: nothing,
            shrink: nothing,
            over_noise: nothing,
            over_truth: nothing,
            visibility: nothing,
            seconds: nothing,
        }
    }

    /// As a line of the file.
    pub fn line(&self) -> String {
        let mut line = format!(
            "{},{},{},{},{},{},{}",
            self.experiment,
            self.hidden.join("+"),
            self.size_percent,
            self.seed,
            self.verdict,
            self.named.join("+"),
            self.tied.join("+")
        );
        for value in
            [self.parameter_error, self.shrink, self.over_noise, self.over_truth, self.visibility, self.seconds]
        {
            let _ = write!(line, ",{value:.4}");
        }
        line
    }

    /// Reads a line; `None` for the header and for what is no row.
    pub fn parse(line: &str) -> Option<Self> {
        let cells: Vec<&str> = line.trim().split(',').collect();
        let [experiment, hidden, size, seed, verdict, named, tied, numbers @ ..] = cells.as_slice() else {
            return None;
        };
        let names = |cell: &str| cell.split('+').filter(|n| !n.is_empty()).map(str::to_owned).collect::<Vec<_>>();
        let numbers: Vec<f64> = numbers.iter().map(|n| n.parse()).collect::<Result<_, _>>().ok()?;
        let [parameter_error, shrink, over_noise, over_truth, visibility, seconds] = *numbers.as_slice() else {
            return None;
        };
        Some(Self {
            experiment: (*experiment).to_owned(),
            hidden: names(hidden),
            size_percent: size.parse().ok()?,
            seed: seed.parse().ok()?,
            verdict: (*verdict).to_owned(),
            named: names(named),
            tied: names(tied),
            parameter_error,
            shrink,
            over_noise,
            over_truth,
            visibility,
            seconds,
        })
    }

    /// Whether all hidden effects were named, and nothing else.
    pub fn right(&self) -> bool {
        let sorted = |names: &[String]| {
            let mut names = names.to_vec();
            names.sort_unstable();
            names
        };
        sorted(&self.hidden) == sorted(&self.named)
    }

    /// Whether something was named that is not hidden.
    pub fn wrong(&self) -> bool {
        self.named.iter().any(|name| !self.hidden.contains(name))
    }

    /// Whether it is wrong, and what is hidden was listed as tied with what was named in its place: "these recordings cannot tell".
    pub fn wrong_but_tied(&self) -> bool {
        let said = |name: &String| self.named.contains(name) || self.tied.contains(name);
        self.wrong() && self.named.len() <= self.hidden.len() && self.hidden.iter().all(said)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line read back is the row that wrote it.
    #[test]
    fn lines_come_back() {
        let line = "suite,stribeck+cogging,10,501,partly_explained,stribeck+delay,lugre,0.0120,0.3000,1.1000,1.0500,12.3000,2.5000";
        let row = Row::parse(line).unwrap();
        assert_eq!(row.line(), line);
        assert!(row.wrong() && !row.right() && !row.wrong_but_tied());
        assert!(Row { tied: vec!["cogging".into()], ..row.clone() }.wrong_but_tied());
        // A name too much is wrong, whatever is tied with the others.
        let more = Row { hidden: vec!["stribeck".into()], tied: vec!["stiction".into()], ..row };
        assert!(more.wrong() && !more.wrong_but_tied());
        assert_eq!(Row::parse(HEADER), None);
    }
}
