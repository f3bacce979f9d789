//! The kind of method that the present stretch needs.
//!
//! An explicit method may not step farther than about 3 over the fastest rate of decay, however little
//! happens. A right-hand side that goes with the root of a state (a flow through an
//! orifice) decays with no bound near its zero. Where step after step ends at that
//! bound, or moves the state by no more than a few errors, the implicit method takes over, until its own
//! steps are no longer than three times the bound and grow no more.

/// h times the rate of decay at which explicit steps end (Dormand-Prince: 3.3, Merson: 3.5).
const BOUND: f64 = 3.0;

/// The same where steps crawl: rejected ones keep them below the bound.
const CRAWLING_BOUND: f64 = 1.5;

/// A step that moves no state by more than this many allowed errors is not short because of the error: an accurate
/// step moves it by thousands.
const IDLE: f64 = 30.0;

/// This many steps at the bound, without [`CALM`] others in a row, are a stiff stretch.
const STIFF: u32 = 30;
const CALM: u32 = 6;

/// An implicit step costs three explicit ones.
const WORTH: f64 = 3.0 * BOUND;

/// An implicit step that is to grow by more than this has not yet the size that it can have.
const GROWING: f64 = 1.25;

/// The verdict on the present stretch.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Stiffness {
    pub implicit: bool,
    at_bound: u32,
    others: u32,
}

impl Stiffness {
    /// Takes an accepted step into account: h times the rate of decay that it met, how far it moved the state in allowed
    /// errors, the next h over h, and whether such steps take too long. Tells whether the method changes.
    #[inline]
    pub fn note(&mut self, rate: f64, moved: f64, growth: f64, crawls: bool) -> bool {
        let before = self.implicit;
        let bound = if crawls { CRAWLING_BOUND } else { BOUND };
        if self.implicit {
            if rate < WORTH && moved > IDLE && growth < GROWING {
                *self = Stiffness::default();
            }
        } else if rate > bound || moved < IDLE {
            (self.at_bound, self.others) = (self.at_bound + 1, 0);
            if self.at_bound >= STIFF {
                *self = Stiffness { implicit: true, ..Stiffness::default() };
            }
        } else {
            self.others += 1;
            if self.others >= CALM {
                *self = Stiffness::default();
            }
        }
        self.implicit != before
    }
}
