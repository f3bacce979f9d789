//! Genes: each a quantity with its search range.

/// A quantity, and its range as a share from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DesignVariable {
    /// Its name.
    pub what: &'static str,
    /// Its unit.
    pub unit: &'static str,
    low: f64,
    high: f64,
    scale: Scale,
    /// Whether its ends are natural limits, beyond which there is no value to search.
    natural: [bool; 2],
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Scale {
    Linear,
    Logarithmic,
    /// Whole numbers.
    Whole,
}

/// This part of the range at its ends counts as its end.
const END: f64 = 0.02;

const fn design_variable(
    what: &'static str,
    unit: &'static str,
    [low, high]: [f64; 2],
    scale: Scale,
) -> DesignVariable {
    DesignVariable { what, unit, low, high, scale, natural: [false; 2] }
}

impl DesignVariable {
    /// The quantity at a share of its range.
    pub fn value(&self, share: f64) -> f64 {
        let linear = self.low + share * (self.high - self.low);
        match self.scale {
            Scale::Linear => linear,
            Scale::Logarithmic => self.low * libm::pow(self.high / self.low, share),
            Scale::Whole => linear.round(),
        }
    }

    /// Whether it is at an end of its range beyond which there may be something better.
    pub fn is_at_limit(&self, share: f64) -> bool {
        let is_at = |end: f64| match self.scale {
            Scale::Whole => self.value(share) == self.value(end),
            Scale::Linear | Scale::Logarithmic => (share - end).abs() <= END,
        };
        let [low, high] = self.natural;
        (is_at(0.0) && !low) || (is_at(1.0) && !high)
    }

    /// Its lower end is the least that there can be.
    const fn bounded_below(self) -> DesignVariable {
        DesignVariable { natural: [true, self.natural[1]], ..self }
    }

    /// Its upper end is the most that makes sense.
    const fn bounded_above(self) -> DesignVariable {
        DesignVariable { natural: [self.natural[0], true], ..self }
    }
}

use Scale::{Linear, Logarithmic, Whole};

pub(super) const E_NEAR: DesignVariable = design_variable(
    "error that opens the valve fully, by the gain at small errors",
    "mm",
    [0.15, 30.0],
    Logarithmic,
);
pub(super) const E_FAR: DesignVariable = design_variable(
    "error that opens the valve fully, by the gain at large errors",
    "mm",
    [3.0, 150.0],
    Logarithmic,
);
pub(super) const E_KNEE: DesignVariable =
    design_variable("error at which the profile is halfway between", "mm", [0.03, 10.0], Logarithmic);
pub(super) const T_D: DesignVariable =
    design_variable("time of the velocity feedback, T_d", "s", [0.003, 0.15], Logarithmic);
/// Above, a count of acceleration throws the valve over.
pub(super) const T_A: DesignVariable =
    design_variable("time of the acceleration feedback, T_a", "s", [0.001, 0.04], Logarithmic);
pub(super) const VELOCITY_WINDOW: DesignVariable =
    design_variable("window of the velocity", "samples", [1.0, 12.0], Whole).bounded_below();
pub(super) const ACCELERATION_WINDOW: DesignVariable =
    design_variable("window of the acceleration", "samples", [1.0, 8.0], Whole).bounded_below();
/// A wider one forbids to settle.
pub(super) const DEAD_BAND: DesignVariable =
    design_variable("dead band, relative to the settling tolerance", "", [0.0, 1.0], Linear)
        .bounded_below()
        .bounded_above();
/// Of the whole command.
pub(super) const NULL_OFFSET: DesignVariable =
    design_variable("null offset, relative to the full command", "%", [-2.0, 2.0], Linear);
/// Of the law that positions by a model of its drive.
pub(super) const DEAD_TIME_FACTOR: DesignVariable = design_variable(
    "dead time of the force loop, relative to that of the rig file",
    "",
    [0.7, 2.0],
    Logarithmic,
);
pub(super) const FLOW_SHARE: DesignVariable = design_variable(
    "share of the force and of the flow that its trajectories ask for",
    "",
    [0.2, 0.8],
    Logarithmic,
)
.bounded_above();
pub(super) const OBSERVER_FACTOR: DesignVariable =
    design_variable("speed of the observers, relative to the usual one", "", [0.4, 1.6], Logarithmic);
pub(super) const DITHER: DesignVariable =
    design_variable("dither of the spool", "mm", [0.0, 0.6], Linear).bounded_below();
pub(super) const DITHER_HZ: DesignVariable =
    design_variable("frequency of the dither", "Hz", [20.0, 120.0], Linear);
