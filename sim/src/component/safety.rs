//! The supervisor's part of a rig file. What it does is in the crate `pneudrive-controller`.

use crate::key::keys;

keys! {
    POSITION_MARGIN_MM: f64 = number("safety.position_margin_mm", 3.0, 0.0, 1000.0, "", "How far outside the stroke the position may be before the supervisor trips.");
    MAX_SPEED_M_S: f64 = number("safety.max_speed_m_s", 5.0, 1e-3, 100.0, "", "A faster step of the encoder trips the supervisor.");
    HOST_SILENCE_S: f64 = number("safety.host_silence_s", 0.5, 0.0, 3600.0, "", "Silence of the host that trips a running move or homing run; 0: off.");
    HOLD_S: f64 = number("safety.hold_s", 60.0, 0.0, 3600.0, "", "Time after the loss of its host at which an enabled drive that is armed or holds its last setpoint is disarmed.");
    INPUT_DEBOUNCE_S: f64 = number("safety.input_debounce_s", 0.01, 0.001, 1.0, "", "Digital inputs count once all of them have been the same for so long.");
    INPUT_SETTLING_S: f64 = number("safety.input_settling_s", 0.02, 0.001, 1.0, "", "A start begins its record once start and number have stayed for so long behind it.");
    SENSOR_WATCH: bool = switch("safety.sensor_watch", true, "", "Whether a pressure within a 64th of the range of an end of its converter trips, if no pressure of the drive can be there.");
    NO_MOTION_S: f64 = number("safety.no_motion_s", 0.5, 0.0, 3600.0, "", "A closed loop that opens half of the valve or more and moves nothing for so long trips; with less of the valve it takes longer; 0: off.");
    END_MIN_MM: Option<f64> = optional_number("safety.end_min_mm", -1000.0, 20_000.0, "closed loop: 0; open loop: none", "", "Software end position: a closed loop refuses lower setpoints, an open loop pushes no further.");
    END_MAX_MM: Option<f64> = optional_number("safety.end_max_mm", -1000.0, 20_000.0, "closed loop: the stroke; open loop: none", "", "The other software end position.");
    LATE_OUTPUT_US: i64 = integer("safety.late_output_us", 100, 1, 100_000, "", "An output that is later than this is not driven and trips the supervisor; less than the time from it to the next sample, by default at most half of it.");
    LATE_SAMPLE_US: i64 = integer("safety.late_sample_us", 100, 1, 100_000, "", "A sample later than this trips the supervisor; less than the period, by default at most half of it.");
}
