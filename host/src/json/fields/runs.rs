//! Runs and what is said of them.

use super::Field;

/// Of `eval`.
pub(super) const EVAL: &[Field] = fields! {
    "name": "text", "the transient";
    "runs": "integer", "runs that the ranges are over";
    "tolerance_mm": "number", "a move has settled within this distance of its setpoint";
    "moves[].begins_s": "range", "when its setpoint changes, s from the start of the test";
    "moves[].from_mm, moves[].to_mm, moves[].ends_at_mm": "range", "where it begins, its setpoint, and where it ends";
    "moves[].rise_s, moves[].overshoot_mm, moves[].settled_s, moves[].steady_error_mm, moves[].top_speed_mm_s": "range", "see [evaluation.md](../explanation/evaluation.md)";
    "moves[].limit_cycle_swing_mm, moves[].limit_cycle_hz": "range", "of a sustained limit cycle; 0 at rest";
    "moves[].limit_cycle_runs.none, moves[].limit_cycle_runs.sustained, moves[].limit_cycle_runs.undecided": "integer", "runs that come to rest, swing, and are not decidable";
    "moves[].tracking_most_mm, moves[].tracking_rms_mm": "range, optional", "the error along a profile";
    "moves[].air_litres_anr, moves[].air_litres_anr_at_least, moves[].air_litres_anr_at_most": "range", "air that enters the chambers, and its bounds";
    "remarks[]": "text, optional", "the basis of the figures";
};

/// Of `simulate` and `demo`.
pub(super) const SIMULATED: &[Field] = fields! {
    "rig": "text", "its name";
    "samples": "integer", "samples of the controller";
    "ensemble": "integer", "runs: this one and its perturbed runs";
    "converged": "bool", "whether the exact transient is this one";
    "unconverged_from_s": "number or null", "from when on it is not";
    "position_error_m": "number or null", "estimated error of the integration";
    "fault": "any", "null, or the `name` of the fault that ended the run and its `sample`";
    "moves[]": "any", "as in `eval`";
};

/// Of `simulate` alone.
pub(super) const IN_FOLDER: &[Field] = fields! {
    "run": "integer", "its number in the folder";
    "took_ms": "number", "wall-clock time";
    "notes[]": "text", "the text's remarks on the run";
};

/// Of `demo`, with the fields of a run and of an overlay.
pub(super) const RECORDED: &[Field] = fields! {
    "record": "text", "the TARGET file";
    "recorded": "integer", "its samples";
};

/// Of `overlay` and `demo`.
pub(super) const OVERLAY: &[Field] = fields! {
    "notes[]": "text, optional", "shifts, and which pressures are compared";
    "reference": "text", "the transient that the others are compared with";
    "others[].name": "text", "another one";
    "others[].deviations[].channel, others[].deviations[].unit": "text", "the channel, and the unit of its figures";
    "others[].deviations[].samples": "integer", "instants that both cover";
    "others[].deviations[].mean, others[].deviations[].standard_deviation, others[].deviations[].rms, others[].deviations[].largest": "number", "of the other less the reference";
    "others[].deviations[].rms_over_range": "number or null", "over the range of the reference; null of a constant channel";
    "others[].deviations[].inside_band": "number or null", "part of the samples inside the band of a run and its perturbed runs";
    "others[].deviations[].rms_beyond_band": "number or null", "root of the mean square of the distance to that band";
};

/// Of `spectrum`.
pub(super) const SPECTRUM: &[Field] = fields! {
    "spectra[].name, spectra[].unit": "text", "channel and transient; the unit of its amplitudes";
    "spectra[].resolution_hz": "number", "between two frequencies";
    "spectra[].peaks[].frequency_hz, spectra[].peaks[].amplitude": "number", "the highest ten, highest first";
};

/// Of `replay`.
pub(super) const REPLAY: &[Field] = fields! {
    "file": "text", "the record";
    "samples": "integer", "samples that were replayed";
    "differing": "integer", "samples whose output differs";
    "first_difference": "any", "null, or `sample`, `what` differs, `recorded` and `replayed`";
    "tripped": "any", "null, or the `name` of the fault of the controller and its `sample`";
    "notes[]": "text, optional", "the gaps of the record";
};
