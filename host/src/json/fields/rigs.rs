//! Rig files and parts.

use super::Field;

/// Of `rig new`.
pub(super) const RIG_NEW: &[Field] = fields! {
    "file": "text", "the rig file";
    "values.*": "integer", "values by origin: given, computed, typical, unknown, default";
};

/// Of `rig parts`.
pub(super) const RIG_PARTS: &[Field] = fields! {
    "parts[].family, parts[].name": "text", "the part";
    "parts[].facts.*": "text, optional", "its description";
    "parts[].figures[].name": "text", "a figure";
    "parts[].figures[].value": "text or null", "with its unit, as the catalogue writes it";
    "parts[].figures[].range": "any", "the lowest and the highest value, or null";
    "parts[].figures[].basis": "text", "its basis";
};

/// Of `rig list`.
pub(super) const RIG_LIST: &[Field] = fields! {
    "rigs[].name, rigs[].about": "text", "a built-in rig";
};

/// Of `rig show`.
pub(super) const RIG_SHOW: &[Field] = fields! {
    "rig": "text", "its name";
    "keys.*.value": "any", "the value, in the unit of the key";
    "keys.*.unit": "text", "its unit, or empty";
    "keys.*.origin": "text", "given, computed, typical, unknown or default";
    "keys.*.low, keys.*.high": "number, optional", "the range in which it lies";
    "keys.*.from": "text, optional", "the source that the file names";
};

/// Of `rig diff`.
pub(super) const RIG_DIFF: &[Field] = fields! {
    "differences[].key, differences[].unit": "text", "a key at which they differ";
    "differences[].values[]": "any", "in the first rig and in the second; null where one has none";
    "differences[].percent": "number or null", "how much larger the second number is";
};

/// Of `rig check`.
pub(super) const RIG_CHECK: &[Field] = fields! {
    "rig": "text", "its name";
    "unused[]": "text, optional", "keys of the file that have no effect in it; they have the values that hold without them";
    "moves[].at_s": "number", "when a move of its test begins";
    "moves[].to_mm": "number or null", "where it goes; null in open loop";
    "moves[].to_counts": "integer", "the same in counts; in open loop the command to the valve";
    "effects[].key, effects[].unit, effects[].origin": "text, optional", "a value that nobody has measured";
    "effects[].value": "number or null, optional", "it";
    "effects[].tried[]": "number, optional", "the ends of its range";
    "effects[].moves_mm": "number or null, optional", "how far they move the piston; null where a run fails";
    "not_significant_below_mm": "number, optional", "members of the ensemble of the run differ as much";
};
