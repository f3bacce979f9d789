//! What a search minimises.

/// The cost of a candidate.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cost {
    /// Its mean cost; for one that was given up, the cost on its checked variants over the number of all.
    pub mean: f64,
    /// Which variant put it above its limit.
    pub given_up_at: Option<usize>,
    pub runs: usize,
}
