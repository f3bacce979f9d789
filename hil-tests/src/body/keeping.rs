//! What a drive keeps when its power goes.

use pneudrive::client::Client;
use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::id;
use pneudrive_protocol::Mode;
use pneudrive_sim::Rig;

use super::{assert_equal_in_every_integer, rig};
use crate::Supplied;

/// Starts a rung whose power can be cut, as [`super::Start`].
pub type StartSupplied = fn(&Rig) -> Box<dyn Supplied>;

/// Writes and erases of a save are more than this.
const LEAST_OPERATIONS: u64 = 20;

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
            assert!(nth > LEAST_OPERATIONS && found == new, "saved: {nth} is no operation of a save");
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
