//! The lines of the table: a parameter is one of them.
//!
//! ```text
//! id CONSTANT "name" "unit" [smallest, largest, default] (key) "name in the thesis" "What it is." [only Law Law];
//! ```
//!
//! The section is the table of a rig file that has the keys of its parameters. What stands for `key`:
//!
//! | key | in a rig file |
//! |---|---|
//! | `(Whole)` | a whole number, under the parameter's own name |
//! | `(KEY "name" Scaled(3))` | a number in a unit 10^3 times as large: s for ms; the constant of its key |
//! | `(KEY "name" Switch)`, `(Words(Law))` | true or false; the words of a type, in the order of their values |
//! | `("table.name" ...)` | section `components`: a key that a component of the drive declares, with ranges of its own |
//! | `()` | section `device`: none; it is computed from several keys, or set on the device alone |
//!
//! `only` names the laws that use a parameter. Ids are stored and sent: they never change and are never used again.

/// Hands the lines of the table to a macro: the controller makes [`TABLE`](crate::parameters::TABLE) of them, the
/// simulator its keys of rig files.
#[macro_export]
macro_rules! parameter_table {
    ($take:ident) => {
        $take! {
            controller {
                 4 LAW "law" "" [0, LAW_MAX, 0] (Words(Law)) "L(22), L(8)" "How the position error becomes a demand. The variable dead band gain of 6.3.3 has no equation there; dead_band_counts, or zeros at the head of gain_profile, give a fixed one.";
                 3 OPEN_LOOP "open_loop" "" [0, 1, 0] (LOOP "loop" Words(Loop)) "L(3)" "Open: moves are valve commands, nothing is fed back.";
                 1 PERIOD_US "period_us" "us" [100, 100_000, 1300] (PERIOD_S "period_s" Scaled(6)) "C(41)" "Sample period; whole microseconds.";
                 2 DELAY_US "delay_us" "us" [1, 99_999, 500] (DELAY_S "delay_s" Scaled(6)) "C(26)" "From a sample to its output; whole microseconds, less than the period.";
                 5 PROFILE_SPAN_COUNTS "profile_span_counts" "counts" [1, 65_535, 4] (Whole) "L(67)" "Range of error that one entry of the gain profile covers." only GainProfile;
                 6 PROPORTIONAL_GAIN "proportional_gain" "" [0, GAIN_MAX, 1] (Whole) "C(21)" "Gain of the laws without a profile.";
                65 INTEGRAL_GAIN "integral_gain" "" [0, GAIN_MAX, 0] (Whole) "" "Gain on the sum of the errors at the samples, in 256ths; 0: off." only Pid;
                66 INTEGRAL_BAND_COUNTS "integral_band_counts" "counts" [0, COUNT_MAX, 0] (Whole) "" "Errors beyond it are not summed; 0: all are." only Pid;
                31 DEAD_ZONE_COUNTS "dead_zone_counts" "counts" [0, COMMAND_MAX, 102] (Whole) "" "Moore's law adds it in the direction of the error: what takes the spool across its dead zone. 102 for the DAC, 4 steps for the stepper: 0.05 mm, half of the hysteresis C(29)." only MooreProportional;
                 7 VELOCITY_GAIN "velocity_gain" "" [0, GAIN_MAX, 1] (Whole) "C(43)" "Gain on counts per velocity window; the thesis's 1 gives no damping, about 1000 does.";
                 8 ACCELERATION_GAIN "acceleration_gain" "" [0, GAIN_MAX, 1] (Whole) "C(44)" "Gain on counts per velocity and acceleration window.";
                57 VELOCITY_FEED_FORWARD "velocity_feed_forward" "" [0, GAIN_MAX, 0] (Whole) "" "Gain on the setpoint's own counts per velocity window while a profile moves it; as much as velocity_gain takes the damping off that motion.";
                58 ACCELERATION_FEED_FORWARD "acceleration_feed_forward" "" [0, GAIN_MAX, 0] (Whole) "" "Gain on the setpoint's own counts per velocity and acceleration window while a profile moves it.";
                 9 VELOCITY_WINDOW_SAMPLES "velocity_window_samples" "samples" [1, WINDOW_MAX, 5] (Whole) "L(52)" "Samples over which the velocity is a difference of counts.";
                10 ACCELERATION_WINDOW_SAMPLES "acceleration_window_samples" "samples" [1, WINDOW_MAX, 3] (Whole) "L(77)" "Samples over which the acceleration is a difference of velocities.";
                11 VELOCITY_DEAD_BAND "velocity_dead_band" "counts/window" [0, COUNT_MAX, 0] (Whole) "C(45)" "Velocities below it, in counts per velocity window, count as standstill; 0: off.";
                13 SCALE "scale" "" [1, COUNT_MAX, 256] (Whole) "L(68)" "The law's sum is divided by it: 256 for the DAC, 65536 for the stepper.";
                12 DEAD_BAND_COUNTS "dead_band_counts" "counts" [0, COUNT_MAX, 0] (Whole) "C(27)" "Errors below it ask for nothing; 0: off. For the on-off law the dead zone of its relay.";
                32 RELAY_HYSTERESIS_COUNTS "relay_hysteresis_counts" "counts" [0, COUNT_MAX, 0] (Whole) "" "The relay of the on-off law drops out this much below dead_band_counts, at which it picks up." only OnOff;
                14 NULL_OFFSET_COUNTS "null_offset_counts" "counts" [-COMMAND_MAX, COMMAND_MAX, 0] (Whole) "8.2.3" "Command at which the valve is at its null; added to the demand.";
                37 FORCED_EXIT_US "forced_exit_us" "us" [1000, TIME_MAX, 1_420_000] (FORCED_EXIT_S "forced_exit_s" Scaled(6)) "C(31)" "Time for each of test.targets.";
                38 ON_ARRIVAL "on_arrival" "" [0, 1, 0] (EXIT_ON_DEAD_BAND "exit_on_dead_band" Switch) "L(11)" "Whether a target also ends when it has arrived: tolerance_counts, monitoring_s, dwell_s; with test.targets.";
               128 ADAPT "adapt" "" [0, 1, 0] (Words(Adapt)) "8.4, 9.3" "What the law begins with at each arming: what the rig file says, or what the runs before have learned of load and valve." only Cascade;
                34 TOLERANCE_COUNTS "tolerance_counts" "counts" [0, COUNT_MAX, 8] (Whole) "C(27)" "A move has arrived inside this error; without it that of dead_band_counts, if there is one.";
                35 MONITORING_US "monitoring_us" "us" [0, TIME_MAX, 0] (MONITORING_S "monitoring_s" Scaled(6)) "" "Exact stop: time inside the tolerance after which a move has arrived. 0: fast stop, at the first sample inside.";
                36 DWELL_US "dwell_us" "us" [0, TIME_MAX, 0] (DWELL_S "dwell_s" Scaled(6)) "" "From the arrival at a target to the next one.";
                46 HOMING_SWITCH "homing_switch" "" [0, 1, 0] (HOMING "homing" Words(HomingKind)) "" "Where a homing run ends: against a stop, or at the edge of a switch.";
                47 HOMING_COMMAND_COUNTS "homing_command_counts" "counts" [-COMMAND_MAX, COMMAND_MAX, -200] (Whole) "" "Valve command of the homing run, not 0; its sign is the direction. -200 for the DAC, -4 for the stepper.";
                48 HOMING_POSITION_COUNTS "homing_position_counts" "counts" [-COUNT_MAX, COUNT_MAX, 0] (Whole) "" "The position where the homing run ends.";
                56 HOMING_BACK_OFF_COUNTS "homing_back_off_counts" "counts" [1, COUNT_MAX, 400] (Whole) "" "A homing run goes so far back from where it has found its stop or switch, and must find it again at the same place.";
                49 HOMING_STILL_MS "homing_still_ms" "ms" [1, HOUR_MS, 500] (HOMING_STILL_S "homing_still_s" Scaled(3)) "" "Standing still for so long is being at the stop.";
                50 HOMING_TIMEOUT_MS "homing_timeout_ms" "ms" [1, HOUR_MS, 10_000] (HOMING_TIMEOUT_S "homing_timeout_s" Scaled(3)) "" "A longer homing run trips.";
            }
            safety {
                19 HOST_SILENCE_MS "host_silence_ms" "ms" [0, HOUR_MS, 500] (HOST_SILENCE_S "host_silence_s" Scaled(3)) "" "Silence of the host that trips a running move or homing run; 0: off.";
                54 HOLD_MS "hold_ms" "ms" [0, HOUR_MS, 60_000] (HOLD_S "hold_s" Scaled(3)) "" "Time after the loss of its host at which an enabled drive that is armed or holds its last setpoint is disarmed.";
                63 INPUT_DEBOUNCE_MS "input_debounce_ms" "ms" [1, SECOND_MS, 10] (INPUT_DEBOUNCE_S "input_debounce_s" Scaled(3)) "" "Digital inputs count once all of them have been the same for so long.";
                64 INPUT_SETTLING_MS "input_settling_ms" "ms" [1, SECOND_MS, 20] (INPUT_SETTLING_S "input_settling_s" Scaled(3)) "" "A start begins its record once start and number have stayed for so long behind it.";
                45 NO_MOTION_MS "no_motion_ms" "ms" [0, HOUR_MS, 500] (NO_MOTION_S "no_motion_s" Scaled(3)) "" "A closed loop that opens half of the valve or more and moves nothing for so long trips; with less of the valve it takes longer; 0: off.";
               110 MODEL_BOUND_MS "model_bound_ms" "ms" [0, HOUR_MS, 500] (MODEL_BOUND_S "model_bound_s" Scaled(3)) "" "Mass, standing force or lag of the valve at the bound of what the law can learn for so long, in motion, trips: the drive is not what its rig file says. By default 2.7 times the longest of sound drives; 0: off." only Cascade;
               111 PRESSURE_DOUBT_MS "pressure_doubt_ms" "ms" [0, HOUR_MS, 5] (PRESSURE_DOUBT_S "pressure_doubt_s" Scaled(3)) "" "Pressures that contradict the flow of the valve for so long trip, as do one that jumps and one that stands still while the other does not; 0: none of the three does." only Cascade;
                55 LATE_OUTPUT_US "late_output_us" "us" [1, 100_000, 100] (Whole) "" "An output that is later than this is not driven and trips the supervisor; less than the time from it to the next sample, by default at most half of it.";
                18 LATE_SAMPLE_US "late_sample_us" "us" [1, 100_000, 100] (Whole) "" "A sample later than this trips the supervisor; less than the period, by default at most half of it.";
            }
            components {
                22 ENCODER_INVERTED "encoder_inverted" "" [0, 1, 0] ("encoder.polarity" Polarity) "" "1: the encoder counts down when the rod extends.";
                23 ENCODER_PM_PER_COUNT "encoder_pm_per_count" "pm" [1, i32::MAX, 12_050_000] ("encoder.mm_per_count" Scaled(9)) "C(42)" "Stroke per encoder count.";
                24 SENSOR_BITS "sensor_bits" "bits" [8, 15, 12] ("sensors.bits" Whole) "" "Width of the converter of the pressure and spool sensors.";
                25 PRESSURE_MIN_PA "pressure_min_pa" "Pa" [0, i32::MAX, 0] ("sensors.pressure_min_pa" Whole) "" "Absolute pressure at raw 0.";
                26 PRESSURE_MAX_PA "pressure_max_pa" "Pa" [1, i32::MAX, 1_000_000] ("sensors.pressure_max_pa" Whole) "" "Absolute pressure at full scale.";
                27 SPOOL_MIN_NM "spool_min_nm" "nm" [i32::MIN, i32::MAX, -1_250_000] ("sensors.spool_min_mm" Scaled(6)) "" "Spool displacement at raw 0.";
                28 SPOOL_MAX_NM "spool_max_nm" "nm" [i32::MIN, i32::MAX, 1_250_000] ("sensors.spool_max_mm" Scaled(6)) "" "Spool displacement at full scale.";
                30 MAX_STEPS "max_steps" "steps" [1, COMMAND_MAX, 40] ("operator.max_steps" Whole) "L(20)" "Furthest location of a stepper from mid-travel.";
               109 MAX_COMMAND_COUNTS "max_command_counts" "counts" [1, COMMAND_MAX, COMMAND_MAX] ("operator.max_command_counts" Whole) "" "Largest command of a converter to either side. A board arms only if its converter of 12 bits has a code for it: with null_code 2048 up to 2047.";
                51 PULSE_WIDTH_US "pulse_width_us" "us" [1, 1000, 10] ("operator.pulse_width_us" Whole) "" "Length of a stepper's pulse.";
                52 DIRECTION_SETUP_US "direction_setup_us" "us" [1, 1000, 10] ("operator.direction_setup_us" Whole) "" "A stepper's direction stands so long before the pulse.";
                59 ENCODER_MODEL "encoder_model" "" [0, ENCODER_MAX, 0] ("encoder.model" Words(EncoderKind)) "" "0: quadrature. 1: potentiometer. 2: SSI. The last two need no homing.";
                61 PRESSURE_SENSORS "pressure_sensors" "" [0, 1, 1] ("sensors.pressure" Switch) "" "1: both pressures are measured. 0: none is; their inputs trip nothing and are recorded as 0.";
            }
            device {
                15 POSITION_MIN_COUNTS "position_min_counts" "counts" [-COUNT_MAX, COUNT_MAX, -249] () "" "Below it the supervisor trips.";
                16 POSITION_MAX_COUNTS "position_max_counts" "counts" [-COUNT_MAX, COUNT_MAX, 25_145] () "" "Above it the supervisor trips.";
                17 ENCODER_STEP_COUNTS "encoder_step_counts" "counts" [1, COUNT_MAX, 540] () "" "A longer step in one sample trips the supervisor.";
                20 NULL_CODE "null_code" "" [0, CODE_MAX, 2048] () "" "Code of the converter at which the valve is at its null.";
                21 OUTPUT_INVERTED "output_inverted" "" [0, 1, 0] () "" "1: a larger code retracts.";
                29 STEPPER "stepper" "" [0, 1, 0] () "L(22)" "0: a DAC drives the valve. 1: a stepper does.";
                33 PRESSURE_FEEDBACK_GAIN "pressure_feedback_gain" "" [0, GAIN_MAX, 775] () "C(68)" "Gain of the on-off law on the raw quasi-transient pressure difference.";
                39 LEARNING_GAIN "learning_gain" "" [0, GAIN_MAX, 0] () "8.2.3" "How much of the error at rest goes into the null offset; 0: nothing is learned, 1: the thesis.";
                40 END_MIN_COUNTS "end_min_counts" "counts" [-COUNT_MAX, COUNT_MAX, 0] () "" "Lower soft limit: a closed loop refuses lower setpoints, an open loop pushes no further.";
                41 END_MAX_COUNTS "end_max_counts" "counts" [-COUNT_MAX, COUNT_MAX, 24_896] () "" "The upper soft limit.";
                42 SENSOR_LOW_RAW "sensor_low_raw" "" [-1, RAW_MAX, 63] () "" "A pressure at or below it is that of an open sensor and trips; -1: off.";
                43 SENSOR_HIGH_RAW "sensor_high_raw" "" [1, RAW_MAX, 4032] () "" "A pressure at or above it is that of a shorted sensor and trips; 32767: off.";
                44 SENSOR_SAMPLES "sensor_samples" "samples" [1, 10_000, 4] () "" "Samples on end that a pressure must stay there to trip.";
                53 NO_MOTION_COUNTS "no_motion_counts" "counts" [0, COUNT_MAX, 40] () "" "So far from where it stood an axis has moved, for no_motion_ms and homing_still_ms: a stop gives way a little, and dither shakes.";
                60 ENCODER_ZERO_COUNTS "encoder_zero_counts" "counts" [-COUNT_MAX, COUNT_MAX, 0] () "" "The position at count 0 of an absolute encoder.";
                62 PRESSURE_DAMPING_GAIN "pressure_damping_gain" "" [0, GAIN_MAX, 0] () "9.1.2" "Gain of the laws but the on-off one on the raw quasi-transient pressure difference; 0: off.";
                67 CASCADE_STROKE "cascade_stroke" "counts" [0, LENGTH_MAX, 0] () "" "Of the law cascade: stroke; 0: the law has no model of its drive." only Cascade;
                68 CASCADE_DEAD_LENGTH_1 "cascade_dead_length_1" "counts" [16, LENGTH_MAX, 1000] () "" "Of the law cascade: dead volume of chamber 1 over its area." only Cascade;
                69 CASCADE_DEAD_LENGTH_2 "cascade_dead_length_2" "counts" [16, LENGTH_MAX, 1000] () "" "Of the law cascade: dead volume of chamber 2 over its area." only Cascade;
                70 CASCADE_PRESSURE_OFFSET "cascade_pressure_offset" "" [-UNIT, UNIT, 0] () "" "Of the law cascade: pressure at raw 0, in 2^-24 of the supply." only Cascade;
                71 CASCADE_PRESSURE_GAIN "cascade_pressure_gain" "" [1, UNIT, 262_144] () "" "Of the law cascade: pressure of a raw count, in 2^-30 of the supply." only Cascade;
                72 CASCADE_EXHAUST_PRESSURE "cascade_exhaust_pressure" "" [UNIT / 256, UNIT, UNIT / 7] () "" "Of the law cascade: pressure of the exhaust, in 2^-24 of the supply." only Cascade;
                73 CASCADE_AREA_RATIO "cascade_area_ratio" "" [UNIT / 16, UNIT, UNIT] () "" "Of the law cascade: area of chamber 2, in 2^-24 of that of chamber 1." only Cascade;
                74 CASCADE_EXPONENT "cascade_exponent" "" [65_536, 131_072, 91_750] () "" "Of the law cascade: ratio of the heat capacities, in 2^-16." only Cascade;
                75 CASCADE_FLOW_SUPPLY "cascade_flow_supply" "counts" [64, FLOW_MAX, 65_536] () "" "Of the law cascade: the open path from the supply; the law's file says how it is scaled, in 2^-16." only Cascade;
                76 CASCADE_FLOW_EXHAUST "cascade_flow_exhaust" "counts" [64, FLOW_MAX, 65_536] () "" "Of the law cascade: the open path to the exhaust, as that from the supply." only Cascade;
                77 CASCADE_STEEPNESS_SUPPLY "cascade_steepness_supply" "" [65_536, 1_048_576, 93_623] () "" "Of the law cascade: 1/(1 - b) of the path from the supply, in 2^-16." only Cascade;
                78 CASCADE_STEEPNESS_EXHAUST "cascade_steepness_exhaust" "" [65_536, 1_048_576, 93_623] () "" "Of the law cascade: 1/(1 - b) of the path to the exhaust, in 2^-16." only Cascade;
                79 CASCADE_LEAKAGE "cascade_leakage" "" [0, 32_768, 0] () "" "Of the law cascade: conductance of a shut path, in 2^-16 of that of the open one." only Cascade;
                80 CASCADE_ACCELERATION "cascade_acceleration" "counts" [2048, ACCELERATION_MAX, 65_536] () "" "Of the law cascade: what the supply on area 1 accelerates the mass by, counts per sample squared, in 2^-16." only Cascade;
                81 CASCADE_COULOMB_EXTEND "cascade_coulomb_extend" "" [0, UNIT, 0] () "" "Of the law cascade: friction in motion, extending, in 2^-24 of the supply on area 1." only Cascade;
                82 CASCADE_COULOMB_RETRACT "cascade_coulomb_retract" "" [0, UNIT, 0] () "" "Of the law cascade: friction in motion, retracting, in 2^-24 of the supply on area 1." only Cascade;
                83 CASCADE_STICTION "cascade_stiction" "" [0, UNIT, 0] () "" "Of the law cascade: the smaller of both static frictions, in 2^-24 of the supply on area 1." only Cascade;
                84 CASCADE_VISCOUS "cascade_viscous" "" [0, 1_073_741_824, 0] () "" "Of the law cascade: viscous friction at a count per sample, in 2^-30 of the supply on area 1." only Cascade;
                85 CASCADE_WEIGHT "cascade_weight" "" [-UNIT, UNIT, 0] () "" "Of the law cascade: weight against extension, in 2^-24 of the supply on area 1." only Cascade;
                86 CASCADE_STANDING_FORCE "cascade_standing_force" "" [-UNIT, UNIT, 0] () "" "Of the law cascade: constant force against extension, in 2^-24 of the supply on area 1." only Cascade;
                87 CASCADE_DEAD_TIME "cascade_dead_time" "samples" [32_768, 4_194_304, 131_072] () "" "Of the law cascade: from a sample to what it does to the flow, in 2^-16 samples." only Cascade;
                88 CASCADE_FORCE_POLE "cascade_force_pole" "" [64, 65_536, 16_384] () "" "Of the law cascade: pole of the force loop, in 2^-16 a sample." only Cascade;
                89 CASCADE_POSITION_POLE "cascade_position_pole" "" [64, 65_536, 6_554] () "" "Of the law cascade: double pole of the position loop, in 2^-16 a sample." only Cascade;
                90 CASCADE_MOTION_DECAY "cascade_motion_decay" "" [0, 1_057_094_999, 724_000_000] () "" "Of the law cascade: what is left of an error of the motion observer a sample later, in 2^-30." only Cascade;
                91 CASCADE_FLOW_DECAY "cascade_flow_decay" "" [0, 1_067_885_825, 940_000_000] () "" "Of the law cascade: what is left of an error of the flow observer a sample later, in 2^-30." only Cascade;
                92 CASCADE_SPOOL_OUTPUT_PLACE "cascade_spool_output_place" "" [-DECAY, DECAY, 0] () "" "Of the law cascade: spool at the output by that at the sample, both from the command, in 2^-30." only Cascade;
                93 CASCADE_SPOOL_OUTPUT_SPEED "cascade_spool_output_speed" "" [-DECAY, DECAY, 0] () "" "Of the law cascade: spool at the output by its speed at the sample, in 2^-30." only Cascade;
                94 CASCADE_SPOOL_OUTPUT_PULL "cascade_spool_output_pull" "" [-PULL_MAX, PULL_MAX, 0] () "" "Of the law cascade: speed of the spool at the output by its place at the sample, in 2^-28." only Cascade;
                95 CASCADE_SPOOL_OUTPUT_COAST "cascade_spool_output_coast" "" [-DECAY, DECAY, 0] () "" "Of the law cascade: speed of the spool at the output by that at the sample, in 2^-30." only Cascade;
                96 CASCADE_SPOOL_SAMPLE_PLACE "cascade_spool_sample_place" "" [-DECAY, DECAY, 0] () "" "Of the law cascade: spool at the next sample by that at the output, both from the command, in 2^-30." only Cascade;
                97 CASCADE_SPOOL_SAMPLE_SPEED "cascade_spool_sample_speed" "" [-DECAY, DECAY, 0] () "" "Of the law cascade: spool at the next sample by its speed at the output, in 2^-30." only Cascade;
                98 CASCADE_SPOOL_SAMPLE_PULL "cascade_spool_sample_pull" "" [-PULL_MAX, PULL_MAX, 0] () "" "Of the law cascade: speed of the spool at the next sample by its place at the output, in 2^-28." only Cascade;
                99 CASCADE_SPOOL_SAMPLE_COAST "cascade_spool_sample_coast" "" [-DECAY, DECAY, 0] () "" "Of the law cascade: speed of the spool at the next sample by that at the output, in 2^-30." only Cascade;
               100 CASCADE_SPOOL_LAG "cascade_spool_lag" "samples" [0, 4_194_304, 65_536] () "" "Of the law cascade: lag of the spool behind its command, in 2^-16 samples." only Cascade;
               101 CASCADE_OUTPUT_SHARE "cascade_output_share" "" [0, 65_536, 26_214] () "" "Of the law cascade: part of a period from the sample to the output, in 2^-16." only Cascade;
               102 CASCADE_OVERLAP "cascade_overlap" "counts" [-SPOOL_MAX, SPOOL_MAX, 0] () "" "Of the law cascade: command at which a path opens, in 2^-16 counts." only Cascade;
               103 CASCADE_SPAN "cascade_span" "counts" [65_536, SPOOL_MAX, SPOOL_MAX] () "" "Of the law cascade: command from there to the open path, in 2^-16 counts." only Cascade;
               104 CASCADE_PLAY "cascade_play" "counts" [0, SPOOL_MAX, 0] () "" "Of the law cascade: half the width of the spool's hysteresis, in 2^-16 counts of command." only Cascade;
               105 CASCADE_WAY_SPEED "cascade_way_speed" "counts/sample" [64, ACCELERATION_MAX, 65_536] () "" "Of the law cascade: largest speed of its own trajectories, in 2^-16." only Cascade;
               106 CASCADE_WAY_ACCELERATION "cascade_way_acceleration" "counts/sample^2" [1, ACCELERATION_MAX, 65_536] () "" "Of the law cascade: largest acceleration of its own trajectories, in 2^-16." only Cascade;
               107 CASCADE_WAY_FLOW "cascade_way_flow" "" [655, 65_536, 26_214] () "" "Of the law cascade: part of the flow that the largest jerk of its own trajectories may ask for, in 2^-16." only Cascade;
               108 CASCADE_LEARNING_NOISE "cascade_learning_noise" "" [0, UNIT, 0] () "" "Of the law cascade: noise of a force, for what is learned of the load, in 2^-24 of the supply on area 1; 0: nothing is learned." only Cascade;
               112 CASCADE_SENSOR_DECAY "cascade_sensor_decay" "" [0, DECAY, 0] () "" "Of the law cascade: what sensors with a lag have still to show of a pressure a sample later, in 2^-30." only Cascade;
               113 CASCADE_SENSOR_GAIN "cascade_sensor_gain" "" [0, DECAY, 0] () "" "Of the law cascade: what they have still to show of a change during that sample, in 2^-30; 0: they have no lag." only Cascade;
               114 CASCADE_SPOOL_OFFSET "cascade_spool_offset" "counts" [-PULL_MAX, PULL_MAX, 0] () "" "Of the law cascade: place of a measured spool at raw 0, in 2^-16 counts of command." only Cascade;
               115 CASCADE_SPOOL_GAIN "cascade_spool_gain" "counts" [-PULL_MAX, PULL_MAX, 0] () "" "Of the law cascade: place of a measured spool by a raw count, in 2^-24 counts of command; 0: the spool is not measured, and has no friction." only Cascade;
               116 CASCADE_SPOOL_FIRST_WAY "cascade_spool_first_way" "" [-PULL_MAX, PULL_MAX, 0] () "" "Of the law cascade: pull of the coil in the first of two samples that move the spool by a count, in 2^-24 counts." only Cascade;
               117 CASCADE_SPOOL_FIRST_SPEED "cascade_spool_first_speed" "" [-PULL_MAX, PULL_MAX, 0] () "" "Of the law cascade: the same to stop it from a count per sample." only Cascade;
               118 CASCADE_SPOOL_SECOND_WAY "cascade_spool_second_way" "" [-PULL_MAX, PULL_MAX, 0] () "" "Of the law cascade: pull of the coil in the second of them that moves the spool by a count, in 2^-24 counts." only Cascade;
               119 CASCADE_SPOOL_SECOND_SPEED "cascade_spool_second_speed" "" [-PULL_MAX, PULL_MAX, 0] () "" "Of the law cascade: the same to stop it from a count per sample." only Cascade;
               120 CASCADE_SPOOL_STICTION "cascade_spool_stiction" "counts" [0, SPOOL_MAX, 0] () "" "Of the law cascade: static friction of a measured spool over its spring, in 2^-16 counts of command." only Cascade;
               121 CASCADE_SPOOL_FRICTION "cascade_spool_friction" "counts" [0, SPOOL_MAX, 0] () "" "Of the law cascade: its friction in motion over its spring, in 2^-16 counts of command." only Cascade;
               122 CASCADE_PORT "cascade_port" "counts" [0, SPOOL_MAX, 0] () "" "Of the law cascade: command at which a land is as wide as its port, in 2^-16 counts; 0: the conductance is in proportion to the opening." only Cascade;
               123 CASCADE_CLEARANCE "cascade_clearance" "counts" [0, SPOOL_MAX, 0] () "" "Of the law cascade: clearance between spool and sleeve before a port, in 2^-16 counts of command." only Cascade;
               124 CASCADE_TUBE_SUPPLY_CHOKED "cascade_tube_supply_choked" "" [0, SPOOL_MAX, 0] () "" "Of the law cascade: open path from the supply over the flow of its tubes into a vacuum, in 2^-16." only Cascade;
               125 CASCADE_TUBE_SUPPLY_SLIGHT "cascade_tube_supply_slight" "" [0, SPOOL_MAX, 0] () "" "Of the law cascade: open path from the supply over the flow of its tubes by a part of the pressure, in 2^-16; 0: there are none." only Cascade;
               126 CASCADE_TUBE_EXHAUST_CHOKED "cascade_tube_exhaust_choked" "" [0, SPOOL_MAX, 0] () "" "Of the law cascade: open path to the exhaust over the flow of its tube from a high pressure, in 2^-16." only Cascade;
               127 CASCADE_TUBE_EXHAUST_SLIGHT "cascade_tube_exhaust_slight" "" [0, SPOOL_MAX, 0] () "" "Of the law cascade: open path to the exhaust over the flow of its tube by a part of the pressure, in 2^-16; 0: there is none." only Cascade;
               129 KEPT_MASS "kept_mass" "" [16_384, 163_840, 65_536] () "" "Kept of what the law cascade has learned: moved mass over that of the rig file, in 2^-16." only Cascade;
               130 KEPT_FRICTION "kept_friction" "" [19_661, 131_072, 65_536] () "" "Kept of what the law cascade has learned: friction in motion over that of the rig file, in 2^-16." only Cascade;
               131 KEPT_FORCE "kept_force" "" [-134_217_728, 134_217_728, 0] () "" "Kept of what the law cascade has learned: constant force against extension beyond that of the rig file, in 2^-24 of the stiction." only Cascade;
               132 KEPT_VISCOUS "kept_viscous" "" [-16_777_216, 67_108_864, 0] () "" "Kept of what the law cascade has learned: what viscous friction is larger by than in the rig file, in 2^-24 of that." only Cascade;
               133 KEPT_PACE "kept_pace" "" [32_768, 196_608, 65_536] () "" "Kept of what the law cascade has learned: lag of the valve over that of the rig file, in 2^-16." only Cascade;
               134 KEPT_LOOSENESS "kept_looseness" "" [0, 4, 0] () "" "Kept of what the law cascade has learned: how often the distance at which the load may rest was doubled." only Cascade;
               135 KEPT_ARMINGS "kept_armings" "" [0, 65_535, 0] () "" "Armings that have carried on what the law cascade has learned." only Cascade;
               136 KEPT_AT_BOUND "kept_at_bound" "" [0, 3, 0] () "" "Runs in a row that ended with something at the bound of what the law cascade can learn." only Cascade;
               137 KEPT_CHANGED "kept_changed" "" [0, 3, 0] () "" "Why the law cascade began afresh of late. 0: it did not. 1: what it learned stayed at a bound. 2: a run found another drive than the one before. 3: a run tripped." only Cascade;
            }
        }
    };
}
