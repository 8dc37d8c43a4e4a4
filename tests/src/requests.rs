//! Requests of a discovery, for examples that ask the judge alone.

use breakaway::discover::engine::Request;
use breakaway::recording::{Recording, in_session_order};
use breakaway_hidden::{Case, Experiment, Role, Setting};

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

/// A case of each seed in a world for each of `effects`; `none` hides nothing. Without `effects` each case hides one to
/// three that are drawn. `sizes` are per cent of the drive.
///
/// # Errors
/// Which word cannot be read, in words.
pub fn cases(seeds: &str, world: &str, effects: Option<&str>, sizes: &[f64]) -> Result<Vec<Case>, String> {
    let asked = Asked {
        experiment: vec![Experiment::Suite],
        sizes: sizes.to_vec(),
        seeds: range(seeds).map_err(|error| format!("{seeds}: {error}"))?,
        effects: effects.map_or_else(Vec::new, |effects| effects.split(',').map(str::to_owned).collect()),
        pairs: 0,
        drawn: usize::from(effects.is_none()),
        world: Setting::named(world).map_err(|error| error.to_string())?,
    };
    asked.cases()
}
