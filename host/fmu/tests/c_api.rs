//! The functions of the standard, called as a program in C calls them: what they give, and what they refuse.

#![allow(unsafe_code, reason = "the functions take pointers")]

use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char};
use std::fs;
use std::ptr::{null, null_mut};

use pneudrive_fmu::c_api::*;
use pneudrive_fmu::description::model_description;
use pneudrive_fmu::variable::variables;
use pneudrive_fmu::{Part, Standard, instance};
use pneudrive_sim::Rig;

const RIG: &str = "name = \"bench\"\n[load]\nmass_kg = 2.0\n[test]\nmoves = [[0.0, 9000]]\n";
const STEP: f64 = 0.0013;

thread_local! {
    /// What the log function of this test has been given.
    static LOG: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
}

unsafe extern "C" fn log(
    environment: Environment,
    status: Status,
    category: *const c_char,
    message: *const c_char,
) {
    assert_eq!((environment.addr(), status), (4711, Status::Error));
    // SAFETY: the standard has both end with a zero.
    let (category, message) = unsafe { (CStr::from_ptr(category), CStr::from_ptr(message)) };
    assert_eq!(category, c"logStatusError");
    LOG.with_borrow_mut(|log| log.push(message.to_str().expect("UTF-8").to_owned()));
}

/// The last message, which is taken away.
fn logged() -> String {
    LOG.with_borrow_mut(|log| log.pop()).expect("a message")
}

/// Resources with this rig file.
fn resources(text: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join(instance::RIG_FILE), text).expect("written");
    folder
}

fn instantiate(token: &str, resources: &str, event_mode: bool) -> Handle {
    let texts =
        [c"one".to_owned(), CString::new(token).expect("a text"), CString::new(resources).expect("a text")];
    let [name, token, resources] = texts.each_ref().map(|text| text.as_ptr());
    let environment = std::ptr::without_provenance_mut(4711);
    // SAFETY: texts end with a zero, and the log function takes what it is given.
    unsafe {
        fmi3InstantiateCoSimulation(
            name,
            token,
            resources,
            false,
            false,
            event_mode,
            false,
            null(),
            0,
            environment,
            Some(log),
            null(),
        )
    }
}

/// A part that was initialised.
fn running(part: Part) -> Handle {
    let folder = resources(RIG);
    let instance = instantiate(&part.token(RIG), folder.path().to_str().expect("UTF-8"), false);
    assert!(!instance.is_null(), "{}", logged());
    assert_eq!(fmi3EnterInitializationMode(instance, true, 1e-3, 0.0, false, 0.0), Status::Ok);
    assert_eq!(fmi3ExitInitializationMode(instance), Status::Ok);
    instance
}

/// The reference of a variable.
fn reference(part: Part, name: &str) -> u32 {
    let rig = Rig::read("bench", RIG).expect("valid");
    variables(part, &rig).iter().find(|variable| variable.name == name).expect("a variable").reference
}

fn step(instance: Handle, time: f64, step: f64) -> (Status, f64, [bool; 3]) {
    let (mut flags, mut reached) = ([true; 3], 0.0);
    let [event, end, early] = &mut flags;
    // SAFETY: the places live.
    let status = unsafe { fmi3DoStep(instance, time, step, true, event, end, early, &mut reached) };
    (status, reached, flags)
}

fn floats<const N: usize>(instance: Handle, references: [u32; N]) -> Option<[f64; N]> {
    let mut values = [0.0; N];
    // SAFETY: both arrays have N entries.
    let status = unsafe { fmi3GetFloat64(instance, references.as_ptr(), N, values.as_mut_ptr(), N) };
    (status == Status::Ok).then_some(values)
}

#[test]
fn a_plant_is_driven_and_read_with_arrays_of_each_type() {
    let plant = running(Part::Plant);
    let [command, position, home] =
        ["command_counts", "position_m", "home_switch"].map(|name| reference(Part::Plant, name));
    let counts = reference(Part::Plant, "position_counts");
    // SAFETY: arrays of one entry.
    unsafe {
        assert_eq!(fmi3SetInt32(plant, &command, 1, &800, 1), Status::Ok);
        let (mut read, mut closed) = (0, 7_u8);
        assert_eq!(fmi3GetInt32(plant, &counts, 1, &mut read, 1), Status::Ok);
        assert_eq!(fmi3GetBoolean(plant, &home, 1, &mut closed, 1), Status::Ok);
        assert_eq!((read, closed), (8192, 0));
        assert_eq!(fmi3GetFloat64(plant, null(), 0, null_mut(), 0), Status::Ok, "nothing is asked for");
    }
    let before = floats(plant, [position, 0]).expect("values");
    assert_eq!(before[1], 0.0);
    for k in 0..100 {
        assert_eq!(step(plant, f64::from(k) * STEP, STEP).0, Status::Ok);
    }
    let after = floats(plant, [position, 0]).expect("values");
    assert!(after[0] > before[0] + 1e-3, "an open valve moves it: {after:?}");
    assert_eq!(after[1], 0.13);
    assert_eq!(fmi3Terminate(plant), Status::Ok);
    fmi3FreeInstance(plant);
}

#[test]
fn a_step_tells_the_time_that_was_reached_and_asks_for_nothing() {
    let drive = running(Part::Drive);
    assert_eq!(step(drive, 0.0, 2.0 * STEP), (Status::Ok, 2.0 * STEP, [false; 3]));
    let (status, reached, _) = step(drive, 2.0 * STEP, -0.001);
    assert_eq!((status, reached), (Status::Error, 2.0 * STEP));
    assert_eq!(logged(), "a step must last more than 0 s and at most 4294967295 samples, is -0.001 s");
    // SAFETY: null may be given.
    let status =
        unsafe { fmi3DoStep(drive, 2.0 * STEP, STEP, true, null_mut(), null_mut(), null_mut(), null_mut()) };
    assert_eq!(status, Status::Ok, "an importer may not care");
    fmi3FreeInstance(drive);
}

#[test]
fn states_are_kept_replaced_restored_and_freed() {
    let drive = running(Part::Drive);
    let position = reference(Part::Drive, "position_m");
    let mut state: Handle = null_mut();
    // SAFETY: `state` lives.
    unsafe {
        assert_eq!(fmi3GetFMUState(drive, &mut state), Status::Ok);
        step(drive, 0.0, 100.0 * STEP);
        let first = floats(drive, [position]);
        assert_eq!(fmi3SetFMUState(drive, state), Status::Ok);
        step(drive, 0.0, 100.0 * STEP);
        assert_eq!(floats(drive, [position]), first);
        let same = state;
        assert_eq!(fmi3GetFMUState(drive, &mut state), Status::Ok, "in place of the first one");
        assert_eq!(state, same);
        step(drive, 100.0 * STEP, STEP);
        assert_eq!(fmi3SetFMUState(drive, state), Status::Ok);
        assert_eq!(floats(drive, [position]), first);

        let other = running(Part::Drive);
        assert_eq!(fmi3SetFMUState(other, state), Status::Error);
        assert_eq!(logged(), "this state is not one that this instance keeps");
        let mut foreign = state;
        assert_eq!(fmi3FreeFMUState(other, &mut foreign), Status::Error);
        assert_eq!(fmi3FreeFMUState(drive, &mut state), Status::Ok);
        assert!(state.is_null());
        assert_eq!(fmi3FreeFMUState(drive, &mut state), Status::Ok, "null is left alone");
        assert_eq!(fmi3SetFMUState(drive, same), Status::Error, "it was freed");
        assert_eq!(fmi3GetFMUState(drive, null_mut()), Status::Error);
        let mut wild: Handle = std::ptr::without_provenance_mut(0xdead_beef);
        assert_eq!(fmi3GetFMUState(drive, &mut wild), Status::Error, "no such state to replace");
        [drive, other].into_iter().for_each(|instance| fmi3FreeInstance(instance));
    }
}

#[test]
fn a_handle_that_is_none_is_refused_and_not_followed() {
    let freed = running(Part::Plant);
    fmi3FreeInstance(freed);
    for handle in [null_mut(), freed, std::ptr::without_provenance_mut(usize::MAX)] {
        assert_eq!(step(handle, 0.0, STEP).0, Status::Error);
        assert_eq!(floats(handle, [0]), None);
        assert_eq!(fmi3Reset(handle), Status::Error);
        fmi3FreeInstance(handle);
    }
}

#[test]
fn arrays_that_are_null_short_or_of_another_type_are_refused() {
    let plant = running(Part::Plant);
    let position = reference(Part::Plant, "position_m");
    let mut value = 0.0;
    // SAFETY: arrays have at least the entries that are read or written, or are null.
    unsafe {
        for (references, n, values, m, says) in [
            (null(), 1, &raw mut value, 1, "an array of 1 entries is null"),
            (&raw const position, 1, null_mut(), 1, "an array of 1 entries is null"),
            (&raw const position, 1, null_mut(), 0, "1 variables have as many values, not 0"),
            (&raw const position, usize::MAX, &raw mut value, 1, "is where none can be"),
        ] {
            assert_eq!(fmi3GetFloat64(plant, references, n, values, m), Status::Error);
            assert!(logged().contains(says), "{says}");
        }
        let crooked = (&raw mut value).cast::<u8>().wrapping_add(1).cast::<f64>();
        assert_eq!(fmi3GetFloat64(plant, &position, 1, crooked, 1), Status::Error);
        assert!(logged().contains("is where none can be"));
        let mut whole = 0;
        assert_eq!(fmi3GetInt32(plant, &position, 1, &mut whole, 1), Status::Error);
        assert_eq!(logged(), "position_m is a Float64, not a Int32");
        assert_eq!(fmi3GetFloat64(plant, &77_777, 1, &mut value, 1), Status::Error);
        assert_eq!(logged(), "there is no variable with the value reference 77777");
        assert_eq!(fmi3SetFloat64(plant, &position, 1, &0.1, 1), Status::Error);
        assert_eq!(logged(), "position_m cannot be set");
        assert_eq!(
            fmi3SetFloat64(plant, &reference(Part::Plant, "supply.pressure_pa"), 1, &f64::NAN, 1),
            Status::Error
        );
        assert_eq!(logged(), "supply.pressure_pa must be a finite number, is NaN");
    }
    assert_eq!(step(plant, 0.0, STEP).0, Status::Ok, "nothing of this has harmed it");
    fmi3FreeInstance(plant);
}

#[test]
fn instantiation_fails_with_the_reason_in_the_log() {
    let folder = resources(RIG);
    let here = folder.path().to_str().expect("UTF-8");
    let token = Part::Plant.token(RIG);
    for (token, resources, event_mode, says) in [
        ("{00000000-0000}", here, false, "is not of this FMU"),
        (&token[..], "/nowhere", false, "cannot read /nowhere/rig.toml"),
        (&token, here, true, "has no event mode"),
        (&Part::Plant.token("name = \"other\"\n"), here, false, "the FMU was changed by hand"),
    ] {
        assert!(instantiate(token, resources, event_mode).is_null());
        let message = logged();
        assert!(message.contains(says), "{message}");
    }
    let broken = resources("[load]\nmass_kg = \"heavy\"\n");
    let text = fs::read_to_string(broken.path().join(instance::RIG_FILE)).expect("there");
    let path = broken.path().to_str().expect("UTF-8");
    assert!(instantiate(&Part::Plant.token(&text), path, false).is_null());
    assert!(logged().contains("load.mass_kg"));
    // SAFETY: null may be given, and no log function.
    let made = unsafe {
        fmi3InstantiateCoSimulation(
            null(),
            null(),
            null(),
            false,
            false,
            false,
            false,
            null(),
            0,
            null_mut(),
            None,
            null(),
        )
    };
    assert!(made.is_null());
}

#[test]
fn what_the_description_denies_is_refused_and_logged() {
    let plant = running(Part::Plant);
    assert_eq!(fmi3EnterEventMode(plant), Status::Error);
    assert_eq!(logged(), "fmi3EnterEventMode is refused: hasEventMode is false");
    assert_eq!(fmi3GetString(plant, null(), 0, null(), 0), Status::Error);
    assert_eq!(logged(), "fmi3GetString is refused: no variable has this type");
    assert_eq!(fmi3SerializedFMUStateSize(plant, null_mut(), null()), Status::Error);
    assert!(fmi3InstantiateModelExchange(null(), null(), null(), false, false, null(), null()).is_null());
    fmi3FreeInstance(plant);
}

#[test]
fn the_description_has_each_variable_once_and_escapes_what_a_name_holds() {
    let text = RIG.replace("\"bench\"", "'a \"b\" <c> & d'");
    let rig = Rig::read("bench", &text).expect("valid");
    for part in Part::ALL {
        let xml = model_description(Standard::Fmi3, part, &rig, &text);
        assert!(xml.contains("modelName=\"a &quot;b&quot; &lt;c&gt; &amp; d, "), "{xml}");
        let all = variables(part, &rig);
        assert!(all.is_sorted_by(|one, other| one.reference < other.reference), "found by bisection");
        for variable in &all {
            for unique in [
                format!(" name=\"{}\"", variable.name),
                format!("\" valueReference=\"{}\"", variable.reference),
            ] {
                assert_eq!(xml.matches(&unique).count(), 1, "{part:?}: {unique}");
            }
        }
    }
}

#[test]
fn every_physical_value_has_its_unit_in_si() {
    let physical = |unit: &&str| !["", "counts", "samples"].contains(unit);
    for (name, text) in pneudrive_sim::rigfile::BUILTIN {
        let rig = Rig::read(name, text).expect("valid");
        for part in Part::ALL.into_iter().filter(|part| part.check(&rig).is_ok()) {
            let xml = model_description(Standard::Fmi3, part, &rig, text);
            for variable in variables(part, &rig) {
                let own = format!(" name=\"{}\" ", variable.name);
                let line = xml.lines().find(|line| line.contains(&own)).expect("a line");
                let float = variable.kind == pneudrive_fmu::signal::Kind::Float64;
                if let Some(unit) = Some(variable.unit()).filter(physical).filter(|_| float) {
                    assert!(line.contains(&format!(" unit=\"{unit}\"")), "{name}, {part:?}: {line}");
                    assert_eq!(
                        xml.matches(&format!("<Unit name=\"{unit}\"><BaseUnit ")).count(),
                        1,
                        "{unit}"
                    );
                }
            }
        }
    }
}
