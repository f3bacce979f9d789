//! A drive at a port, and the files of other programs.

use super::Field;

/// Of `run`.
pub(super) const RUN: &[Field] = fields! {
    "rig": "text", "whose test was run";
    "ended_by": "text", "`the test` or `Ctrl-C`, which stands for SIGTERM and SIGHUP, too";
    "stream.file": "text, optional", "with `--stream`";
    "stream.samples, stream.missing": "integer, optional", "samples in the file, and lost ones";
};

/// Of `record`.
pub(super) const RECORD: &[Field] = fields! {
    "file": "text", "the TARGET file";
    "samples": "integer", "its samples";
};

/// Of `monitor` and `device status`.
pub(super) const STATE: &[Field] = fields! {
    "mode": "text", "`disarmed`, `armed`, `homing`, `running`, `done`, or the name of the fault";
    "referenced": "bool", "whether the axis has been referenced";
    "index": "integer", "samples since the start of the run";
    "run_time_s": "number or null", "the same in s";
    "setpoint_counts, position_counts, error_counts, command_counts": "integer", "as the rig sends them";
    "position_mm, error_mm": "number or null", "null where the rig does not tell the scale, or with `--counts`";
    "pressure_1_raw, pressure_2_raw": "integer or null", "as the rig sends them; null without pressure sensors";
    "spool_raw": "integer", "the same";
    "pressure_1_kpa, pressure_2_kpa, spool_mm": "number or null", "as for the position";
    "recorded": "integer", "samples in the recorder";
    "damaged_frames": "integer", "frames that came damaged to the rig";
};

/// Of `monitor` alone.
pub(super) const MONITOR: &[Field] = fields! {
    "time_s": "number", "since the first line";
};

/// Of `device status` alone.
pub(super) const STATUS: &[Field] = fields! {
    "duration_samples": "integer or null", "length of the run; null until stopped";
    "moves": "any", "whether it is `homing`, moves that have `begun` and were `not_reached`, `learned_null_offset_counts`";
    "learned_changed": "text or null, optional", "as `changed` of `device learned`";
    "owner": "text or null, optional", "which program commands the drive";
};

/// Of `device info`.
pub(super) const INFO: &[Field] = fields! {
    "firmware, build, board": "text", "the firmware, and its board";
    "protocol": "integer", "its version";
    "record_capacity": "integer", "samples of a record";
    "parameters_hash": "text, optional", "of the parameters in force";
    "parameters_stored": "integer, optional", "how often they were stored";
    "parameters_saved": "bool, optional", "whether those in force are the stored ones";
    "sample_interval, output_delay": "any, optional", "`count`, `least_us`, `most_us`, and `bins`: exact, then off by 1, 2 to 3, 4 to 7 us and so on";
};

/// Of `device reference`, `device home`, `device go` and `device jog`.
pub(super) const PLACE: &[Field] = fields! {
    "position_counts": "integer", "where the axis is now";
    "position_mm": "number or null", "the same";
};

/// Of `device reference`.
pub(super) const ENCODER_ZERO: &[Field] = fields! {
    "encoder_zero_counts, encoder_zero_mm": "number or null", "the position at count 0 of an absolute encoder, as it is set now; null: edges are counted";
};

/// Of `device go` and `device jog`.
pub(super) const MOVED: &[Field] = fields! {
    "from_mm": "number", "where the axis stood";
};

/// Of `device learned`.
pub(super) const LEARNED: &[Field] = fields! {
    "adapt": "text", "`afresh`: each arming begins with the rig file; `kept`: with these";
    "armings": "integer", "that have carried it on since the drive began afresh";
    "changed": "text or null", "why it began afresh of late: `at-bound`, `jumped` or `tripped`";
    "mass_ratio, friction_ratio, lag_ratio": "number", "over what the rig file says";
    "viscous_ratio": "number", "the same";
    "force_stictions": "number", "constant force against extension beyond that of the rig file, in stictions";
    "looseness": "integer", "how often the distance at which the load may rest was doubled";
    "lag_ms": "number", "lag of the valve";
    "mass_kg, force_n": "number or null", "moved mass, and that force; null without `--rig`";
};

/// Of `device faults`.
pub(super) const FAULTS: &[Field] = fields! {
    "faults[].reset": "integer", "number of the reset since which it ran";
    "faults[].time_s": "number", "since that reset";
    "faults[].name, faults[].meaning": "text", "the fault";
    "faults[].index, faults[].position_counts": "integer", "sample of the run, and where the axis was";
};

/// Of `device config get` and `device config set`.
pub(super) const PARAMETERS: &[Field] = fields! {
    "parameters[].name, parameters[].unit": "text", "as the key of a rig file";
    "parameters[].entry": "integer or null", "the entry of a list that was asked for";
    "parameters[].value": "any", "a number, a word, or a list of numbers; of `set` the new one";
};

/// Of `device records show` and `device records set`.
pub(super) const RECORDS: &[Field] = fields! {
    "records[].number": "integer", "1 to 14";
    "records[].target_counts": "integer", "where it ends, counts";
    "records[].target_mm": "number or null", "the same; null if the rig does not tell its scale";
    "records[].profile_samples": "integer", "how long its profile takes; 0 of a step";
    "records[].dwell_samples": "integer", "how long it stays there before it counts as in position";
    "records[].words": "text", "as the command prints it";
    "saved": "bool, optional", "of `show`: whether the table and the parameters survive a reset";
};

/// Of `device bring-up`.
pub(super) const CHECKS: &[Field] = fields! {
    "board, firmware": "text", "the board and its firmware";
    "checks[].name": "text", "the check ([bring-up.md](../howto/bring-up.md))";
    "checks[].did, checks[].saw, checks[].must": "text", "what was done and seen, and what is right";
    "checks[].verdict": "text", "`right`, `wrong` or `not checked`";
    "checks[].advice": "any", "the remedies, a list of texts";
};

/// Of `device io`.
pub(super) const CONTACTS: &[Field] = fields! {
    "inputs.number, begun": "integer", "the number that is selected, and that was begun last";
    "inputs.start, inputs.acknowledge, inputs.run, inputs.enable": "bool", "the other inputs";
    "outputs.ready, outputs.in_position, outputs.fault, outputs.lamp": "bool", "the outputs";
    "refused": "text or null", "why the last start was not carried out";
};

/// Of `export`.
pub(super) const EXPORT: &[Field] = fields! {
    "file": "text", "the file";
    "signals, samples": "integer", "its contents";
};

/// Of `import`.
pub(super) const IMPORT: &[Field] = fields! {
    "file": "text", "the TARGET file";
    "rig": "text", "the rig that was logged";
    "samples": "integer", "its samples";
    "remarks[]": "text, optional", "steps of the sensors, resampling";
};

/// Of `fmu`.
pub(super) const FMU: &[Field] = fields! {
    "file, part, rig, platform, fmi": "text", "the FMU, its part and rig, the systems that load it, the version of the standard";
    "inputs, outputs, parameters": "integer", "its variables";
    "period_s": "number", "the least step";
};
