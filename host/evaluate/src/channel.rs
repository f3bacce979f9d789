//! A channel of a transient by its name, those that are derived from the position among them.

use crate::evaluation::Motion;
use crate::transient::{COMMAND, ERROR, POSITION, PRESSURES, SPOOL, Transient};

/// The channels for a graph or spectrum of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// The position.
    Position,
    /// Its velocity, as the controller estimates it.
    Velocity,
    /// Its acceleration, as the controller estimates it.
    Acceleration,
    /// The pressure in a chamber: 0 or 1.
    Pressure(usize),
    /// The spool.
    Spool,
    /// The command.
    Command,
    /// The error.
    Error,
}

impl Channel {
    /// All of them.
    pub const ALL: [Channel; 8] = [
        Channel::Position,
        Channel::Velocity,
        Channel::Acceleration,
        Channel::Pressure(0),
        Channel::Pressure(1),
        Channel::Spool,
        Channel::Command,
        Channel::Error,
    ];

    /// The channel of a name, if it is one.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Channel> {
        Channel::ALL.into_iter().find(|channel| channel.name() == name)
    }

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Channel::Position => "position",
            Channel::Velocity => "velocity",
            Channel::Acceleration => "acceleration",
            Channel::Pressure(0) => "pressure 1",
            Channel::Pressure(_) => "pressure 2",
            Channel::Spool => "spool",
            Channel::Command => "command",
            Channel::Error => "error",
        }
    }

    /// Its unit.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Channel::Position | Channel::Spool => "mm",
            Channel::Velocity => "mm/s",
            Channel::Acceleration => "mm/s^2",
            Channel::Pressure(_) => "kPa",
            Channel::Command | Channel::Error => "counts",
        }
    }

    /// Its samples, in its unit; none of a channel that the transient does not have.
    #[must_use]
    pub fn samples(self, transient: &Transient) -> Vec<f64> {
        let stored = |channel: usize| transient.channels[channel].clone();
        match self {
            Channel::Position => stored(POSITION),
            Channel::Velocity => Motion::of(transient).velocity_mm_s,
            Channel::Acceleration => Motion::of(transient).acceleration_mm_s2,
            Channel::Pressure(chamber) => stored(PRESSURES[chamber.min(1)]),
            Channel::Spool => stored(SPOOL),
            Channel::Command => stored(COMMAND),
            Channel::Error => stored(ERROR),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_channel_is_found_by_its_name_alone() {
        for channel in Channel::ALL {
            assert_eq!(Channel::of_name(channel.name()), Some(channel));
        }
        assert_eq!(Channel::of_name("steam"), None);
    }

    #[test]
    fn stored_channels_are_named_as_in_the_transient() {
        let stored = |channel: &Channel| !matches!(channel, Channel::Velocity | Channel::Acceleration);
        for channel in Channel::ALL.iter().filter(|channel| stored(channel)) {
            let named = (channel.name(), channel.unit());
            assert!(crate::transient::CHANNELS.contains(&named), "{named:?}");
        }
    }
}
