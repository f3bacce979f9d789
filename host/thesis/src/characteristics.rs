//! The component tests of the thesis (7.1), and one of data sheets, on the components of a rig, as on a bench.
//!
//! | curve | thesis | shows |
//! |---|---|---|
//! | [`nominal_flow`] | ISO 6358 | flow of the open path over the command, as data sheets show it |
//! | [`flow_gain`] | 7.1.1.1, Fig. 7.4 | flow of a port over the spool |
//! | [`pressure_gain`] | 7.1.1.2, 7.1.1.3, Fig. 7.3, Tab. 7.1 | blocked ports over the spool, and the null by least squares |
//! | [`flow_function`] | 6.52, V.9 | flow of a land over the pressure ratio |
//! | [`valve_models`] | 7.1.1.3, Fig. 7.5 | single restriction against flow node |
//! | [`hysteresis`] | 7.1.2.1, Fig. 7.6 | spool over command, up and down |
//! | [`dither`] | 7.1.2.2, Fig. 7.8 | a blocked port over command, by frequency of the dither |
//! | [`pressure_drop`] | 7.1.4, 6.61 | pressure behind a tube over its flow |
//! | [`frequency_response`] | 7.1.2.3 | the spool under a swept sine |
//! | [`land_area`] | 6.38 | areas of the lands over the spool |
//! | [`flow_force`] | 6.4.4 | force of the flow on the spool |
//! | [`friction`] | 7.1.3.1, Fig. 7.10 and 7.11, Tab. 7.2 | the load as the supply rises slowly |
//! | [`drift`] | 8.4 | the error at rest over hours, as the valve's null moves |
//! | [`leakage`] | 8.3.3, Fig. 8.8 | the flow past the piston |
//! | [`timer`] | 7.1.5, Fig. 7.13 | the sample periods that the drive can have |
//!
//! There is no second model: [`bench`] uses the same parts as a run.

mod bench;
pub mod dither;
pub mod drift;
pub mod flow_force;
pub mod flow_function;
pub mod flow_gain;
pub mod frequency_response;
pub mod friction;
pub mod hysteresis;
pub mod land_area;
pub mod leakage;
pub mod nominal_flow;
mod points;
pub mod pressure_drop;
pub mod pressure_gain;
pub mod timer;
pub mod valve_models;

use pneudrive_report as report;
use pneudrive_sim::Rig;
use pneudrive_solver::IntegrationError;
pub use points::SUPPLY_FAMILY_PA;

/// A curve that can be requested.
pub struct Curve {
    /// Its name for the user.
    pub name: &'static str,
    /// One line about it, with its place in the thesis.
    pub about: &'static str,
    /// The test on the bench.
    pub measure: fn(&Rig) -> Result<Characteristic, Unfit>,
}

/// All curves.
pub const CURVES: [Curve; 15] = [
    Curve { name: "nominal-flow", about: nominal_flow::ABOUT, measure: nominal_flow::measure },
    Curve { name: "flow-gain", about: flow_gain::ABOUT, measure: flow_gain::measure },
    Curve { name: "pressure-gain", about: pressure_gain::ABOUT, measure: pressure_gain::measure },
    Curve { name: "flow-function", about: flow_function::ABOUT, measure: flow_function::measure },
    Curve { name: "valve-models", about: valve_models::ABOUT, measure: valve_models::measure },
    Curve { name: "hysteresis", about: hysteresis::ABOUT, measure: hysteresis::measure },
    Curve { name: "dither", about: dither::ABOUT, measure: dither::measure },
    Curve { name: "pressure-drop", about: pressure_drop::ABOUT, measure: pressure_drop::measure },
    Curve {
        name: "frequency-response",
        about: frequency_response::ABOUT,
        measure: frequency_response::measure,
    },
    Curve { name: "land-area", about: land_area::ABOUT, measure: land_area::measure },
    Curve { name: "flow-force", about: flow_force::ABOUT, measure: flow_force::measure },
    Curve { name: "friction", about: friction::ABOUT, measure: friction::measure },
    Curve { name: "leakage", about: leakage::ABOUT, measure: leakage::measure },
    Curve { name: "drift", about: drift::ABOUT, measure: drift::measure },
    Curve { name: "timer", about: timer::ABOUT, measure: timer::measure },
];

/// Why a curve cannot be measured on a rig.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unfit {
    /// The rig has no such part.
    #[error("{0}")]
    NoPart(&'static str),
    /// The spool cannot be followed.
    #[error(transparent)]
    Integration(#[from] IntegrationError),
}

/// The result of a bench test: graphs over one axis, and figures.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Characteristic {
    /// The description of the test.
    pub notes: Vec<String>,
    /// Name and unit of the axis across.
    pub across: &'static str,
    /// Whether it is logarithmic.
    pub logarithmic: bool,
    /// The graphs.
    pub graphs: Vec<Graph>,
    /// Figures read off the curves.
    pub figures: Vec<Figure>,
}

/// Curves on one vertical axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Graph {
    /// Name and unit of the axis.
    pub title: &'static str,
    /// The curves.
    pub series: Vec<report::Curve>,
}

/// A figure read off a curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Its name.
    pub name: String,
    /// Its value.
    pub reading: Reading,
    /// Its unit, or "".
    pub unit: &'static str,
}

/// The value of a figure, and its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// The model's equations give it: four digits of it are worth showing.
    Computed(f64),
    /// It was read off with this uncertainty.
    Read {
        /// Its value.
        value: f64,
        /// The largest distance of the true value from it.
        within: f64,
    },
    /// It is not between these two places on the horizontal axis.
    NotBetween([f64; 2]),
}

impl Figure {
    fn computed(name: String, value: f64, unit: &'static str) -> Figure {
        Figure { name, reading: Reading::Computed(value), unit }
    }

    fn read(name: String, value: f64, within: f64, unit: &'static str) -> Figure {
        Figure { name, reading: Reading::Read { value, within }, unit }
    }

    /// Its value, if there is one.
    #[must_use]
    pub fn value(&self) -> Option<f64> {
        match self.reading {
            Reading::Computed(value) | Reading::Read { value, .. } => Some(value),
            Reading::NotBetween(_) => None,
        }
    }
}

/// Servo-drive B with settings.
#[cfg(test)]
fn servo_b(settings: &[&str]) -> Rig {
    let settings: Vec<String> = settings.iter().map(|text| (*text).to_owned()).collect();
    Rig::read_with("servo-b", "", &settings).expect("a valid rig")
}
