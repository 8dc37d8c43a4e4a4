//! Requests of a discovery, for examples that ask the judge alone.

use breakaway::discover::engine::Request;
use breakaway::recording::{Recording, in_session_order};
use breakaway_hidden::{Case, Role};

use crate::blind::asked::Asked;
use crate::blind::recordings;

/// A request on these recordings alone.
pub fn request(recordings: &[Recording]) -> Request {
    Request { recordings: in_session_order(recordings), ..Request::default() }
}

/// A request on the recordings of a case that are to be fitted.
pub fn of_case(case: &Case) -> Request {
    request(&recordings(&case.generate_with_truth().0, Role::Fit))
}

/// A case of each seed in a world for each of `effects` (`none` hides nothing), or with one to three drawn effects where
/// none is given. `sizes` are per cent of the drive.
///
/// # Errors
/// Which word cannot be read, in words.
pub fn cases(seeds: &str, world: &str, effects: Option<&str>, sizes: &str) -> Result<Vec<Case>, String> {
    let option = |name: &str| match name {
        "seeds" => Some(seeds.to_owned()),
        "world" => Some(world.to_owned()),
        "sizes" => Some(sizes.to_owned()),
        "drawn" if effects.is_none() => Some("1".to_owned()),
        "effects" => effects.map(str::to_owned),
        _ => None,
    };
    Asked::from_options(option)?.cases()
}
