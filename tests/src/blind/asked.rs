//! The cases of a blind matrix, from the words of its command line.

use breakaway_hidden::{CATALOGUE, Case, Experiment, Setting, drawn};

/// What the cases are made of.
#[derive(Clone, Debug)]
pub struct Asked {
    /// Kinds of experiment.
    pub experiments: Vec<Experiment>,
    /// Sizes, per cent of the drive amplitude.
    pub sizes: Vec<f64>,
    /// Seeds.
    pub seeds: std::ops::Range<u64>,
    /// What is hidden in a case each; names are parted by `+`, `none` is a clean record.
    pub effects: Vec<String>,
    /// So many random pairs of each seed, in place of `effects`.
    pub pairs: usize,
    /// So many draws of one, two or three effects of each seed, in place of `effects`.
    pub drawn: usize,
    /// Which world.
    pub setting: Setting,
}

impl Asked {
    /// Of the value of each option, by its name without dashes.
    ///
    /// # Errors
    /// Which option cannot be read, in words.
    pub fn from_options(option: impl Fn(&str) -> Option<String>) -> Result<Self, String> {
        let words = |name: &str, default: &str| -> Vec<String> {
            option(name).unwrap_or_else(|| default.into()).split(',').map(str::to_owned).collect()
        };
        let count = |name: &str| match option(name) {
            None => Ok(0),
            Some(text) => text.parse().map_err(|_| format!("--{name} {text}: a number of cases")),
        };
        let experiment = |name: &String| {
            Experiment::named(name)
                .ok_or_else(|| format!("--experiment {name}: suite, relay, multisine, track, slow_sine or closed"))
        };
        let size = |text: &String| text.parse().map_err(|_| format!("--sizes {text}: per cent of the drive amplitude"));
        let seeds = option("seeds").unwrap_or_else(|| "1..3".into());
        let all = option("effects").map_or_else(|| CATALOGUE.map(str::to_owned).to_vec(), |_| words("effects", ""));
        Ok(Self {
            experiments: words("experiment", "suite").iter().map(experiment).collect::<Result<_, _>>()?,
            sizes: words("sizes", "10").iter().map(size).collect::<Result<_, _>>()?,
            seeds: range(&seeds)
                .ok_or_else(|| format!("--seeds {seeds}: a seed, or a range like 1..3, its end left out"))?,
            effects: all,
            pairs: count("pairs")?,
            drawn: count("drawn")?,
            setting: Setting::named(&option("world").unwrap_or_else(|| "kind".into()))
                .map_err(|error| format!("--world: {error}"))?,
        })
    }

    /// The cases, one after the other.
    ///
    /// # Errors
    /// An effect's name that nothing has, in words.
    pub fn cases(&self) -> Result<Vec<Case>, String> {
        let mut all = Vec::new();
        for experiment in &self.experiments {
            for size in &self.sizes {
                for seed in self.seeds.clone() {
                    for hidden in self.hidden(seed) {
                        let names: Vec<&str> = hidden.split('+').filter(|name| *name != "none").collect();
                        let case = Case::new(seed, &names, *size, *experiment).map_err(|error| error.to_string())?;
                        all.push(case.within(self.setting.draw(seed)));
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
        if self.pairs + self.drawn == 0 { self.effects.clone() } else { pairs.chain(draws).collect() }
    }
}

/// The seeds of `7`, or of `7..9`, its end left out.
fn range(seeds: &str) -> Option<std::ops::Range<u64>> {
    let Some((from, to)) = seeds.split_once("..") else {
        let one = seeds.parse().ok()?;
        return Some(one..one + 1);
    };
    Some(from.parse().ok()?..to.parse().ok()?).filter(|range| !range.is_empty())
}

/// The `index`-th pair of a seed: a walk through all ordered pairs in steps that have no divisor in common with their number.
fn pair(seed: u64, index: usize) -> String {
    let n = CATALOGUE.len();
    let at = (seed as usize * 101 + index * 29) % (n * n);
    let (a, b) = (at / n, at % n);
    let b = if a == b { (b + 7) % n } else { b };
    format!("{}+{}", CATALOGUE[a.min(b)], CATALOGUE[a.max(b)])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(line: &str) -> Result<Asked, String> {
        let words: Vec<&str> = line.split(' ').collect();
        let value = |name: &str| words.iter().position(|w| *w == format!("--{name}")).map(|i| words[i + 1].to_owned());
        Asked::from_options(value)
    }

    #[test]
    fn options_become_cases() {
        let cases = asked("--sizes 3,10 --seeds 5..7 --effects cogging+delay,none,force_well --world unkind:closed");
        let cases = cases.unwrap().cases().unwrap();
        assert_eq!(cases.len(), 2 * 2 * 3);
        assert!(cases.iter().all(|case| case.world.closed && case.experiment == Experiment::Closed));
        assert!(cases[1].effects.is_empty() && cases[0].effects.len() == 2);
        let kind = asked("--sizes 3").unwrap().cases().unwrap();
        assert!(kind.len() == 48 && kind.iter().all(|case| case.world.is_kind()));
        assert_eq!(asked("--seeds 1 --drawn 7 --world unkind").unwrap().cases().unwrap().len(), 7);
        assert_eq!(asked("--seeds 1 --pairs 2").unwrap().cases().unwrap()[0].effects.len(), 2);
    }

    #[test]
    fn what_cannot_be_read_is_said() {
        for line in ["--sizes big", "--seeds 5..5", "--experiment relays", "--world unkind:rain", "--pairs many"] {
            let error = asked(line).unwrap_err();
            assert!(error.starts_with(line.split(' ').next().unwrap()), "{error}");
        }
        assert!(asked("--effects cogs").unwrap().cases().is_err());
    }
}
