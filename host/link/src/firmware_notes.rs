//! Notes on firmware that lacks something.

use pneudrive_records::parameter_names::names_of;
use pneudrive_records::rig_info::RigParameters;
use pneudrive_records::words;

use crate::client::Client;

/// Warns, before a rig is armed or moved, that it does not distinguish its boots.
pub fn report_boots(client: &Client) {
    if !client.names_its_boot() {
        log::info!("{}", words::no_boots(client.speaks(6)));
    }
}

/// Notes which parameters the rig's firmware does not have.
pub fn report_missing(parameters: &RigParameters) {
    let names = names_of(&parameters.lacking_names());
    if !names.is_empty() {
        log::info!(
            "the rig's firmware is older than this program; it has no {}, and behaves as with their defaults",
            words::few(&names)
        );
    }
}
