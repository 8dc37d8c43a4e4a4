//! The standard suite of a demo: run, kept as files, handed to discovery.

use std::path::Path;

use crate::discover::outcome::Provenance;
use crate::discover::request::Request;
use crate::file::make_folder;
use crate::fleet::hash::hash;
use crate::recording::Recording;
use crate::simulate::experiment::Experiment;
use crate::simulate::suite::Role;

/// Runs the experiments and writes each recording into `fit` or `score` of `folder`; `command` is what made them.
///
/// # Errors
/// An experiment that fails; files that cannot be written.
pub fn recorded(
    folder: &Path,
    command: String,
    experiments: Vec<(Role, Experiment)>,
    mut run: impl FnMut(&Experiment) -> anyhow::Result<Recording>,
) -> anyhow::Result<Request> {
    let version = env!("CARGO_PKG_VERSION").to_owned();
    let mut request =
        Request { provenance: Provenance { version, command, ..Provenance::default() }, ..Request::default() };
    for (role, experiment) in experiments {
        let recording = run(&experiment)?;
        let (part, list) = match role {
            Role::Fit => ("fit", &mut request.recordings),
            Role::Score => ("score", &mut request.holdout),
        };
        let part = folder.join(part);
        make_folder(&part)?;
        let file = part.join(format!("{}.csv", recording.name));
        recording.write(&file)?;
        request.provenance.inputs.push((file.display().to_string(), hash(&file)?));
        list.push(recording);
    }
    Ok(request)
}
