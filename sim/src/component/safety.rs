//! The supervisor's part of a rig file. What it does is in the crate `pneudrive-controller`, whose table of parameters has most
//! of its keys.

use pneudrive_controller::parameter_table;

use crate::component::controller::Law;
use crate::component::controller::keys::LAW;
use crate::key::keys;

/// Declares what is not a parameter by itself, behind the lines of the controller's table.
macro_rules! keys_of_safety {
    (controller $others:tt safety $parameters:tt $($other:tt)+) => {
        keys! {
            $parameters
            POSITION_MARGIN_MM: f64 = number("safety.position_margin_mm", 3.0, 0.0, 1000.0, "", "How far outside the stroke the position may be before the supervisor trips.");
            MAX_SPEED_M_S: f64 = number("safety.max_speed_m_s", 5.0, 1e-3, 100.0, "", "A faster step of the encoder trips the supervisor.");
            SENSOR_WATCH: bool = switch("safety.sensor_watch", true, "", "Whether a pressure within a 64th of the range of an end of its converter trips, if no pressure of the drive can be there.");
            END_MIN_MM: Option<f64> = optional_number("safety.end_min_mm", -1000.0, 20_000.0, "closed loop: 0; open loop: none", "", "Lower soft limit: a closed loop refuses lower setpoints, an open loop pushes no further.");
            END_MAX_MM: Option<f64> = optional_number("safety.end_max_mm", -1000.0, 20_000.0, "closed loop: the stroke; open loop: none", "", "The upper soft limit.");
        }
    };
}

parameter_table!(keys_of_safety);
