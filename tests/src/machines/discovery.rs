//! The one place that calls the discovery, and reads what it found.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use breakaway::discover::engine::discover;
use breakaway::discover::outcome::Discovery;
use breakaway::discover::progress::Watch;
use breakaway::discover::request::Request;

use super::score::{Named, PANICKED, REFUSED};
use super::splits::Taken;

/// What a discovery said of a split.
#[derive(Clone, Debug)]
pub struct Said {
    /// Verdict by its name, or [`REFUSED`], or [`PANICKED`].
    pub verdict: String,
    /// Names, in order.
    pub named: Vec<Named>,
    /// `b`, `c`, `f1` and `effect.symbol`: the values of the final model.
    pub parameters: Vec<(String, f64)>,
    /// Held-out force residual of the base and of the final model, share of the drive.
    pub force: Option<[f64; 2]>,
    /// Held-out open-loop error over 1 s of the base and of the final model, position units.
    pub open_loop: Option<[f64; 2]>,
    /// Position noise, position units.
    pub noise: Option<f64>,
    /// Seconds of the clock.
    pub seconds: f64,
    /// Why nothing was found out, where it was refused.
    pub refusal: Option<String>,
}

/// Discovers a split with nothing told. A panic is a result of its own: the other rows are still to come.
pub fn run(taken: Taken, progress: Watch<'_>) -> Said {
    let began = Instant::now();
    let request = Request { recordings: taken.fit, holdout: taken.holdout, ..Request::default() };
    let nothing = |verdict: &str, refusal: String| Said {
        verdict: verdict.to_owned(),
        named: Vec::new(),
        parameters: Vec::new(),
        force: None,
        open_loop: None,
        noise: None,
        seconds: began.elapsed().as_secs_f64(),
        refusal: Some(refusal),
    };
    match catch_unwind(AssertUnwindSafe(|| discover(&request, progress))) {
        Ok(Ok(found)) => said(&found),
        Ok(Err(error)) => nothing(REFUSED, error.to_string()),
        Err(_) => nothing(PANICKED, "the discovery panicked".to_owned()),
    }
}

fn said(found: &Discovery) -> Said {
    let ends = found.ladder.first().zip(found.ladder.last());
    let named = found.effects.iter().map(|effect| Named {
        kind: effect.kind,
        tied: effect.rivals.iter().filter(|rival| rival.tied).map(|rival| rival.kind).collect(),
    });
    Said {
        verdict: found.verdict.name().to_owned(),
        named: named.collect(),
        parameters: parameters(found),
        force: found.force.map(|force| force.drive),
        // 0 where no window of 1 s is held out.
        open_loop: ends
            .map(|(first, last)| [first.holdout_open_loop_rmse, last.holdout_open_loop_rmse])
            .filter(|errors| errors.iter().any(|&error| error > 0.0)),
        noise: Some(found.noise_floor),
        seconds: found.seconds,
        refusal: None,
    }
}

/// The base's parameters, then those of the effects; the second effect of a kind is `kind(2)`.
fn parameters(found: &Discovery) -> Vec<(String, f64)> {
    let base = found.model.base;
    let mut all = vec![("b".to_owned(), base.b), ("c".to_owned(), base.c), ("f1".to_owned(), base.f1)];
    for (k, effect) in found.effects.iter().enumerate() {
        let name = effect.kind.name();
        let before = found.effects.iter().take(k).filter(|earlier| earlier.kind == effect.kind).count();
        let label = if before == 0 { name.to_owned() } else { format!("{name}({})", before + 1) };
        all.extend(effect.parameters.iter().map(|p| (format!("{label}.{}", p.symbol), p.value)));
    }
    all
}
