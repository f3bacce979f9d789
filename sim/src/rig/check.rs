//! The constraints between the components of a rig: nothing that divides by zero, nothing unphysical (thesis 9.2.1
//! asks for such a check). The constraints on one component alone stand with it.

use std::collections::BTreeSet;

use pneudrive_controller::Config;
use pneudrive_controller::config::ConfigError;
use pneudrive_controller::parameters::lookup;

use super::lagging;
use super::parameters::cascade;
use super::problem::{Problem, Problems};
use super::table::find_key;
use crate::assembly::cushion;
use crate::component::actuator::Actuator;
use crate::component::actuator::cushion::{Cushion, has_cushions};
use crate::component::controller::{ControllerKind, Law, Loop};
use crate::component::load::Load;
use crate::component::supply::receiver;
use crate::component::tubing::speed_outweighs_supply_tube;
use crate::component::{actuator, controller, encoder, faults, friction, operator, sensors, valve};
use crate::key::{Choice, Typed};
use crate::values::{Findings, Rig};
use crate::{gain_bug, keys, schedule, start};

/// The largest part of a dead volume that may be lost to the stop's giving way, at rest.
const MAX_TAKEN_UP: f64 = 0.5;

impl Rig {
    /// The rig with the values that follow from others, if the constraints between its keys hold; `source` is for
    /// messages.
    pub(super) fn checked(mut self, source: &str) -> Result<Rig, Problems> {
        self.suit_others();
        let problem = |(path, message): (&str, String)| Problem {
            source: source.to_owned(),
            line: None,
            key: path.to_owned(),
            message,
        };
        let problems: Vec<Problem> = self.findings(&BTreeSet::new()).0.into_iter().map(problem).collect();
        if problems.is_empty() { Ok(self) } else { Err(Problems(problems)) }
    }

    /// Everything that does not go together, and which of some keys were written in vain.
    pub(crate) fn findings(&self, keys: &BTreeSet<&'static str>) -> Findings {
        let mut findings = Findings::default();
        self.note_idle(keys, &mut findings);
        check(self, &mut findings);
        findings
    }
}

/// Notes everything that does not go together.
fn check(rig: &Rig, findings: &mut Findings) {
    let why = "air must flow from the supply to the exhaust";
    findings.below(rig, &keys::exhaust::PRESSURE_PA, &keys::supply::PRESSURE_PA, why);
    for check in [
        controller::check,
        encoder::check,
        sensors::check,
        operator::check,
        valve::check,
        actuator::check,
        friction::check,
        check_operator,
        check_continuous,
        cascade::check,
        schedule::check,
        start::check,
        receiver::check,
        cushion::check,
        faults::check,
        gain_bug::check,
    ] {
        check(rig, findings);
    }
    // The other checks need a rig that passes these.
    for check in [check_flow, lagging::check, check_dead_volumes, check_parameters] {
        if findings.0.is_empty() {
            check(rig, findings);
        }
    }
}

/// The controller must take what the rig makes of its keys.
fn check_parameters(rig: &Rig, findings: &mut Findings) {
    match rig.try_parameters().map(|parameters| Config::new(&parameters)) {
        Ok(Ok(_)) => {}
        Ok(Err(error)) => findings.0.push((key_of(error), error.advice().to_owned())),
        Err((id, value)) => {
            let parameter = lookup(id);
            let name = parameter.map_or("?", |parameter| parameter.name);
            let own = parameter.and_then(|parameter| parameter.key).map(|key| key.path);
            let alike = || find_key(&format!("controller.{name}")).map(|key| key.path);
            // The others are lengths in counts.
            let path = own.or_else(alike).unwrap_or(keys::encoder::MM_PER_COUNT.path);
            findings.0.push((path, format!("the controller's parameter {name} cannot be {value}")));
        }
    }
}

/// The key to change where parameters do not go together.
fn key_of(error: ConfigError) -> &'static str {
    match error {
        ConfigError::DelayNotBelowPeriod => keys::controller::DELAY_S.path,
        ConfigError::LateSampleNotBelowPeriod => keys::safety::LATE_SAMPLE_US.path,
        ConfigError::LateOutputBehindPeriod => keys::safety::LATE_OUTPUT_US.path,
        ConfigError::SensorWatchTooSlow | ConfigError::DivisorNotPositive => keys::controller::PERIOD_S.path,
        ConfigError::SensorHighBeyondConverter => keys::sensors::BITS.path,
        ConfigError::EncoderStepSpansLimits => keys::safety::MAX_SPEED_M_S.path,
        ConfigError::PositionLimitsCrossed => keys::safety::POSITION_MARGIN_MM.path,
        ConfigError::PressureRangeEmpty => keys::sensors::PRESSURE_MIN_PA.path,
        ConfigError::SpoolRangeEmpty => keys::sensors::SPOOL_MIN_MM.path,
        ConfigError::SoftLimitsCrossed => keys::safety::END_MIN_MM.path,
        ConfigError::HomingStandsStill => keys::controller::HOMING_COMMAND_COUNTS.path,
        ConfigError::PulseTooLong => keys::stepper::PULSE_WIDTH_US.path,
        ConfigError::NothingToFeedBack => keys::controller::PRESSURE_FEEDBACK_GAIN.path,
        ConfigError::NoModel => keys::controller::LAW.path,
    }
}

/// Some valves have operators of their own.
fn check_operator(rig: &Rig, findings: &mut Findings) {
    let model = rig.get(&keys::valve::MODEL);
    let operators = model.facts().operators;
    if !operators.is_empty() && !operators.contains(&rig.get(&keys::operator::MODEL).word()) {
        let message = format!("must be {} with valve.model = {:?}", operators.join(" or "), model.word());
        findings.note(&keys::operator::MODEL, message);
    }
}

/// What the continuous controller cannot drive.
fn check_continuous(rig: &Rig, findings: &mut Findings) {
    if rig.get(&keys::controller::MODEL) != ControllerKind::Continuous {
        return;
    }
    let is_above_0 = |key: &Typed<i64>| rig.get(key) > 0;
    let refused = if !rig.get(&keys::operator::MODEL).is_solenoid() {
        "it drives solenoids; a stepper and an on-off valve need samples"
    } else if rig.get(&keys::controller::LOOP) == Loop::Open {
        let ends = [&keys::safety::END_MIN_MM, &keys::safety::END_MAX_MM];
        if ends.iter().all(|end| rig.get(end).is_none()) {
            return;
        }
        "its open loop is not held back at safety.end_min_mm and safety.end_max_mm; leave them out"
    } else if !matches!(rig.get(&keys::controller::LAW), Law::GainProfile | Law::Proportional) {
        "it has the laws gain-profile and proportional; relays and steps across a dead zone are sampled"
    } else if is_above_0(&keys::controller::DEAD_BAND_COUNTS)
        || is_above_0(&keys::controller::VELOCITY_DEAD_BAND)
    {
        "it has no dead bands; they are for the sampled one"
    } else if rig.get(&keys::controller::PRESSURE_FEEDBACK_GAIN) != 0.0 {
        "it feeds no pressures back; leave controller.pressure_feedback_gain out"
    } else {
        return;
    };
    findings.note(&keys::controller::MODEL, format!("\"continuous\": {refused}"));
}

/// A flow that has no steady value ends a run as soon as a chamber is full.
fn check_flow(rig: &Rig, findings: &mut Findings) {
    if speed_outweighs_supply_tube(rig) {
        let message = "the tube from the supply loses less pressure than the ports recover from their speed behind wide lands: there is no steady flow near the supply pressure; make the tube longer or narrower, or write upstream_mach = false";
        findings.note(&keys::valve::UPSTREAM_MACH, message);
    }
}

/// A stop gives way: the dead volume must be more than what the piston takes up, with a reserve for
/// the speed that it arrives at.
fn check_dead_volumes(rig: &Rig, findings: &mut Findings) {
    let volumes = [&keys::actuator::RESIDUAL_VOLUME_1_M3, &keys::actuator::RESIDUAL_VOLUME_2_M3];
    let behind = if has_cushions(rig) {
        " (of what is behind a spear or in its bore, with a cushion; actuator.cushion_dead_volume_percent divides it)"
    } else {
        ""
    };
    for (key, part) in volumes.into_iter().zip(dead_volume_taken_up(rig)) {
        if part > MAX_TAKEN_UP {
            findings.note(
                key,
                format!(
                    "the piston pressed into its stop at the highest pressure takes up {part:.2} of it{behind}, more than {MAX_TAKEN_UP}: give more volume or a larger load.stop_stiffness_n_per_m"
                ),
            );
        }
    }
}

/// The larger part of its dead volume that a piston takes up as it rests on its stop under the highest
/// pressure, for chambers 1 and 2.
fn dead_volume_taken_up(rig: &Rig) -> [f64; 2] {
    let (actuator, load) = (Actuator::of(rig), Load::of(rig));
    let test = [rig.get(&keys::test::PRESSURE_1_PA).unwrap_or(0.0), rig.get(&keys::test::PRESSURE_2_PA)];
    let supplied = rig.get(&keys::supply::PRESSURE_PA).max(start::receiver_pressure(rig));
    let highest = test.into_iter().fold(supplied, f64::max);
    let standing = [0.0, actuator.stroke].map(|end| load.standing_force(end));
    let outside = actuator.ambient_pressure * actuator.rod_area;
    let [one, two] = actuator.highest_pressures(highest);
    let pushes =
        [two * actuator.area_2 + outside - standing[0], one * actuator.area_1 + standing[1] - outside];
    let areas = [actuator.area_1, actuator.area_2];
    let cushion = Cushion::of(rig, areas, actuator.residual_volumes);
    std::array::from_fn(|i| {
        let way = pushes[i].max(0.0) / load.stops.stiffness;
        let whole = areas[i] * way / actuator.residual_volumes[i];
        cushion.and_then(|own| own.taken_up(i, way)).map_or(whole, |behind_spear| behind_spear.max(whole))
    })
}
