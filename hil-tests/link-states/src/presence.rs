//! For how long the owner of the drive has said nothing new, and what becomes of a drive without it.

/// A time that passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Time {
    /// Half of the silence after which an owner is gone, and a bit.
    Half,
    /// All of it.
    Silence,
    /// As long as a drive holds for an owner that is gone, beyond that silence.
    Hold,
}

/// The default of the parameters, ms.
const HOST_SILENCE_MS: u64 = 500;
/// The default of the parameters, ms.
const HOLD_MS: u64 = 60_000;

impl Time {
    /// How long it is, ms.
    #[must_use]
    pub fn ms(self) -> u64 {
        match self {
            Time::Half => HOST_SILENCE_MS / 2 + 1,
            Time::Silence => HOST_SILENCE_MS + 1,
            Time::Hold => HOST_SILENCE_MS + HOLD_MS + 1,
        }
    }

    fn halves(self) -> u8 {
        if self == Time::Half { 1 } else { 2 }
    }
}

/// The owner as the model knows it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Presence {
    /// The newest number that came from it.
    newest: u16,
    /// Halves of the silence since then, up to 2.
    halves: u8,
    /// For a mutant: by how much the numbers are off that it takes copies for.
    pub(crate) ahead: u16,
}

/// What is wrong with a drive after a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Missed {
    /// It moves for an owner that has said nothing new.
    MovesForSilent,
    /// It trips though its owner has said something new in time.
    TripsForHeard,
    /// It is enabled though its owner is long gone.
    HoldsForGone,
}

impl Presence {
    /// The host of a request with this number has become the owner.
    #[must_use]
    pub fn of(newest: u16) -> Presence {
        Presence { newest, ..Presence::default() }
    }

    /// A request of the owner has come: a new one, or a copy.
    pub fn hears(&mut self, number: u16) {
        if number.wrapping_sub(self.newest).cast_signed() > 0 {
            (self.newest, self.halves) = (number, 0);
        }
    }

    /// The newest number.
    #[must_use]
    pub fn newest(&self) -> u16 {
        self.newest
    }

    /// Whether it has said nothing new for longer than the silence after which an owner is gone.
    #[must_use]
    pub fn is_silent(&self) -> bool {
        self.halves == 2
    }

    /// A time passes.
    pub fn passes(&mut self, time: Time) {
        self.halves = 2.min(self.halves + time.halves());
    }
}
