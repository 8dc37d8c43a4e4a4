//! The progress of a discovery, for whoever waits for it.

/// A step of a discovery.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress<'a> {
    /// The next step, in words.
    Step(&'a str),
    /// The search for the `effect`-th effect among so many candidates begins.
    Round {
        /// Which effect.
        effect: usize,
        /// Candidates that are compared.
        candidates: usize,
    },
    /// One of the round's candidates was compared.
    Compared,
}

/// A function that is called with each step of a discovery, from any thread.
pub type Watch<'a> = &'a (dyn Fn(Progress<'_>) + Sync);
