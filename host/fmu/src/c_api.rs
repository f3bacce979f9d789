//! The functions of the standard (FMI 3.0, fmi3FunctionTypes.h), by which other programs use an FMU; [`fmi2`] has those of
//! FMI 2.0.
//!
//! No pointer that comes back from an importer is followed: an instance and a kept state are numbers in the form of a
//! pointer, and an unknown number is refused. Unsafe are only the access to the importer's arrays and texts, and the
//! call of its log function. Nothing unwinds into the importer: a panic is caught, logged, and fails the instance.

#![allow(unsafe_code, reason = "arrays, texts and a function of another program")]

pub mod fmi2;
mod held;
mod memory;
mod states;
mod unsupported;
mod variables;

use std::ffi::{c_char, c_void};
use std::path::Path;
use std::ptr;

use anyhow::{Context, Result, bail};

use crate::instance::Instance;
use held::{Log, add, caught, remove, with};
use memory::{put, text};

pub use held::{Environment, Handle, LogMessage, LogMessage2, Status};
pub use states::*;
pub use unsupported::*;
pub use variables::*;

/// The version of the standard.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// Which messages the importer wants. Failures are always logged, and there are no others.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3SetDebugLogging(
    instance: Handle,
    _logging_on: bool,
    _count: usize,
    _categories: *const *const c_char,
) -> Status {
    with(instance, |_| Ok(()))
}

/// Makes an instance; null if there can be none.
///
/// # Safety
/// Texts end with a zero, or are null. `log_message` is null or may be called until the instance is freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    _instance_name: *const c_char,
    instantiation_token: *const c_char,
    resource_path: *const c_char,
    _visible: bool,
    _logging_on: bool,
    event_mode_used: bool,
    _early_return_allowed: bool,
    _required_intermediate_variables: *const u32,
    _n_required_intermediate_variables: usize,
    environment: Environment,
    log_message: LogMessage,
    _intermediate_update: *const c_void,
) -> Handle {
    let log = Log::of_fmi3(log_message, environment);
    let make = || -> Result<Instance> {
        if event_mode_used {
            bail!("the FMU has no event mode (hasEventMode is false)");
        }
        // SAFETY: as this function requires.
        let token = unsafe { text(instantiation_token) }.context("instantiationToken")?;
        // SAFETY: as this function requires.
        let resources = unsafe { text(resource_path) }.context("resourcePath")?;
        Instance::of_resources(token, Path::new(resources))
    };
    match caught(make) {
        Ok(instance) => add(instance, log),
        Err(error) => {
            log.error(&format!("{error:#}"));
            ptr::null_mut()
        }
    }
}

/// Ends an instance; an unknown one is ignored.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3FreeInstance(instance: Handle) {
    remove(instance);
}

/// Begins the initialisation. The tolerance and the end are of no matter: a run is as exact as `pneudrive simulate`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3EnterInitializationMode(
    instance: Handle,
    _tolerance_defined: bool,
    _tolerance: f64,
    start_time: f64,
    _stop_time_defined: bool,
    _stop_time: f64,
) -> Status {
    with(instance, |instance| instance.enter_initialisation(start_time))
}

/// Ends the initialisation.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3ExitInitializationMode(instance: Handle) -> Status {
    with(instance, Instance::exit_initialisation)
}

/// Ends the simulation.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3Terminate(instance: Handle) -> Status {
    with(instance, Instance::terminate)
}

/// Takes the instance back to where it was when it was made.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3Reset(instance: Handle) -> Status {
    with(instance, |instance| {
        instance.reset();
        Ok(())
    })
}

/// A step of whole samples.
///
/// # Safety
/// The pointers are null or may be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DoStep(
    instance: Handle,
    current_communication_point: f64,
    communication_step_size: f64,
    _no_set_fmu_state_prior_to_current_point: bool,
    event_handling_needed: *mut bool,
    terminate_simulation: *mut bool,
    early_return: *mut bool,
    last_successful_time: *mut f64,
) -> Status {
    with(instance, |instance| {
        let done = instance.step(current_communication_point, communication_step_size);
        let nothing = [event_handling_needed, terminate_simulation, early_return];
        // SAFETY: as this function requires.
        unsafe {
            nothing.into_iter().for_each(|flag| put(flag, false));
            put(last_successful_time, instance.time());
        }
        done
    })
}
