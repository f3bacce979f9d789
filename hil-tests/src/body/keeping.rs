//! What a drive keeps when its power fails.

use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;
use pneudrive_protocol::Mode;
use pneudrive_sim::Rig;

use super::run::{as_built_in, assert_equal_in_every_integer, rig};
use crate::Supplied;
#[cfg(unix)]
use crate::shell::Shell;

/// Starts an execution level whose power can be cut, as [`super::Start`].
pub type StartSupplied = fn(&Rig) -> Box<dyn Supplied>;

/// Writes and erases of a save are more than this.
const MIN_OPERATIONS: u64 = 20;

/// The parameters with another velocity gain.
fn with_gain(parameters: &Parameters, gain: i32) -> Parameters {
    let mut changed = parameters.clone();
    changed.set(id::VELOCITY_GAIN, gain).expect("in range");
    changed
}

/// What is in force after a reset; it must be stored and whole.
fn stored(client: &mut Client) -> Parameters {
    let state = client.config_state().expect("an answer");
    assert_eq!((state.source, state.saved, state.ignored), (1, true, 0), "stored, and in force");
    assert_eq!(client.status().expect("an answer").mode, Mode::Disarmed);
    client.parameters().expect("an answer").values
}

/// The power goes at each operation of a save in turn: after it, the drive has the old configuration or the
/// new one, whole, and the next save works.
///
/// # Panics
/// When it has not.
pub fn a_power_cut_in_a_save_leaves_the_old_or_the_new(start: StartSupplied) {
    let rig = rig("servo-b", &["test.duration_s=0.3"]);
    let mut target = start(&rig);
    let mut in_force = rig.parameters();
    target.connect().expect("a rig that answers").save_parameters().expect("disarmed");
    let (mut old_ones, mut new_ones) = (0, 0);
    for nth in 1.. {
        let new = with_gain(&in_force, 1000 + nth as i32);
        let mut client = target.connect().expect("a rig that answers");
        client.import_parameters(&new).expect("disarmed");
        target.cut_power_at(nth);
        let saved = client.save_parameters().is_ok();
        drop(client);
        target.power_up().expect("it starts again");
        let found = stored(&mut target.connect().expect("a rig that answers"));
        if saved {
            assert!(nth > MIN_OPERATIONS && found == new, "saved: {nth} is no operation of a save");
            break;
        }
        assert!(found == in_force || found == new, "{}: a mixture, cut at {nth}", target.name());
        *(if found == new { &mut new_ones } else { &mut old_ones }) += 1;
        in_force = found;
    }
    println!("{}: the old one {old_ones} times, the new one {new_ones} times", target.name());
    assert!(old_ones > 0 && new_ones > 0);
}

/// A drive comes up again with what was stored, and runs on it.
///
/// # Panics
/// When it does not.
pub fn what_is_stored_is_in_force_after_a_power_cut(start: StartSupplied) {
    let rig = rig("servo-b-tuned", &["test.duration_s=0.5", "test.moves=[[0.0, 8192], [0.1, 16384]]"]);
    let mut target = start(&rig);
    target.connect().expect("a rig that answers").save_parameters().expect("disarmed");
    target.power_up().expect("it starts again");
    assert_eq!(stored(&mut target.connect().expect("a rig that answers")), rig.parameters());
    assert_equal_in_every_integer(&*target, &rig);
}

/// A drive whose stored configuration is damaged in both slots comes up in a fault that its log names, with
/// the parameters of a drive that never had one. It says what to do and arms nothing until a configuration is
/// stored again; one that is only set does not do.
///
/// # Panics
/// When it does not.
#[cfg(unix)]
pub fn a_damaged_configuration_is_named_and_arms_nothing_before_one_is_stored(start: StartSupplied) {
    let rig = as_built_in("servo-b", &["test.duration_s=0.3"]);
    let mut target = start(&rig);
    target.power_up().expect("it starts again");
    let shell = Shell::at(target.port()).expect("the program is built");
    let as_delivered = shell.device("config get");
    for gain in [7, 8] {
        let _ = shell.device(&format!("config set velocity_gain {gain}"));
        let _ = shell.device("config save");
    }
    target.damage_configuration();
    target.power_up().expect("it starts again");
    let shell = Shell::at(target.port()).expect("the program is built");
    comes_up_in_a_named_fault(&shell, &as_delivered);
    arms_once_a_configuration_is_stored(&shell);
    assert_equal_in_every_integer(&*target, &rig);
    target.power_up().expect("it starts again");
    assert_eq!(stored(&mut target.connect().expect("a rig that answers")), rig.parameters());
}

#[cfg(unix)]
fn comes_up_in_a_named_fault(shell: &Shell, as_delivered: &str) {
    let status = shell.device("status");
    assert!(status.starts_with("mode        fault bad-configuration: the stored"), "{status}");
    let faults = shell.device("faults");
    let newest = faults.lines().next().unwrap_or_default();
    assert!(newest.contains("bad-configuration") && newest.ends_with("load one and save it"), "{faults}");
    let info = shell.device("info");
    assert!(
        info.contains("the stored parameters are damaged; import a configuration and save it\n"),
        "{info}"
    );
    assert_eq!(shell.device("config get"), as_delivered, "the saved gain is lost");
}

#[cfg(unix)]
fn arms_once_a_configuration_is_stored(shell: &Shell) {
    let refused = || shell.device_refuses("arm");
    let what_to_do = "load one (`pneudrive device config import RIG`) and save it";
    assert!(refused().contains(what_to_do), "{}", refused());
    let _ = shell.device("config import servo-b");
    assert!(refused().contains(what_to_do), "set, but not stored: {}", refused());
    let _ = shell.device("config save");
    assert!(shell.device("arm").starts_with("armed"));
    assert!(shell.device("disarm").starts_with("disarmed"));
}
