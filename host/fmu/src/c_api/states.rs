//! States that are kept: the same functions in both versions of the standard.

use std::ptr;

use anyhow::Context;

use super::held::{Handle, Status, with};

macro_rules! states {
    ($($get:ident, $set:ident, $free:ident;)+) => {$(
        /// Keeps the present state: under a new number where `state` points to null, else in place of the state there.
        ///
        /// # Safety
        /// `state` is null or may be read and written.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $get(instance: Handle, state: *mut Handle) -> Status {
            with(instance, |instance| {
                // SAFETY: as this function requires.
                let place = unsafe { state.as_mut() }.context("FMUState is null")?;
                match place.addr() {
                    0 => *place = ptr::without_provenance_mut(instance.keep()),
                    number => instance.keep_as(number)?,
                }
                Ok(())
            })
        }

        /// Goes back to a state that this instance has kept.
        #[unsafe(no_mangle)]
        pub extern "C" fn $set(instance: Handle, state: Handle) -> Status {
            with(instance, |instance| instance.restore(state.addr()))
        }

        /// Keeps a state no longer, and sets it to null; null is left alone.
        ///
        /// # Safety
        /// `state` is null or may be read and written.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $free(instance: Handle, state: *mut Handle) -> Status {
            with(instance, |instance| {
                // SAFETY: as this function requires.
                let Some(place) = (unsafe { state.as_mut() }).filter(|place| !place.is_null()) else {
                    return Ok(());
                };
                instance.forget(place.addr())?;
                *place = ptr::null_mut();
                Ok(())
            })
        }
    )+};
}

states! {
    fmi2GetFMUstate, fmi2SetFMUstate, fmi2FreeFMUstate;
    fmi3GetFMUState, fmi3SetFMUState, fmi3FreeFMUState;
}
