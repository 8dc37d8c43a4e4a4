//! Requests of a discovery, for examples that ask the judge alone.

use breakaway::discover::request::Request;
use breakaway::recording::{Recording, in_session_order};
use breakaway_hidden::{Case, Experiment, Role, Setting};
use clap::Args;

use crate::blind::asked::{Asked, range};
use crate::blind::recordings;

/// A request on these recordings alone.
pub fn request(recordings: &[Recording]) -> Request {
    Request { recordings: in_session_order(recordings), ..Request::default() }
}

/// A request on the recordings of a case that are to be fitted.
pub fn of_case(case: &Case) -> Request {
    request(&recordings(&case.generate_with_truth().0, Role::Fit))
}

/// Sessions of the hidden plant, as options of a command.
#[derive(Args, Clone, Debug)]
pub struct Sessions {
    /// Sessions of a world; each hides one to three effects where `--effects` is not given
    #[arg(long)]
    pub seeds: Option<String>,
    /// What each session hides: `cogging,delay+spring,none`
    #[arg(long, requires = "seeds")]
    pub effects: Option<String>,
    /// Per cent of the drive
    #[arg(long, value_delimiter = ',', default_value = "10")]
    pub sizes: Vec<f64>,
    /// The sessions' world
    #[arg(long, default_value = "unkind")]
    pub world: String,
}

impl Sessions {
    /// Sessions of the unkind world with one to three effects of 10 %.
    pub fn unkind(seeds: &str) -> Self {
        Self { seeds: Some(seeds.to_owned()), effects: None, sizes: vec![10.0], world: "unkind".to_owned() }
    }

    /// A case of each seed for each of the effects; `none` hides nothing. There is no case without seeds.
    ///
    /// # Errors
    /// Which word cannot be read, in words.
    pub fn cases(&self) -> Result<Vec<Case>, String> {
        let Some(seeds) = &self.seeds else { return Ok(Vec::new()) };
        let asked = Asked {
            experiment: vec![Experiment::Suite],
            sizes: self.sizes.clone(),
            seeds: range(seeds).map_err(|error| format!("{seeds}: {error}"))?,
            effects: self.effects.iter().flat_map(|all| all.split(',')).map(str::to_owned).collect(),
            pairs: 0,
            drawn: usize::from(self.effects.is_none()),
            world: Setting::named(&self.world).map_err(|error| error.to_string())?,
        };
        asked.cases()
    }
}
