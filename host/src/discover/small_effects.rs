//! Effects too small for the measured forces, on a machine so quiet that the sensor's noise is all that need be left: the simulated
//! motion is fitted, and what comes down to that noise is believed.

use super::chain::Chain;
use super::data::{FIT_SEGMENT_S, SHORT_SEGMENT_S};
use super::engine::{DiscoverError, Request, assembled, prepared};
use super::judge::ruling::Ruling;
use super::outcome::{Discovery, Verdict};
use crate::recording::Units;

/// What the simulation says.
///
/// A gap that nothing explains over segments of [`FIT_SEGMENT_S`] is looked at again over [`SHORT_SEGMENT_S`].
///
/// # Errors
/// [`DiscoverError`].
pub(super) fn found(
    request: &Request,
    units: &Units,
    ruling: Option<&Ruling>,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Discovery, DiscoverError> {
    let mut found = within(request, units, FIT_SEGMENT_S, ruling, progress)?;
    if found.verdict == Verdict::Unknown {
        progress("looking again over shorter segments");
        match within(request, units, SHORT_SEGMENT_S, ruling, progress) {
            Ok(mut short) if !short.effects.is_empty() => {
                short.remarks.push(format!(
                    "no model follows the motion over {FIT_SEGMENT_S} s: fitted and scored over segments of \
                     {SHORT_SEGMENT_S} s"
                ));
                found = short;
            }
            Ok(short) => found.nearest = short.nearest.or(found.nearest),
            Err(_) => (),
        }
        found.remarks.extend(found.nearest.clone().filter(|_| found.effects.is_empty()));
    }
    Ok(found)
}

/// The chain over segments of one length.
fn within(
    request: &Request,
    units: &Units,
    segment_s: f64,
    ruling: Option<&Ruling>,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Discovery, DiscoverError> {
    let start =
        prepared(request, segment_s, None, progress).or_else(|_| prepared(request, segment_s, ruling, progress))?;
    let chain = grown(Chain::new(&start.data, units, start.base.clone()), progress);
    let other = chain.begun_otherwise().map(|other| grown(other, progress)).find(|other| other.replaces(&chain));
    let ended = other.unwrap_or(chain).end();
    Ok(assembled(request, &start, units, ended, progress))
}

/// A model grown until nothing is missing, or nothing more can be named.
fn grown<'a>(mut chain: Chain<'a>, progress: &(dyn Fn(&str) + Sync)) -> Chain<'a> {
    while chain.step(progress) {}
    chain
}
