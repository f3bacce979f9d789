//! Getting and setting variables, of the types that there are.

use anyhow::{Result, bail};

use super::held::{Handle, Status, with};
use super::memory::{array, array_mut};
use crate::signal::{Kind, Value};

/// All variables are scalars.
fn as_many(references: &[u32], values: usize) -> Result<()> {
    if references.len() != values {
        bail!("{} variables have as many values, not {values}", references.len());
    }
    Ok(())
}

macro_rules! variables {
    ($($get:ident, $set:ident: $type:ty, $kind:ident, $variant:ident($value:ident), $out:expr, $in:expr;)+) => {$(
        #[doc = concat!("Reads variables of the type ", stringify!($kind), ".")]
        ///
        /// # Safety
        /// Each array has as many entries as its count says, or is null; nobody else uses them meanwhile.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $get(
            instance: Handle,
            value_references: *const u32,
            n_value_references: usize,
            values: *mut $type,
            n_values: usize,
        ) -> Status {
            with(instance, |instance| {
                // SAFETY: as this function requires.
                let references = unsafe { array(value_references, n_value_references)? };
                // SAFETY: as this function requires.
                let values = unsafe { array_mut(values, n_values)? };
                as_many(references, values.len())?;
                for (&reference, place) in references.iter().zip(values) {
                    if let Value::$variant($value) = instance.get(reference, Kind::$kind)? {
                        *place = $out;
                    }
                }
                Ok(())
            })
        }

        #[doc = concat!("Sets variables of the type ", stringify!($kind), ".")]
        ///
        /// # Safety
        /// Each array has as many entries as its count says, or is null.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $set(
            instance: Handle,
            value_references: *const u32,
            n_value_references: usize,
            values: *const $type,
            n_values: usize,
        ) -> Status {
            with(instance, |instance| {
                // SAFETY: as this function requires.
                let references = unsafe { array(value_references, n_value_references)? };
                // SAFETY: as this function requires.
                let values = unsafe { array(values, n_values)? };
                as_many(references, values.len())?;
                for (&reference, &$value) in references.iter().zip(values) {
                    instance.set(reference, Kind::$kind, Value::$variant($in))?;
                }
                Ok(())
            })
        }
    )+};
}

variables! {
    fmi3GetFloat64, fmi3SetFloat64: f64, Float64, Float(value), value, value;
    fmi3GetInt32, fmi3SetInt32: i32, Int32, Integer(value), i32::try_from(value)?, value.into();
    fmi3GetInt64, fmi3SetInt64: i64, Int64, Integer(value), value, value;
    // A bool with another value than 0 and 1 is invalid, so the importer's value is taken as a byte.
    fmi3GetBoolean, fmi3SetBoolean: u8, Boolean, Switch(value), value.into(), value != 0;
}
