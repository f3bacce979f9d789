//! The functions that modelDescription.xml rules out: other types, events, clocks, derivatives, other kinds of FMU,
//! and states as bytes. Importers look for all functions of the standard, so these exist and refuse.

use std::ffi::c_void;
use std::ptr;

use anyhow::bail;

use super::held::{Handle, Status, with};

/// A pointer that is not followed.
type Any = *const c_void;

macro_rules! refused {
    ($($why:literal: $($name:ident($($type:ty),*))+;)+) => {$($(
        #[doc = concat!("Refuses: ", $why, ".")]
        #[unsafe(no_mangle)]
        pub extern "C" fn $name(instance: Handle, $(_: $type),*) -> Status {
            with(instance, |_| bail!(concat!(stringify!($name), " is refused: ", $why)))
        }
    )+)+};
}

refused! {
    "no variable has this type":
        fmi3GetFloat32(Any, usize, Any, usize)
        fmi3SetFloat32(Any, usize, Any, usize)
        fmi3GetInt8(Any, usize, Any, usize)
        fmi3SetInt8(Any, usize, Any, usize)
        fmi3GetUInt8(Any, usize, Any, usize)
        fmi3SetUInt8(Any, usize, Any, usize)
        fmi3GetInt16(Any, usize, Any, usize)
        fmi3SetInt16(Any, usize, Any, usize)
        fmi3GetUInt16(Any, usize, Any, usize)
        fmi3SetUInt16(Any, usize, Any, usize)
        fmi3GetUInt32(Any, usize, Any, usize)
        fmi3SetUInt32(Any, usize, Any, usize)
        fmi3GetUInt64(Any, usize, Any, usize)
        fmi3SetUInt64(Any, usize, Any, usize)
        fmi3GetString(Any, usize, Any, usize)
        fmi3SetString(Any, usize, Any, usize)
        fmi3GetBinary(Any, usize, Any, Any, usize)
        fmi3SetBinary(Any, usize, Any, Any, usize)
        fmi3GetClock(Any, usize, Any)
        fmi3SetClock(Any, usize, Any);
    "no variable is a text":
        fmi2GetString(Any, usize, Any)
        fmi2SetString(Any, usize, Any);
    "no step is still under way when fmi2DoStep returns":
        fmi2CancelStep()
        fmi2GetStatus(i32, Any)
        fmi2GetRealStatus(i32, Any)
        fmi2GetIntegerStatus(i32, Any)
        fmi2GetBooleanStatus(i32, Any)
        fmi2GetStringStatus(i32, Any);
    "there are no clocks":
        fmi3GetIntervalDecimal(Any, usize, Any, Any)
        fmi3GetIntervalFraction(Any, usize, Any, Any, Any)
        fmi3GetShiftDecimal(Any, usize, Any)
        fmi3GetShiftFraction(Any, usize, Any, Any)
        fmi3SetIntervalDecimal(Any, usize, Any)
        fmi3SetIntervalFraction(Any, usize, Any, Any)
        fmi3SetShiftDecimal(Any, usize, Any)
        fmi3SetShiftFraction(Any, usize, Any, Any)
        fmi3ActivateModelPartition(u32, f64);
    "hasEventMode is false":
        fmi3EnterEventMode()
        fmi3EnterStepMode()
        fmi3EvaluateDiscreteStates()
        fmi3UpdateDiscreteStates(Any, Any, Any, Any, Any, Any);
    "there is no structural parameter":
        fmi3EnterConfigurationMode()
        fmi3ExitConfigurationMode();
    "canSerializeFMUState is false":
        fmi3SerializedFMUStateSize(Handle, Any)
        fmi3SerializeFMUState(Handle, Any, usize)
        fmi3DeserializeFMUState(Any, usize, Any)
        fmi2SerializedFMUstateSize(Handle, Any)
        fmi2SerializeFMUstate(Handle, Any, usize)
        fmi2DeSerializeFMUstate(Any, usize, Any);
    "no derivatives are provided":
        fmi3GetDirectionalDerivative(Any, usize, Any, usize, Any, usize, Any, usize)
        fmi3GetAdjointDerivative(Any, usize, Any, usize, Any, usize, Any, usize)
        fmi3GetOutputDerivatives(Any, usize, Any, Any, usize)
        fmi2GetDirectionalDerivative(Any, usize, Any, usize, Any, Any)
        fmi2SetRealInputDerivatives(Any, usize, Any, Any)
        fmi2GetRealOutputDerivatives(Any, usize, Any, Any);
    "dependencies are in modelDescription.xml":
        fmi3GetNumberOfVariableDependencies(u32, Any)
        fmi3GetVariableDependencies(u32, Any, Any, Any, Any, usize);
    "it is an FMU for co-simulation":
        fmi3EnterContinuousTimeMode()
        fmi3CompletedIntegratorStep(bool, Any, Any)
        fmi3SetTime(f64)
        fmi3SetContinuousStates(Any, usize)
        fmi3GetContinuousStateDerivatives(Any, usize)
        fmi3GetEventIndicators(Any, usize)
        fmi3GetContinuousStates(Any, usize)
        fmi3GetNominalsOfContinuousStates(Any, usize)
        fmi3GetNumberOfEventIndicators(Any)
        fmi3GetNumberOfContinuousStates(Any);
}

/// There is no model exchange: null.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3InstantiateModelExchange(
    _instance_name: Any,
    _instantiation_token: Any,
    _resource_path: Any,
    _visible: bool,
    _logging_on: bool,
    _environment: Any,
    _log_message: Any,
) -> Handle {
    ptr::null_mut()
}

/// There is no scheduled execution: null.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3InstantiateScheduledExecution(
    _instance_name: Any,
    _instantiation_token: Any,
    _resource_path: Any,
    _visible: bool,
    _logging_on: bool,
    _environment: Any,
    _log_message: Any,
    _clock_update: Any,
    _lock_preemption: Any,
    _unlock_preemption: Any,
) -> Handle {
    ptr::null_mut()
}
