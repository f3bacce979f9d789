//! Notes on firmware that lacks something.

use pneudrive_controller::Fault;
use pneudrive_link::client::Client;
use pneudrive_protocol::io::input;
use pneudrive_records::parameter_names::names_of;
use pneudrive_records::rig_info::RigParameters;
use pneudrive_records::words;

/// Warns, before a rig is armed or moved, that it does not distinguish its boots.
pub fn report_boots(client: &Client) {
    if !client.names_its_boot() {
        log::info!("{}", words::no_boots());
    }
}

/// Warns, once a drive is armed, of checks that are switched off.
pub(crate) fn report_armed(off: &[Fault]) {
    if !off.is_empty() {
        let names: Vec<&str> = off.iter().map(|check| words::fault_name(*check)).collect();
        log::warn!("the drive is armed, and will never trip with: {}", names.join(", "));
    }
}

/// Says that the run input of an armed drive is off, and may be none. The drive is armed even if it cannot be asked.
pub(crate) fn report_run_input(client: &mut Client) {
    match client.io() {
        Ok(io) if io.inputs & input::RUN == 0 => log::info!(
            "the digital input run is off: if it was never on since the board's reset, it does not stop what is armed here"
        ),
        Ok(_) => {}
        Err(error) => {
            log::warn!("the drive is armed; whether its run input stops it is not known: {error:#}")
        }
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
