//! What is measured of a law, held against motions whose figures are known.

mod beside;
mod draws;
mod judged;
mod soak;

use pneudrive_design::six_drives::rig_file_of;
use pneudrive_sim::Rig;

/// One of the six drives, with settings.
fn drive(name: &str, settings: &[&str]) -> Rig {
    let text = rig_file_of(name).expect("one of the six");
    let settings: Vec<String> = settings.iter().map(|&setting| setting.to_owned()).collect();
    Rig::read_with(name, &text, &settings).unwrap_or_else(|problems| panic!("{problems}"))
}
