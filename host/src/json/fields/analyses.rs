//! Analyses of many runs.

use super::Field;

/// Of `identify`.
pub(super) const IDENTIFY: &[Field] = fields! {
    "read_off.stiction_n[], read_off.coulomb_n[]": "any", "extension, retraction: `value` and `standard_error`, or null";
    "read_off.viscous_n_s_per_m, read_off.mass_kg": "any", "`value` and `standard_error`, or null";
    "read_off.top_speed_m_s[], read_off.top_acceleration_m_s2[]": "number or null", "extension, retraction";
    "read_off.hysteresis_mm": "number or null", "width of the spool's loop";
    "format": "text", "version of the file and of its fields, from here on";
    "rig": "text", "its name";
    "transients[]": "text", "the records";
    "converged": "bool", "whether the search came to its end";
    "fits, judged": "bool", "whether the model explains the data, and whether there are enough samples to judge";
    "channels_not_judged[]": "text, optional", "channels with too few samples";
    "channels_rounded[]": "text, optional", "channels with less noise than a count, whose rounding the model predicts";
    "incline_suggested_deg": "number or null", "the incline that would explain how friction differs from the file's; null without a sign of one, or where `fits` is false";
    "at_limits[], far_from_file[]": "text, optional", "keys of values at a limit, or more than three standard deviations of the prior from the file's";
    "runs": "integer", "runs of a transient that the fit took";
    "evaluations": "integer", "evaluations of the model's equations in these runs";
    "search_cut": "bool", "whether the search was cut";
    "causes_not_looked_at[]": "text, optional", "effects whose fit had not come to its end";
    "parameters[].key, parameters[].unit": "text, optional", "a parameter that was found";
    "parameters[].file, parameters[].estimate, parameters[].standard_error": "number, optional", "its value in the file, and what was found";
    "parameters[].interval, parameters[].interval_is": "any, optional", "the interval, and its kind: `95 %`, `widened by the misfit` or `not judged`";
    "parameters[].interval_95, parameters[].interval_widened": "any, optional", "the interval if it is of that kind, else null";
    "parameters[].part_of_assumptions, parameters[].rests_on[]": "any, optional", "how much of the error is of assumptions, and the `key` and `part` of those";
    "parameters[].given": "any, optional", "`standard_error`, `interval` and `interval_95` if the values in `known` are exact, or null";
    "unseen[]": "any, optional", "`key`, `file`, `taken`: the value in the fitted rig, which the fit may have changed (`kept` is its former name), `over_prior`: its standard error over that of its prior, 1 if no sample depends on it, `confused_with`";
    "calibration[]": "any, optional", "`key`, `unit`, `name`, `file`, `tolerance`, `estimate`, `standard_error`, `seen` (the data tell it, not the tolerance), `beyond_tolerance`";
    "causes[]": "any, optional", "`effect`, `settings`, `explained`, `chance`, `significant`, `as_good_as_best`, `leaves_noise` (noise alone is left with the effect), `value`, `standard_error`";
    "assumed[], channels[], correlation[]": "any, optional", "values taken as exact, the residuals of each channel in counts, and the correlation of the estimates";
};

/// Of `identify` with `--tubing`, `--conductance` or `--timer`.
pub(super) const SIMPLE: &[Field] = fields! {
    "drop_slope, sonic_conductance_m3_per_s_pa, critical_ratio": "any, optional", "`value` and `standard_error`";
    "reference_flow_kg_s, subsonic_index, scatter_over_choked_flow": "number, optional", "their basis";
    "periods[].requested_us, periods[].measured_us": "number, optional", "sample periods of the records";
    "intercept_us, slope": "any, optional", "of the line through them: `value` and `standard_error`, or null";
};

/// Of `commission`, with the fields of its fit.
pub(super) const COMMISSION: &[Field] = fields! {
    "settings[]": "text, optional", "keys beside those of the rig file with which the fit was made";
    "follows_mm": "number, optional", "how far its model is off the recorded position, mm (root mean square)";
    "trial_moves": "integer, optional", "its trial moves";
    "trial_moves_off": "integer, optional", "those that do not come to rest within the tolerance";
    "report": "text, optional", "the page";
};

/// Of `sweep` and `merge`.
pub(super) const SWEEP: &[Field] = fields! {
    "rig": "text", "its name";
    "rows[].point": "integer", "number of the point";
    "rows[].levels.*": "any", "the varied values";
    "rows[].metrics.*.value": "number or null", "of the run itself; null where it does not show the metric";
    "rows[].metrics.*.least, rows[].metrics.*.most": "number or null", "over its perturbed runs";
    "rows[].converged": "bool or null", "null of a draw";
    "rows[].fault, rows[].failure": "text", "why the run ended early, or did not begin; else empty";
    "rows[].allowed": "bool", "whether it keeps all constraints";
    "best": "integer or null", "number of the best point";
};

/// Of `ladder`.
pub(super) const LADDER: &[Field] = fields! {
    "variants[].component, variants[].model": "text", "the component and its model that differ from the reference, which is the first";
    "variants[].evaluations_per_sample, variants[].flow_iterations_per_sample": "number", "work";
    "variants[].time_over_reference.value, variants[].time_over_reference.least, variants[].time_over_reference.most": "number", "time over that of the reference";
    "variants[].converged": "bool", "whether the exact transient is this one";
    "variants[].deviations[]": "any", "from the reference, of the run and of each perturbed run: as in `overlay`";
};

/// Of `tune`.
pub(super) const TUNE: &[Field] = fields! {
    "goal.step_mm, goal.settled_mm, goal.overshoot_percent, goal.time_s": "number", "the goal";
    "changed": "bool", "whether gains were found";
    "before.settings[], after.settings[]": "text, optional", "gains that differ from the file's";
    "before.met, before.of, after.met, after.of": "integer", "fresh draws that meet the goal, of so many";
    "before.interval_95[], after.interval_95[]": "number", "ends of the 95 % interval of that share";
    "before.draws[]": "any", "of each draw, as in `after`";
    "after.draws[].met": "bool", "whether it meets the goal";
    "after.draws[].settling_s, after.draws[].overshoot_percent, after.draws[].error_mm": "number or null", "of the worst step";
    "after.draws[].limit_cycle": "text", "`none`, `sustained` or `undecided`";
    "after.draws[].failure": "text", "why the run ended early, or empty";
    "along_the_stroke[].ends_mm[]": "number", "a step between these, and back";
    "along_the_stroke[].runs[]": "any", "of the file's rig and its perturbed runs, as `after.draws`";
    "sines[].frequency_hz, sines[].amplitude_mm, sines[].middle_mm": "number", "a sine about mid-stroke";
    "sines[].gains": "text", "`of the file`, `found`, or `as much feed-forward as feedback`";
    "sines[].limit": "text or null", "the limit of all runs: `resolution and dead band`, `friction`, `valve flow`, `the law`; null if it cannot be seen";
    "sines[].runs[].rms_mm, sines[].runs[].largest_mm, sines[].runs[].behind_s": "number or null", "of the file's rig and its perturbed runs, from the second swing on";
    "sines[].runs[].in_dead_band, sines[].runs[].standing, sines[].runs[].fully_open, sines[].runs[].with_sine": "number or null", "shares of the squared error ([tuning.md](../howto/tuning.md))";
    "sines[].runs[].limit": "text or null", "the limit of this run";
    "sines[].runs[].failure": "text", "why it ended early, or empty";
    "sines[].draws[]": "any", "of fresh draws, as `sines[].runs`";
    "obstacles[].without": "text, optional", "an imperfection that was removed";
    "obstacles[].found": "any, optional", "as `after`";
    "runs": "integer", "simulated runs";
};

/// Of `characterise`.
pub(super) const CHARACTERISE: &[Field] = fields! {
    "rig": "text", "its name";
    "curves[].name, curves[].across": "text", "the test, and the axis of its graphs with its unit";
    "curves[].figures[].name, curves[].figures[].unit": "text", "a figure that was read off";
    "curves[].figures[].value": "number or null", "null where it was not seen";
    "curves[].figures[].within": "number or null", "how well it is read; null of a computed one";
    "curves[].figures[].not_between": "any", "the ends of the interval in which it was not seen, or null";
    "curves[].notes[]": "text, optional", "their basis";
    "curves[].files[]": "text", "the curves as CSV, and the page";
};

/// Of `study`.
pub(super) const STUDIES: &[Field] = fields! {
    "studies[].name, studies[].section, studies[].about": "text", "the study";
    "studies[].findings[].thesis, studies[].findings[].model": "text, optional", "the statement of the thesis, and the finding of the runs";
    "studies[].findings[].verdict": "text, optional", "whether they agree";
};

/// Of `thesis`.
pub(super) const ENTRIES: &[Field] = fields! {
    "entries[].section, entries[].place, entries[].key": "text", "where the thesis prints it";
    "entries[].printed, entries[].unit": "text", "the printed value";
    "entries[].value, entries[].least, entries[].most": "number or null", "ours";
    "entries[].verdict, entries[].rests_on": "text", "whether they agree, and the basis of ours";
};
