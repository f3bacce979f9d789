//! A PC and a rig of different versions: what works goes on, what does not is refused by name.

use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::{TABLE, id};
use pneudrive_protocol::{ReplyBody, Request, RequestBody, RequestRefusal, VERSION};
use pneudrive_records::target::TargetFile;

use crate::simulated_link::{self, Random, SimulatedRig, Simulation, any_samples};

fn info(version: u16) -> ReplyBody<'static> {
    let (firmware, build, board) = ("pneudrive 0.0.9", "b", "a board");
    ReplyBody::Info { version, firmware, build, board, record_capacity: 4389 }
}

fn of_the_version_before(request: &Request<'_>) -> Option<ReplyBody<'static>> {
    (request.body == RequestBody::Info).then(|| info(VERSION - 1))
}

fn of_the_next_version(request: &Request<'_>) -> Option<ReplyBody<'static>> {
    (request.body == RequestBody::Info).then(|| info(VERSION + 1))
}

#[test]
fn a_rig_of_another_version_is_refused_with_what_to_update() {
    for (firmware, expected) in [
        (
            of_the_version_before as simulated_link::Other,
            "version 0 of the protocol, this program version 1; flash",
        ),
        (
            of_the_next_version,
            "version 2 of the protocol, this program version 1; use a later version of this program",
        ),
    ] {
        let rig = SimulatedRig::with_record(&[]).with_firmware(firmware);
        let error = rig.connect().err().expect("it does not understand the rest").to_string();
        assert!(error.contains(expected), "{error}");
    }
}

/// The last parameter but the gain profile that a firmware has which lacks some.
const LAST: u16 = id::HOMING_SWITCH;

/// A firmware of this version that has not all that was appended since.
fn lacks_some(request: &Request<'_>) -> Option<ReplyBody<'static>> {
    let refused = match request.body {
        RequestBody::ConfigGet { first_id, count } => {
            let mut ids = first_id..first_id + u16::from(count);
            let id = ids.find(|id| (LAST + 1..id::GAIN_PROFILE).contains(id))?;
            RequestRefusal::UnknownParameter { id }
        }
        RequestBody::Io => RequestRefusal::Unknown,
        _ => return None,
    };
    Some(ReplyBody::Refused(refused))
}

#[test]
fn parameters_that_a_firmware_does_not_have_are_told_and_the_others_are_read_and_written() {
    let rig = SimulatedRig::with_record(&[]).with_firmware(lacks_some);
    let mut client = rig.connect().expect("an answer");
    let on_rig = client.parameters().expect("those that it has");
    let lacking = TABLE.iter().filter(|p| p.id > LAST && p.len == 1);
    assert_eq!(on_rig.lacking_names(), lacking.map(|p| p.name).collect::<Vec<_>>());
    let mut parameters = Parameters::default();
    parameters.set(id::VELOCITY_GAIN, 77).expect("in range");
    assert_eq!(client.import_parameters(&parameters).expect("it has that one"), on_rig.lacking_names());
    assert_eq!(client.parameters().expect("again").values.get(id::VELOCITY_GAIN), Some(77));
}

#[test]
fn the_file_of_a_record_names_the_parameters_that_the_firmware_has() {
    let samples = any_samples(&mut Random(7), 1000);
    let mut client =
        SimulatedRig::with_record(&samples).with_firmware(lacks_some).connect().expect("an answer");
    let (info, parameters) =
        (client.info().expect("an answer"), client.parameters().expect("those that it has"));
    let record = client.record(|_, _| {}).expect("a record");
    assert_eq!(record.samples, samples);
    let file = TargetFile::new(&record, &info, &parameters).expect("counted");
    assert_eq!(file.get("param.period_us"), Some("1300"));
    assert_eq!(file.get(&format!("param.{}", parameters.lacking_names()[0])), None);
    assert_eq!(TargetFile::from_text(&file.to_text()).expect("whole"), file);
}

#[test]
fn parameters_are_changed_all_or_none() {
    let mut client = SimulatedRig::with_record(&[]).connect().expect("an answer");
    client
        .change_parameters(&[(id::VELOCITY_GAIN, 77), (id::ACCELERATION_GAIN, 3), (id::HOLD_MS, 900)])
        .expect("disarmed");
    let error = client.change_parameters(&[(id::VELOCITY_GAIN, 78), (id::SCALE, 0)]).expect_err("no scale");
    assert!(error.to_string().contains("controller.scale = 0 is out of range"), "{error}");
    let values = client.parameters().expect("an answer").values;
    let read = [id::VELOCITY_GAIN, id::ACCELERATION_GAIN, id::HOLD_MS, id::SCALE].map(|id| values.get(id));
    assert_eq!(read, [Some(77), Some(3), Some(900), Parameters::default().get(id::SCALE)]);
}

#[test]
fn an_import_that_would_leave_out_a_value_is_refused_before_anything_is_changed() {
    let rig = SimulatedRig::with_record(&[]).with_firmware(lacks_some);
    let mut client = rig.connect().expect("an answer");
    let mut parameters = Parameters::default();
    parameters.set(id::VELOCITY_GAIN, 77).expect("in range");
    parameters.set(id::HOLD_MS, 5000).expect("in range");
    let error = client.import_parameters(&parameters).expect_err("it would hold for longer").to_string();
    assert!(
        error.contains("its firmware has no parameter safety.hold_s, which should be 5 (default 60)"),
        "{error}"
    );
    let unchanged = client.parameters().expect("read").values.get(id::VELOCITY_GAIN);
    assert_eq!(unchanged, Parameters::default().get(id::VELOCITY_GAIN));
}

#[test]
fn a_request_that_a_firmware_does_not_know_is_refused_with_what_to_do() {
    let rig = SimulatedRig::with_record(&[]).with_firmware(lacks_some);
    let error = rig.connect().expect("an answer").io().expect_err("not known").to_string();
    assert!(error.contains("does not know this request; flash"), "{error}");
}

#[test]
fn what_was_meant_for_a_rig_before_its_reset_is_refused_by_name_and_a_new_connection_goes_on() {
    let rig = SimulatedRig::with_record(&[]);
    rig.change(|simulation| simulation.board.store.boot = 3);
    let mut client = rig.connect().expect("an answer");
    assert!(client.names_its_boot());
    client.arm().expect("disarmed");
    rig.change(Simulation::reset);
    for error in
        [client.arm().map(drop), client.set_parameters(id::VELOCITY_GAIN, &[7]), client.save_parameters()]
    {
        let error = error.expect_err("of another boot").to_string();
        assert!(error.contains("the rig was reset since this program connected (boot 4 now)"), "{error}");
    }
    client.disarm().expect("whoever may disarm, may in any boot");
    client.status().expect("reading goes on");
    rig.connect().expect("an answer").arm().expect("it means this boot");
}
