//! Whether somebody still waits for long work.

use std::fmt;

/// Asked before each run of long work. Once it says no, no run is begun, and the work ends without a result.
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
}

impl fmt::Debug for Wanted<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Wanted").field(&self.now()).finish()
    }
}

/// What a run that was not begun has failed of.
pub const CALLED_OFF: &str = "nobody waits for it any more";
