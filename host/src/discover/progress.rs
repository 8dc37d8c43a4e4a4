//! What a discovery is doing, for whoever waits for it.

/// What a discovery is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress<'a> {
    /// The next step, in words.
    Step(&'a str),
    /// The `effect`-th effect, counted from 1, is sought among so many candidates.
    Round {
        /// Which effect.
        effect: usize,
        /// Candidates that are compared.
        candidates: usize,
    },
    /// One of the round's candidates was compared.
    Compared,
}

/// Is told what a discovery is doing, from any thread.
pub type Watch<'a> = &'a (dyn Fn(Progress<'_>) + Sync);
