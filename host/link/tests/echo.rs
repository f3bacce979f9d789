//! A line that is coupled into itself: each side hears what it says, too. Neither takes it for the other one's.

use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::id;
use pneudrive_protocol::Mode;

use crate::simulated_link::{Random, SimulatedRig, any_samples};

#[test]
fn a_change_that_is_refused_is_not_taken_as_done_for_its_own_echo() {
    let rig = SimulatedRig::with_record(&[]);
    rig.change(|simulation| simulation.echoes = true);
    let mut client = rig.connect().expect("an answer");
    let mut parameters = Parameters::default();
    parameters.set(id::VELOCITY_GAIN, 77).expect("in range");
    client.import_parameters(&parameters).expect("disarmed");
    client.reference(0).expect("disarmed");
    client.arm().expect("referenced");
    let error = client.import_parameters(&Parameters::default()).expect_err("armed");
    assert!(error.to_string().contains("disarm"), "{error:#}");
    assert_eq!(client.parameters().expect("an answer").values, parameters);
}

#[test]
fn a_record_comes_whole_and_leaves_the_drive_disarmed() {
    let samples = any_samples(&mut Random(3), 4389);
    let rig = SimulatedRig::with_record(&samples);
    rig.change(|simulation| simulation.echoes = true);
    let mut client = rig.connect().expect("an answer");
    assert_eq!(client.record(|_, _| {}).expect("a record").samples, samples);
    assert_eq!(client.status().expect("an answer").mode, Mode::Disarmed);
}
