//! The functions of FMI 2.0 (fmi2FunctionTypes.h). They do what those of 3.0 do; other are the types of the variables, the
//! begin, and the log function.
//!
//! | type | variables |
//! |---|---|
//! | Real | Float64, and Int64 as whole numbers: an Integer has 32 bits |
//! | Integer | Int32 |
//! | Boolean | Boolean, as an int |

use std::ffi::{c_char, c_int, c_void};
use std::path::PathBuf;
use std::ptr;

use anyhow::{Context, Result, bail};
use percent_encoding::percent_decode_str;

use super::held::{Environment, Handle, Log, LogMessage2, Status, add, caught, remove, with};
use super::memory::{array, array_mut, text};
use crate::instance::Instance;
use crate::signal::{Kind, Value};

/// The number of fmi2CoSimulation.
const CO_SIMULATION: c_int = 1;

/// Whole numbers beyond this have no double of their own.
const MAX_WHOLE: f64 = 9_007_199_254_740_992.0;

/// fmi2CallbackFunctions: what the importer offers.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Callbacks {
    /// Its log function.
    pub logger: LogMessage2,
    /// Not used, as the next two.
    pub allocate_memory: *const c_void,
    /// See above.
    pub free_memory: *const c_void,
    /// See above.
    pub step_finished: *const c_void,
    /// What its log function gets back.
    pub environment: Environment,
}

/// The types are those of fmi2TypesPlatform.h.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

/// The version of the standard.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

/// Which messages the importer wants. Failures are always logged, and there are no others.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetDebugLogging(
    instance: Handle,
    _logging_on: c_int,
    _count: usize,
    _categories: *const *const c_char,
) -> Status {
    with(instance, |_| Ok(()))
}

/// Makes an instance; null if there can be none.
///
/// # Safety
/// Texts end with a zero, or are null. `callbacks` is null or may be read, and its log function may be called until the instance
/// is freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    instance_name: *const c_char,
    fmu_type: c_int,
    guid: *const c_char,
    resource_location: *const c_char,
    callbacks: *const Callbacks,
    _visible: c_int,
    _logging_on: c_int,
) -> Handle {
    // SAFETY: as this function requires.
    let name = unsafe { text(instance_name) }.unwrap_or_default();
    // SAFETY: as this function requires.
    let log = unsafe { callbacks.as_ref() }
        .map_or(Log::Nobody, |callbacks| Log::of_fmi2(callbacks.logger, callbacks.environment, name));
    let make = || -> Result<Instance> {
        if fmu_type != CO_SIMULATION {
            bail!("it is an FMU for co-simulation");
        }
        // SAFETY: as this function requires.
        let token = unsafe { text(guid) }.context("fmuGUID")?;
        // SAFETY: as this function requires.
        let resources = unsafe { text(resource_location) }.context("fmuResourceLocation")?;
        Instance::of_resources(token, &folder_of(resources)?)
    };
    match caught(make) {
        Ok(instance) => add(instance, log),
        Err(error) => {
            log.error(&format!("{error:#}"));
            ptr::null_mut()
        }
    }
}

/// The folder of an address such as `file:///tmp/fmu/resources`.
fn folder_of(address: &str) -> Result<PathBuf> {
    let path = address
        .strip_prefix("file:")
        .with_context(|| format!("fmuResourceLocation must be a file: address, is {address:?}"))?;
    // An address has a host between two slashes, which is empty here.
    let path = path.strip_prefix("//").unwrap_or(path);
    let path = percent_decode_str(path).decode_utf8().context("fmuResourceLocation")?;
    // Before the letter of a disk stands a slash that is none of the path.
    let on_disk = path.strip_prefix('/').filter(|rest| rest.as_bytes().get(1) == Some(&b':'));
    Ok(PathBuf::from(on_disk.unwrap_or(&path)))
}

/// Ends an instance; an unknown one is ignored.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2FreeInstance(instance: Handle) {
    remove(instance);
}

/// When the simulation begins. The tolerance and the end are of no matter.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetupExperiment(
    instance: Handle,
    _tolerance_defined: c_int,
    _tolerance: f64,
    start_time: f64,
    _stop_time_defined: c_int,
    _stop_time: f64,
) -> Status {
    with(instance, |instance| instance.start_at(start_time))
}

/// Begins the initialisation.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2EnterInitializationMode(instance: Handle) -> Status {
    with(instance, |instance| instance.enter_initialisation(instance.time()))
}

/// Ends the initialisation.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2ExitInitializationMode(instance: Handle) -> Status {
    with(instance, Instance::exit_initialisation)
}

/// Ends the simulation.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2Terminate(instance: Handle) -> Status {
    with(instance, Instance::terminate)
}

/// Takes the instance back to where it was when it was made.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2Reset(instance: Handle) -> Status {
    with(instance, |instance| {
        instance.reset();
        Ok(())
    })
}

/// A step of whole samples.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2DoStep(
    instance: Handle,
    current_communication_point: f64,
    communication_step_size: f64,
    _no_set_fmu_state_prior_to_current_point: c_int,
) -> Status {
    with(instance, |instance| instance.step(current_communication_point, communication_step_size))
}

/// Fills an array with the values of variables.
///
/// # Safety
/// Both arrays have this many entries, or are null; nobody else uses them meanwhile.
unsafe fn read<T>(
    instance: Handle,
    references: *const u32,
    count: usize,
    values: *mut T,
    of: impl Fn(&mut Instance, u32) -> Result<T>,
) -> Status {
    with(instance, |instance| {
        // SAFETY: as this function requires.
        let (references, values) = unsafe { (array(references, count)?, array_mut(values, count)?) };
        for (&reference, place) in references.iter().zip(values) {
            *place = of(instance, reference)?;
        }
        Ok(())
    })
}

/// Sets variables to the values of an array.
///
/// # Safety
/// Both arrays have this many entries, or are null.
unsafe fn write<T: Copy>(
    instance: Handle,
    references: *const u32,
    count: usize,
    values: *const T,
    value: impl Fn(&Instance, u32, T) -> Result<(Kind, Value)>,
) -> Status {
    with(instance, |instance| {
        // SAFETY: as this function requires.
        let (references, values) = unsafe { (array(references, count)?, array(values, count)?) };
        for (&reference, &given) in references.iter().zip(values) {
            let (kind, value) = value(instance, reference, given)?;
            instance.set(reference, kind, value)?;
        }
        Ok(())
    })
}

fn real(instance: &mut Instance, reference: u32) -> Result<f64> {
    let kind = instance.kind(reference).filter(|kind| *kind == Kind::Int64).unwrap_or(Kind::Float64);
    match instance.get(reference, kind)? {
        Value::Float(value) => Ok(value),
        Value::Integer(value) => Ok(value as f64),
        Value::Switch(_) => bail!("a switch is no Real"),
    }
}

fn integer(instance: &mut Instance, reference: u32) -> Result<c_int> {
    match instance.get(reference, Kind::Int32)? {
        Value::Integer(value) => Ok(c_int::try_from(value)?),
        other => bail!("{other} is no Integer"),
    }
}

fn boolean(instance: &mut Instance, reference: u32) -> Result<c_int> {
    Ok((instance.get(reference, Kind::Boolean)? == Value::Switch(true)).into())
}

fn of_real(instance: &Instance, reference: u32, value: f64) -> Result<(Kind, Value)> {
    if instance.kind(reference) != Some(Kind::Int64) {
        return Ok((Kind::Float64, Value::Float(value)));
    }
    if value.fract() != 0.0 || value.abs() > MAX_WHOLE {
        bail!("the variable with the value reference {reference} takes whole numbers, not {value}");
    }
    Ok((Kind::Int64, Value::Integer(value as i64)))
}

macro_rules! variables {
    ($($get:ident, $set:ident: $type:ty, $of:expr, $value:expr;)+) => {$(
        #[doc = concat!("Reads variables of the type of ", stringify!($get), ".")]
        ///
        /// # Safety
        /// Both arrays have as many entries as is said, or are null; nobody else uses them meanwhile.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $get(
            instance: Handle,
            references: *const u32,
            count: usize,
            values: *mut $type,
        ) -> Status {
            // SAFETY: as this function requires.
            unsafe { read(instance, references, count, values, $of) }
        }

        #[doc = concat!("Sets variables of the type of ", stringify!($set), ".")]
        ///
        /// # Safety
        /// Both arrays have as many entries as is said, or are null.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $set(
            instance: Handle,
            references: *const u32,
            count: usize,
            values: *const $type,
        ) -> Status {
            // SAFETY: as this function requires.
            unsafe { write(instance, references, count, values, $value) }
        }
    )+};
}

variables! {
    fmi2GetReal, fmi2SetReal: f64, real, of_real;
    fmi2GetInteger, fmi2SetInteger: c_int, integer, |_, _, value| Ok((Kind::Int32, Value::Integer(value.into())));
    fmi2GetBoolean, fmi2SetBoolean: c_int, boolean, |_, _, value| Ok((Kind::Boolean, Value::Switch(value != 0)));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_address_of_a_folder_is_its_path() {
        for (address, path) in [
            ("file:///tmp/an%20fmu/resources", "/tmp/an fmu/resources"),
            ("file:/tmp/resources", "/tmp/resources"),
            ("file:///C:/fmu/resources", "C:/fmu/resources"),
        ] {
            assert_eq!(folder_of(address).expect("an address"), PathBuf::from(path));
        }
        assert!(folder_of("/tmp/resources").expect_err("a path").to_string().contains("file: address"));
    }
}
