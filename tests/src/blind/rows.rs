//! The blind matrix as rows of a file: written as cases end, read back to go on and to draw the table.
//!
//! A row of an unkind world has four cells more than one of the kind world; a file may hold both.

use std::fmt::Write as _;

use breakaway_hidden::{Case, Hidden, Setting};

use super::{Scored, rules};

/// Header of a file of the kind world.
pub const HEADER: &str = "experiment,hidden,size_percent,seed,verdict,named,tied,parameter_error,shrink,over_noise,over_truth,\
                          visibility,seconds";
/// What the header of a file of an unkind world has more.
pub const UNKIND_HEADER: &str = ",world,drawn,lead_tied,processor_s";
/// The kind world's name.
const KIND: &str = "kind";

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
    /// Verdict, or `error`, or `given_up`.
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
    /// Name of the world's setting; `kind` where the file has no such cell.
    pub world: String,
    /// What was drawn of that world, as the hidden plant writes it.
    pub drawn: String,
    /// Effects listed as tied with the lead, which is the first name that the world does not excuse.
    pub lead_tied: Vec<String>,
    /// Processor time of the case, s: generation, discovery and score; NaN where it is not known.
    pub processor_s: f64,
}

fn list(names: &[&'static str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}

impl Row {
    /// The row of a case, before anything is known of it.
    fn empty(case: &Case, setting: &Setting) -> Self {
        let nothing = f64::NAN;
        let hidden = case.effects.iter().filter(|e| **e != Hidden::None).map(|e| e.name());
        Self {
            experiment: case.experiment.name().to_owned(),
            hidden: list(&hidden.collect::<Vec<_>>()),
            size_percent: case.size_percent,
            seed: case.seed,
            verdict: "error".to_owned(),
            named: Vec::new(),
            tied: Vec::new(),
            parameter_error: nothing,
            shrink: nothing,
            over_noise: nothing,
            over_truth: nothing,
            visibility: nothing,
            seconds: nothing,
            world: setting.name(),
            drawn: case.world.text(),
            lead_tied: Vec::new(),
            processor_s: nothing,
        }
    }

    /// The row of a case that ended in an error.
    pub fn error(case: &Case, setting: &Setting) -> Self {
        Self::empty(case, setting)
    }

    /// The row of a case that was given up after so much processor time.
    pub fn given_up(case: &Case, setting: &Setting, processor_s: f64) -> Self {
        Self { verdict: "given_up".to_owned(), processor_s, ..Self::empty(case, setting) }
    }

    /// The row of a scored case.
    pub fn new(case: &Case, setting: &Setting, scored: &Scored) -> Self {
        let named = list(&scored.named);
        let row = Self {
            verdict: scored.verdict.name().to_owned(),
            tied: list(&scored.tied.concat()),
            parameter_error: scored.parameter_error.unwrap_or(f64::NAN),
            shrink: scored.shrink,
            over_noise: scored.over_noise,
            over_truth: scored.over_truth,
            visibility: scored.visibility,
            seconds: scored.seconds,
            named,
            ..Self::empty(case, setting)
        };
        let lead_tied =
            rules::lead(&row).and_then(|lead| scored.tied.get(lead)).map_or_else(Vec::new, |tied| list(tied));
        Self { lead_tied, ..row }
    }

    /// Whether it is the row of this case in this setting.
    pub fn is_of(&self, case: &Case, setting: &Setting) -> bool {
        let other = Self::empty(case, setting);
        self.seed == other.seed
            && self.hidden == other.hidden
            && self.experiment == other.experiment
            && self.size_percent.to_bits() == other.size_percent.to_bits()
            && self.world == other.world
    }

    /// Whether it is of the kind world.
    pub fn is_kind(&self) -> bool {
        self.world == KIND
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
        if !self.is_kind() {
            let tied = self.lead_tied.join("+");
            let _ = write!(line, ",{},{},{tied},{:.1}", self.world, self.drawn, self.processor_s);
        }
        line
    }

    /// Reads a line; `None` for the header and for what is no row.
    pub fn parse(line: &str) -> Option<Self> {
        let cells: Vec<&str> = line.trim().split(',').collect();
        let [experiment, hidden, size, seed, verdict, named, tied, rest @ ..] = cells.as_slice() else {
            return None;
        };
        let (numbers, world) = rest.split_at_checked(6)?;
        let [world, drawn, lead_tied, processor_s] = match world {
            [] => [KIND, "", "", "NaN"],
            [world, drawn, lead_tied, processor_s] => [*world, *drawn, *lead_tied, *processor_s],
            _ => return None,
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
            world: world.to_owned(),
            drawn: drawn.to_owned(),
            lead_tied: names(lead_tied),
            processor_s: processor_s.parse().ok()?,
        })
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
        assert!(row.is_kind() && row.drawn.is_empty());
        assert_eq!(Row::parse(HEADER), None);
        let line = line.to_owned() + ",unkind:torque+zero,torque=0.120%@40Hz zero,stiction,31.5";
        let row = Row::parse(&line).unwrap();
        assert_eq!(row.line(), line);
        assert!(!row.is_kind() && row.lead_tied == ["stiction"] && row.processor_s == 31.5);
        assert_eq!(Row::parse(&(HEADER.to_owned() + UNKIND_HEADER)), None);
    }

    /// The rows of the kind world in docs/blind.md, which have no cells of a world.
    #[test]
    fn the_kind_file_is_read_whole() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/blind.csv");
        let text = std::fs::read_to_string(path).unwrap();
        let rows: Vec<Row> = text.lines().filter_map(Row::parse).collect();
        assert_eq!(rows.len() + 1, text.lines().count());
        assert!(rows.iter().all(Row::is_kind));
    }
}
