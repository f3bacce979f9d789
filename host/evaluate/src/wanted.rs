//! Whether somebody still waits for long work.

use std::fmt;

use thiserror::Error;

/// Asked before each run of long work. Once it says no, no run is begun, and the work ends with [`CalledOff`].
#[derive(Clone, Copy)]
pub struct Wanted<'a>(&'a (dyn Fn() -> bool + Sync));

impl Wanted<'static> {
    /// Work that is never called off.
    pub const ALWAYS: Wanted<'static> = Wanted(&|| true);
}

impl<'a> Wanted<'a> {
    /// Work that is wanted as long as this says so.
    #[must_use]
    pub fn so_long(is: &'a (dyn Fn() -> bool + Sync)) -> Wanted<'a> {
        Wanted(is)
    }

    /// Whether it is now.
    #[must_use]
    pub fn now(self) -> bool {
        (self.0)()
    }

    /// Ends work that is wanted no more.
    ///
    /// # Errors
    /// When it is.
    pub fn check(self) -> Result<(), CalledOff> {
        if self.now() { Ok(()) } else { Err(CalledOff) }
    }
}

impl fmt::Debug for Wanted<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Wanted").field(&self.now()).finish()
    }
}

/// What a run that was not begun has failed of, and work that it was part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("nobody waits for it any more")]
pub struct CalledOff;
