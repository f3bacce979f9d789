//! The units of a rig's figures.

use pneudrive_link::client::Client;
use pneudrive_records::units::Units;

/// The units for its figures; counts if the parameters of the rig cannot be read.
pub(super) fn of(client: &mut Client, counts: bool) -> Units {
    match client.parameters() {
        Ok(parameters) if counts => Units::raw(&parameters),
        Ok(parameters) => Units::of(&parameters),
        Err(error) => {
            tell!(
                "note: figures are shown as the rig sends them, because its scales are not known: {error:#}"
            );
            Units::default()
        }
    }
}
