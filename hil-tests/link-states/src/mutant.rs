//! Defects that are planted, to see that the checker finds them: each changes what reaches the real firmware, or what
//! the host makes of its answers.

/// A planted defect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mutant {
    /// The rig takes every host for the one that owns the drive.
    IgnoresOwner,
    /// The rig starts whatever test it has, whatever the start names.
    IgnoresNameOfStart,
    /// The rig saves a configuration value by value.
    SavesInParts,
    /// The rig sends chunks of whatever record it has, and the host does not look at the CRC-32 of the whole.
    IgnoresNameOfRecord,
    /// The rig takes requests that were meant for another boot.
    IgnoresBoot,
    /// The rig swallows a stop while a fault is acknowledged.
    SwallowsStop,
    /// The rig reads the number as a start goes on, and not what becomes of it.
    ReadsNumberAtOnce,
    /// The rig takes a copy of its owner's request for a sign of life.
    HearsCopies,
    /// The rig does not look how long its owner is silent.
    NeverMissesHost,
}
