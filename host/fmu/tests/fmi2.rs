//! The functions of FMI 2.0 do what those of 3.0 do.

#![allow(unsafe_code, reason = "the functions take pointers")]

use std::ffi::{CStr, CString, c_char, c_int};
use std::fs;
use std::ptr::{null, null_mut, without_provenance_mut};
use std::sync::Mutex;

use pneudrive_fmu::c_api::fmi2::*;
use pneudrive_fmu::c_api::*;
use pneudrive_fmu::description::model_description;
use pneudrive_fmu::signal::{Kind, Value};
use pneudrive_fmu::variable::variables;
use pneudrive_fmu::{Instance, Part, Standard, instance};
use pneudrive_sim::Rig;

const RIG: &str = "name = \"bench\"\n[load]\nmass_kg = 2.0\n[test]\nmoves = [[0.0, 9000]]\n";
const STEP: f64 = 0.0013;
const CO_SIMULATION: c_int = 1;

/// What the log function has been given, with the name of the instance.
static LOG: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// A log function without the arguments that a format may have: these messages have none.
unsafe extern "C" fn log(
    environment: Environment,
    name: *const c_char,
    status: Status,
    category: *const c_char,
    message: *const c_char,
) {
    assert_eq!((environment.addr(), status), (4711, Status::Error));
    // SAFETY: all texts end with a zero.
    let [name, category, message] = unsafe { [name, category, message].map(|text| CStr::from_ptr(text)) };
    assert_eq!(category, c"logStatusError");
    let texts = [name, message].map(|text| text.to_str().expect("UTF-8"));
    LOG.lock().expect("no panic").push(texts.join(": "));
}

fn has_said(what: &str) -> bool {
    LOG.lock().expect("no panic").iter().any(|message| message.contains(what))
}

fn rig() -> Rig {
    Rig::read("bench", RIG).expect("valid")
}

fn instantiate(name: &str, kind: c_int, token: &str, resources: &str) -> Handle {
    let [name, token, resources] = [name, token, resources].map(|text| CString::new(text).expect("a text"));
    // SAFETY: a function with more arguments than are given to it is called as one without them in C, on all systems that
    // FMI 2.0 has a name for.
    let logger = unsafe { std::mem::transmute::<*const (), LogMessage2>(log as *const ()) };
    let callbacks = Callbacks {
        logger,
        allocate_memory: null(),
        free_memory: null(),
        step_finished: null(),
        environment: without_provenance_mut(4711),
    };
    // SAFETY: texts end with a zero, and the callbacks may be read.
    unsafe { fmi2Instantiate(name.as_ptr(), kind, token.as_ptr(), resources.as_ptr(), &callbacks, 0, 0) }
}

/// A drive that was initialised, and begins at a time.
fn running(name: &str, start: f64) -> Handle {
    let folder = tempfile::Builder::new().prefix("an fmu ").tempdir().expect("a folder");
    fs::write(folder.path().join(instance::RIG_FILE), RIG).expect("written");
    let address = format!("file://{}", folder.path().display()).replace(' ', "%20");
    let drive = instantiate(name, CO_SIMULATION, &Part::Drive.token(RIG), &address);
    assert!(!drive.is_null(), "{:?}", LOG.lock());
    assert_eq!(fmi2SetupExperiment(drive, 1, 1e-3, start, 0, 0.0), Status::Ok);
    let run_test = reference("run_test");
    // SAFETY: arrays of one entry.
    assert_eq!(unsafe { fmi2SetBoolean(drive, &run_test, 1, &1) }, Status::Ok);
    assert_eq!(fmi2EnterInitializationMode(drive), Status::Ok);
    assert_eq!(fmi2ExitInitializationMode(drive), Status::Ok);
    drive
}

fn reference(name: &str) -> u32 {
    let all = variables(Part::Drive, &rig());
    all.iter().find(|variable| variable.name == name).expect("a variable").reference
}

fn real(drive: Handle, name: &str) -> f64 {
    let mut value = f64::NAN;
    // SAFETY: arrays of one entry.
    let status = unsafe { fmi2GetReal(drive, &reference(name), 1, &mut value) };
    assert_eq!(status, Status::Ok, "{name}: {:?}", LOG.lock());
    value
}

fn integer(drive: Handle, name: &str) -> c_int {
    let mut value = c_int::MIN;
    // SAFETY: arrays of one entry.
    let status = unsafe { fmi2GetInteger(drive, &reference(name), 1, &mut value) };
    assert_eq!(status, Status::Ok, "{name}: {:?}", LOG.lock());
    value
}

#[test]
fn a_drive_is_that_of_the_newer_standard_from_sample_to_sample() {
    let drive = running("one", 2.0);
    let mut newer = Instance::new(Part::Drive, rig()).expect("a drive");
    newer.set(reference("run_test"), Kind::Boolean, Value::Switch(true)).expect("a parameter");
    newer.enter_initialisation(2.0).expect("instantiated");
    newer.exit_initialisation().expect("initialised");
    for k in 0..100 {
        let now = newer.time();
        assert_eq!(fmi2DoStep(drive, now, STEP, 1), Status::Ok, "{:?}", LOG.lock());
        newer.step(now, STEP).expect("a step");
        for name in ["time", "position_m", "pressure_1_pa"] {
            let expected = newer.get(reference(name), Kind::Float64).expect("a value");
            assert_eq!(Value::Float(real(drive, name)), expected, "{name} at sample {k}");
        }
        // 64 bits are a Real.
        for name in ["velocity_estimate", "index"] {
            let Value::Integer(expected) = newer.get(reference(name), Kind::Int64).expect("a value") else {
                panic!("{name} is whole")
            };
            assert_eq!(real(drive, name), expected as f64, "{name} at sample {k}");
        }
        let expected = newer.get(reference("command_counts"), Kind::Int32).expect("a value");
        assert_eq!(Value::Integer(integer(drive, "command_counts").into()), expected, "sample {k}");
    }
    assert_eq!(fmi2Terminate(drive), Status::Ok);
    fmi2FreeInstance(drive);
}

#[test]
fn a_state_comes_back_and_a_reset_begins_anew() {
    let drive = running("kept", 0.0);
    let steps = |from: i32| {
        (from..from + 50)
            .for_each(|k| assert_eq!(fmi2DoStep(drive, f64::from(k) * STEP, STEP, 1), Status::Ok));
        real(drive, "position_m")
    };
    let mut state = null_mut();
    steps(0);
    // SAFETY: the place lives.
    assert_eq!(unsafe { fmi2GetFMUstate(drive, &mut state) }, Status::Ok);
    let first = steps(50);
    assert_eq!(fmi2SetFMUstate(drive, state), Status::Ok);
    assert_eq!(steps(50), first);
    // SAFETY: the place lives.
    assert_eq!(unsafe { fmi2FreeFMUstate(drive, &mut state) }, Status::Ok);
    assert!(state.is_null());
    assert_eq!(fmi2Reset(drive), Status::Ok);
    assert_eq!(fmi2EnterInitializationMode(drive), Status::Ok, "it begins at 0 without being told");
    fmi2FreeInstance(drive);
}

#[test]
fn what_cannot_be_is_refused_and_logged_under_the_name_of_the_instance() {
    assert!(instantiate("exchange", 0, &Part::Drive.token(RIG), "file:///tmp").is_null());
    assert!(has_said("exchange: it is an FMU for co-simulation"));
    assert!(instantiate("path", CO_SIMULATION, &Part::Drive.token(RIG), "/tmp").is_null());
    assert!(has_said("path: fmuResourceLocation must be a file: address"));
    // SAFETY: nothing is read.
    assert!(unsafe { fmi2Instantiate(null(), CO_SIMULATION, null(), null(), null(), 0, 0) }.is_null());
    let drive = running("two", 0.0);
    // SAFETY: arrays of one entry.
    unsafe {
        assert_eq!(fmi2SetReal(drive, &reference("actuator.bore_m"), 1, &0.05), Status::Error);
        assert!(has_said("two: actuator.bore_m is fixed"));
        assert_eq!(fmi2GetInteger(drive, &reference("position_m"), 1, &mut 0), Status::Error);
        assert!(has_said("two: position_m is a Float64, not a Int32"));
        assert_eq!(fmi2GetReal(drive, null(), 1, &mut 0.0), Status::Error);
    }
    assert_eq!(fmi2DoStep(drive, 0.0, -0.001, 1), Status::Error);
    assert!(has_said("two: a step must last more than 0 s"));
    assert_eq!(fmi2GetString(drive, null(), 0, null()), Status::Error);
    assert!(has_said("two: fmi2GetString is refused: no variable is a text"));
    fmi2FreeInstance(drive);
    assert_eq!(fmi2DoStep(drive, 0.0, STEP, 1), Status::Error, "freed");
}

#[test]
fn the_description_names_variables_by_their_places() {
    for part in Part::ALL {
        let xml = model_description(Standard::Fmi2, part, &rig(), RIG);
        let outputs = variables(part, &rig());
        for (variable, place) in outputs.iter().zip(1..) {
            let name = format!(
                "<ScalarVariable name=\"{}\" valueReference=\"{}\"",
                variable.name, variable.reference
            );
            let line = xml.lines().filter(|line| line.contains("<ScalarVariable ")).nth(place - 1);
            assert!(line.is_some_and(|line| line.contains(&name)), "{part:?}: {name} at place {place}");
            let listed = xml.matches(&format!("<Unknown index=\"{place}\"")).count();
            let is_output = matches!(variable.role, pneudrive_fmu::variable::Role::Output(_));
            assert_eq!(listed, if is_output { 2 } else { 0 }, "{}", variable.name);
        }
    }
}
