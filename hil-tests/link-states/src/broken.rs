//! What must hold in every state.

use stateright::Property;

use crate::plc::Wrong;
use crate::presence::Missed;
use crate::{Link, State};

/// A property that does not hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Broken {
    /// The drive moves at the request of a host that has not armed it or taken it over since the reset, or one of the two
    /// requests was sent before the reset.
    MovesUnarmed,
    /// The drive moves though the host that asked for it does not mean that any more.
    MovesUnmeant,
    /// The drive runs a test that the host which started it has not stated.
    RunsOthersTest,
    /// A host has a record that is of no run, or of more than one.
    OtherRecord,
    /// Parameters of two hosts are mixed, or lost.
    MixedConfiguration,
    /// After a reset or a power cut the parameters are neither those saved before nor those that were being saved.
    OtherConfiguration,
    /// The digital inputs begin a record that the PLC has not asked for.
    Inputs(Wrong),
    /// The drive takes its owner for there or gone, and it is not.
    Presence(Missed),
}

/// What is broken, and the property in words.
const PROPERTIES: [(Broken, &str); 12] = [
    (Broken::MovesUnarmed, "no move without its own host's arm"),
    (Broken::MovesUnmeant, "no move that its host does not mean"),
    (Broken::RunsOthersTest, "no run of another host's test"),
    (Broken::OtherRecord, "a record that is delivered is the one recorded"),
    (Broken::MixedConfiguration, "parameters are one host's, whole"),
    (Broken::OtherConfiguration, "the configuration is the old or the new one"),
    (Broken::Inputs(Wrong::Unasked), "no record of the inputs without a start since the last stop"),
    (Broken::Inputs(Wrong::Unacknowledged), "no record of the inputs before a stop is acknowledged"),
    (Broken::Inputs(Wrong::Other), "no record of a number that has not stayed"),
    (Broken::Presence(Missed::MovesForSilent), "no move for an owner that says nothing new"),
    (Broken::Presence(Missed::TripsForHeard), "no trip while the owner is heard"),
    (Broken::Presence(Missed::HoldsForGone), "no hold for an owner long gone"),
];

/// Whether the property in this place holds. The checker takes functions without surroundings.
fn holds<const PLACE: usize>(_: &Link, state: &State) -> bool {
    state.broken != Some(PROPERTIES[PLACE].0)
}

/// All of them.
pub fn properties() -> impl Iterator<Item = Property<Link>> {
    const CONDITIONS: [fn(&Link, &State) -> bool; 12] = [
        holds::<0>,
        holds::<1>,
        holds::<2>,
        holds::<3>,
        holds::<4>,
        holds::<5>,
        holds::<6>,
        holds::<7>,
        holds::<8>,
        holds::<9>,
        holds::<10>,
        holds::<11>,
    ];
    PROPERTIES.iter().zip(CONDITIONS).map(|((_, name), holds)| Property::always(name, holds))
}
