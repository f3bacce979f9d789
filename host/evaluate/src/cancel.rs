//! The token by which a caller cancels long work.

use std::fmt;

use thiserror::Error;

/// The work checks it before each run. Once it is cancelled, no run is begun, and the work ends with [`Cancelled`].
#[derive(Clone, Copy)]
pub struct CancelToken<'a>(&'a (dyn Fn() -> bool + Sync));

impl CancelToken<'static> {
    /// The token of work that is never cancelled.
    pub const NEVER: CancelToken<'static> = CancelToken(&|| true);
}

impl<'a> CancelToken<'a> {
    /// A token that is cancelled once this is false.
    #[must_use]
    pub fn cancelled_unless(is: &'a (dyn Fn() -> bool + Sync)) -> CancelToken<'a> {
        CancelToken(is)
    }

    /// Whether the work may go on.
    #[must_use]
    pub fn is_live(self) -> bool {
        (self.0)()
    }

    /// Ends cancelled work.
    ///
    /// # Errors
    /// When the token is cancelled.
    pub fn check(self) -> Result<(), Cancelled> {
        if self.is_live() { Ok(()) } else { Err(Cancelled) }
    }
}

impl fmt::Debug for CancelToken<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("CancelToken").field(&self.is_live()).finish()
    }
}

/// The failure of a run that was not begun, and of the work that it was part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("nobody waits for it any more")]
pub struct Cancelled;
