//! What parameters choose among: the words of rig files and users, each with its number, and the list of the control laws.

/// Declares words: a parameter's value is the place of one, from 0.
macro_rules! words {
    (
        $(#[$about:meta])*
        pub enum $name:ident {
            $($(#[$meaning:meta])* $variant:ident = $word:literal,)+
        }
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name {
            $($(#[$meaning])* $variant,)+
        }

        impl $name {
            /// All of them, in the order of their numbers.
            pub const ALL: &'static [$name] = &[$($name::$variant),+];
            /// Their words.
            pub const WORDS: &'static [&'static str] = &[$($word),+];

            /// The variant of a parameter's value, whose range the table has checked.
            pub(crate) fn of(value: i32) -> $name {
                let place = usize::try_from(value).unwrap_or(0);
                Self::ALL.get(place).copied().unwrap_or(Self::ALL[0])
            }

            /// Its word.
            #[must_use]
            pub const fn word(self) -> &'static str {
                match self {
                    $($name::$variant => $word,)+
                }
            }
        }
    };
}

/// The control laws, in the order of their numbers: word, file in `law/` and type, what it is.
macro_rules! laws {
    ($take:ident) => {
        $take! {
            "gain-profile" gain_profile::GainProfile, "A gain for each range of error (Appendix IX).";
            "proportional" proportional::Proportional, "One gain (thesis C(21)).";
            "moore-proportional" moore_proportional::MooreProportional, "One gain, and a step across the dead zone of the valve.";
            "on-off" on_off::OnOff, "A relay: the valve is shut or wide open.";
            "pid" pid::Pid, "PI-D on the position, with anti-windup.";
            "cascade" cascade::Cascade, "A model of the drive: observers, a trajectory, a loop of the force; nothing to tune.";
        }
    };
}

macro_rules! law_words {
    ($($word:literal $file:ident::$law:ident, $about:literal;)+) => {
        words! {
            /// How the position error becomes a demand.
            pub enum Law {
                $(#[doc = $about] $law = $word,)+
            }
        }
    };
}

pub(crate) use laws;

laws!(law_words);

words! {
    /// Where the command comes from.
    pub enum Loop {
        /// The law closes the loop over the encoder.
        Closed = "closed",
        /// Moves are commands; nothing is fed back (thesis L(3) = 0).
        Open = "open",
    }
}

words! {
    /// What a law that learns its drive begins with when it is armed.
    pub enum Adapt {
        /// What the rig file says.
        Afresh = "afresh",
        /// What the runs before have learned.
        Kept = "kept",
    }
}

words! {
    /// Where the homing run ends.
    pub enum HomingKind {
        /// At a mechanical stop.
        Stop = "stop",
        /// At the edge of a switch.
        Switch = "switch",
    }
}

words! {
    /// How the position is measured.
    pub enum EncoderKind {
        /// Edges are counted, from wherever the axis stands.
        Quadrature = "quadrature",
        /// A potentiometer on a converter.
        Potentiometer = "potentiometer",
        /// An absolute encoder with a synchronous serial interface.
        Ssi = "ssi",
    }
}

impl EncoderKind {
    /// Whether it knows the position from the start.
    #[must_use]
    pub fn is_absolute(self) -> bool {
        self != EncoderKind::Quadrature
    }
}
