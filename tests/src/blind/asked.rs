//! The cases of a blind matrix, from the words of its command line.

use std::ops::Range;

use breakaway_hidden::{CATALOGUE, Case, DRAWN, Experiment, Setting, drawn};
use clap::Args;

/// What the cases are made of.
#[derive(Args, Clone, Debug)]
pub struct Asked {
    /// Kinds of experiment: suite, relay, multisine, track, slow_sine, closed
    #[arg(long, value_name = "KIND", value_delimiter = ',', default_value = "suite", value_parser = experiment)]
    pub experiment: Vec<Experiment>,
    /// Sizes of the hidden effects, per cent of the drive amplitude
    #[arg(long, value_name = "PERCENT", value_delimiter = ',', default_value = "10")]
    pub sizes: Vec<f64>,
    /// A seed, or a range of seeds, its end left out
    #[arg(long, value_name = "FROM..TO", default_value = "1..3", value_parser = range)]
    pub seeds: Range<u64>,
    /// What is hidden in a case each, joined by `+`; `none` hides nothing [default: each effect of the catalogue]
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub effects: Vec<String>,
    /// Hide this many random pairs of effects for each seed instead
    #[arg(long, value_name = "COUNT", default_value_t = 0, conflicts_with = "effects")]
    pub pairs: usize,
    /// Hide one, two or three random effects in this many cases of each seed instead
    #[arg(long, value_name = "COUNT", default_value_t = 0, conflicts_with = "effects")]
    pub drawn: usize,
    /// World of the cases: kind, unkind, or unkind:ITEM,… with these items alone
    #[arg(long, value_name = "WORLD", default_value = "kind", value_parser = Setting::named)]
    pub world: Setting,
}

impl Asked {
    /// The cases, one after the other.
    ///
    /// # Errors
    /// An effect's name that nothing has, in words.
    pub fn cases(&self) -> Result<Vec<Case>, String> {
        let mut all = Vec::new();
        for experiment in &self.experiment {
            for size in &self.sizes {
                for seed in self.seeds.clone() {
                    for hidden in self.hidden(seed) {
                        let names: Vec<&str> = hidden.split('+').filter(|name| *name != "none").collect();
                        let case = Case::new(seed, &names, *size, *experiment).map_err(|error| error.to_string())?;
                        all.push(case.within(self.world.draw(seed)));
                    }
                }
            }
        }
        Ok(all)
    }

    /// What is hidden in the cases of a seed.
    fn hidden(&self, seed: u64) -> Vec<String> {
        let pairs = (0..self.pairs).map(|index| pair(seed, index));
        let draws = (0..self.drawn).map(|index| drawn(seed, index as u64).join("+"));
        if self.pairs + self.drawn > 0 {
            return pairs.chain(draws).collect();
        }
        if self.effects.is_empty() { CATALOGUE.map(str::to_owned).to_vec() } else { self.effects.clone() }
    }
}

/// The kind of that name.
fn experiment(name: &str) -> Result<Experiment, String> {
    Experiment::named(name).ok_or_else(|| "one of suite, relay, multisine, track, slow_sine, closed".to_owned())
}

/// The seeds of `7`, or of `7..9`, its end left out.
///
/// # Errors
/// What a range looks like, in words.
pub fn range(seeds: &str) -> Result<Range<u64>, String> {
    let read = || -> Option<Range<u64>> {
        let Some((from, to)) = seeds.split_once("..") else {
            let one: u64 = seeds.parse().ok()?;
            return Some(one..one.checked_add(1)?);
        };
        Some(from.parse().ok()?..to.parse().ok()?).filter(|range| !range.is_empty())
    };
    read().ok_or_else(|| "a seed, or a range like 1..3, its end left out".to_owned())
}

/// The `index`-th pair of a seed: a walk through all ordered pairs in steps that have no divisor in common with their number.
fn pair(seed: u64, index: usize) -> String {
    let n = DRAWN;
    let at = (seed as usize * 101 + index * 29) % (n * n);
    let (a, b) = (at / n, at % n);
    let b = if a == b { (b + 7) % n } else { b };
    format!("{}+{}", CATALOGUE[a.min(b)], CATALOGUE[a.max(b)])
}

#[cfg(test)]
mod tests {
    use clap::Parser as _;

    use super::*;

    #[derive(clap::Parser)]
    struct Line {
        #[command(flatten)]
        asked: Asked,
    }

    fn asked(line: &str) -> Result<Asked, String> {
        let words = ["blind"].into_iter().chain(line.split(' '));
        Line::try_parse_from(words).map(|line| line.asked).map_err(|error| error.to_string())
    }

    #[test]
    fn options_become_cases() {
        let cases = asked("--sizes 3,10 --seeds 5..7 --effects cogging+delay,none,force_well --world unkind:closed");
        let cases = cases.unwrap().cases().unwrap();
        assert_eq!(cases.len(), 2 * 2 * 3);
        assert!(cases.iter().all(|case| case.world.closed && case.experiment == Experiment::Closed));
        assert!(cases[1].effects.is_empty() && cases[0].effects.len() == 2);
        let kind = asked("--sizes 3").unwrap().cases().unwrap();
        assert!(kind.len() == 2 * CATALOGUE.len() && kind.iter().all(|case| case.world.is_kind()));
        assert_eq!(asked("--seeds 1 --drawn 7 --world unkind:jitter,torque").unwrap().cases().unwrap().len(), 7);
        assert_eq!(asked("--seeds 1 --pairs 2").unwrap().cases().unwrap()[0].effects.len(), 2);
    }

    #[test]
    fn what_cannot_be_read_is_said() {
        let wrong =
            ["--sizes big", "--seeds 5..5", "--experiment relays", "--world unkind:rain", "--pairs many", "--size 3"];
        for line in wrong {
            let error = asked(line).unwrap_err();
            assert!(error.contains(line.split(' ').next().unwrap()), "{error}");
        }
        assert!(asked("--effects cogs").unwrap().cases().is_err());
        assert!(asked("--effects cogging --pairs 2").is_err());
    }
}
