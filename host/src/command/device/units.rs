//! The units of a rig's figures.

use anyhow::Result;
use pneudrive_link::client::Client;
use pneudrive_records::rig_info::RigParameters;
use pneudrive_records::units::Units;

/// The units for its figures; counts if the parameters of the rig cannot be read.
pub(super) fn of(client: &mut Client, counts: bool) -> Units {
    by(&client.parameters(), counts)
}

/// The same by parameters that have been read, or why they could not be.
pub(super) fn by(parameters: &Result<RigParameters>, counts: bool) -> Units {
    match parameters {
        Ok(parameters) if counts => Units::raw(parameters),
        Ok(parameters) => Units::of(parameters),
        Err(error) => {
            tell!(
                "note: figures are shown as the rig sends them, because its scales are not known: {error:#}"
            );
            Units::default()
        }
    }
}
