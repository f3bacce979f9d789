//! The effects that are tried.

use super::super::calibration;
use super::super::model::FittedModel;
use super::{Change, Choice, Effect};
use pneudrive_sim::keys;

const fn number(path: &'static str, size: f64, least: f64) -> Change {
    Change::Number { path, with: None, size, least }
}

/// The errors of calibration among the unknowns of a model.
pub(super) fn calibrations(model: &FittedModel) -> impl Iterator<Item = Effect> {
    let errors = model.parameters.iter().filter(|parameter| parameter.is_calibration);
    errors.filter_map(|parameter| {
        let item = calibration::item_of(parameter.key.path)?;
        let change = Change::Calibration(item.error.path);
        Some(Effect { name: item.name, change, measure: item.measure })
    })
}

/// In the order in which they are tried.
pub(super) const EFFECTS: [Effect; 14] = [
    Effect {
        name: "heat exchange with the cylinder's walls",
        change: number(keys::walls::HEAT_TRANSFER_W_PER_M2_K.key.path, 50.0, 0.0),
        measure: "shut the valve after a fast stroke and watch how the pressures recover within a second",
    },
    Effect {
        name: "lag of the pressure sensors",
        change: number(keys::sensors::PRESSURE_LAG_S.key.path, 1e-3, 2e-5),
        measure: "take it from the data sheets of sensor and amplifier, or vent a sensor suddenly and record it",
    },
    Effect {
        name: "lag of the tubes",
        change: number(keys::tubing::LAG_S.key.path, 1e-3, 2e-5),
        measure: "record the pressure at both ends of a tube while the valve opens",
    },
    Effect {
        name: "leakage past the piston",
        change: Change::Number {
            path: keys::leakage::LEAKAGE_COEFFICIENT.key.path,
            with: Some(Choice { path: keys::leakage::LEAKAGE.key.path, word: "laminar", none: "none" }),
            size: 1e-9,
            least: 0.0,
        },
        measure: "block the piston, fill one chamber, shut both ports, and time how the pressures meet",
    },
    Effect {
        name: "a spring on the load",
        change: number(keys::load::SPRING_N_PER_M.key.path, 30.0, 0.0),
        measure: "with both chambers vented, push the load along its stroke with a spring balance",
    },
    Effect {
        name: "an incline",
        change: number(keys::load::INCLINE_DEG.key.path, 2.0, -90.0),
        measure: "lay a spirit level on the cylinder",
    },
    Effect {
        name: "another supply pressure",
        change: number(keys::supply::PRESSURE_PA.key.path, 2e4, 1e4),
        measure: "read a gauge at the valve during a full opening",
    },
    Effect {
        name: "another supply temperature",
        change: number(keys::supply::TEMPERATURE_K.key.path, 5.0, 150.0),
        measure: "measure the temperature of the supply air",
    },
    Effect {
        name: "another exhaust pressure",
        change: number(keys::exhaust::PRESSURE_PA.key.path, 1e3, 1e4),
        measure: "read a barometer, and a gauge between the valve and its silencer",
    },
    Effect {
        name: "another lap of the valve's lands",
        change: number(keys::valve::UNDERLAP_MM.key.path, 0.01, -10.0),
        measure: "record the flow near the null (`pneudrive characterise RIG flow-gain` shows that of the model)",
    },
    Effect {
        name: "another ratio of heat capacities",
        change: number(keys::gas::HEAT_CAPACITY_RATIO.key.path, -0.02, 1.01),
        measure: "check which gas it is: 1.4 is dry air; a lower value also stands for heat exchange",
    },
    Effect {
        name: "the speed of the air in the ports",
        change: Change::Switch(keys::valve::UPSTREAM_MACH.key.path),
        measure: "compare the flow of the open valve through wide and narrow tubes",
    },
    Effect {
        name: "a discharge that depends on the pressure ratio",
        change: Change::Word(Choice {
            path: keys::discharge::DISCHARGE_MODEL.key.path,
            word: "perry",
            none: "constant",
        }),
        measure: "record the flow of the open valve over the pressure ratio",
    },
    Effect {
        name: "the force of the flow on the spool",
        change: Change::Word(Choice {
            path: keys::flow_force::FLOW_FORCE.key.path,
            word: "analytical",
            none: "none",
        }),
        measure: "compare the strokes of the spool with and without supply pressure",
    },
];
