//! What must hold between keys: nothing that divides by zero, nothing unphysical (thesis 9.2.1 asks
//! for such a check).

use super::read::Reader;
use super::{Rig, Value, whole_microseconds};
use pneudrive_controller::Config;
use pneudrive_controller::parameters::lookup;
use pneudrive_controller::sequencer::MAX_MOVES;

/// The largest coefficient of discharge with upstream Mach numbers. At 1 a choked port behind a wide
/// land is approached at M = 1, and its flow equation has a double root: M = C_d (5/6)^3 (1 + M^2/5)^3
/// for n = 1.4. Close to 1 the solution is nearly double, and is not found reliably.
pub const MOST_DISCHARGE: f64 = 0.9;

/// Rows of a trace, which are kept in memory, 160 bytes each.
const MOST_ROWS: f64 = 1e7;

/// The largest part of a dead volume that may be lost to the stop's giving way, at rest.
const MOST_TAKEN_UP: f64 = 0.5;

impl Reader<'_> {
    /// Notes everything that does not go together.
    pub(super) fn check(&mut self, rig: &Rig) {
        self.check_pressures(rig);
        self.check_timing(rig);
        self.check_rows(rig);
        self.check_geometry(rig);
        self.check_friction(rig);
        self.check_sensors(rig);
        self.check_moves(rig);
        self.check_start(rig);
        self.check_faults(rig);
        self.check_flow(rig);
        self.check_table(rig);
        self.check_dead_volumes(rig);
        self.check_controller(rig);
    }

    /// The controller must take what the rig makes of its keys.
    fn check_controller(&mut self, rig: &Rig) {
        if !self.is_clean() {
            return;
        }
        match rig.try_parameters().map(|parameters| Config::new(&parameters)) {
            Ok(Ok(_)) => {}
            Ok(Err(error)) => self.problem_at_key("controller", error.advice().to_owned()),
            Err((id, value)) => {
                let name = lookup(id).map_or("?", |parameter| parameter.name);
                self.problem_at_key("controller", format!("its parameter {name} cannot be {value}"));
            }
        }
    }

    /// `lower` must not be above `upper` (with `strictly`: must be below it).
    fn check_order(&mut self, rig: &Rig, lower: &str, upper: &str, strictly: bool, why: &str) {
        let (low, high) = (rig.number(lower), rig.number(upper));
        if low > high || (strictly && low == high) {
            let relation = if strictly { "must be below" } else { "must not be above" };
            self.problem_at_key(lower, format!("{relation} {upper} = {high}, is {low}: {why}"));
        }
    }

    fn check_pressures(&mut self, rig: &Rig) {
        let why = "air must flow from the supply to the exhaust";
        self.check_order(rig, "exhaust.pressure_pa", "supply.pressure_pa", true, why);
        for key in ["valve.discharge_supply", "valve.discharge_exhaust"] {
            if crate::build::speed_counts(rig) && rig.number(key) > MOST_DISCHARGE {
                let message = format!(
                    "must not be above {MOST_DISCHARGE} with upstream_mach: a port that loses nothing has no steady flow"
                );
                self.problem_at_key(key, message);
            }
        }
    }

    /// Earlier versions could read the flows of the nodes from a table.
    fn check_table(&mut self, rig: &Rig) {
        if rig.switch("valve.table") {
            let message = "flows are no longer read from a table, which was slower than solving them: leave the key out";
            self.problem_at_key("valve.table", message.to_owned());
        }
    }

    fn check_rows(&mut self, rig: &Rig) {
        let Some(period) = rig.optional_number("test.trace_period_s") else { return };
        let rows = rig.number("test.duration_s") / period;
        if rows > MOST_ROWS {
            let message = format!(
                "makes {rows:.0} rows in test.duration_s; {MOST_ROWS:.0} at most fit: take a longer period or a shorter test"
            );
            self.problem_at_key("test.trace_period_s", message);
        }
    }

    fn check_timing(&mut self, rig: &Rig) {
        for path in [
            "controller.period_s",
            "controller.delay_s",
            "test.duration_s",
            "test.trace_period_s",
            "test.repeat_every_s",
        ] {
            if rig.optional_number(path).is_some_and(|seconds| whole_microseconds(seconds).is_none()) {
                self.problem_at_key(path, "must be a whole number of microseconds".to_owned());
            }
        }
        let why = "a command is driven before the next sample";
        self.check_order(rig, "controller.delay_s", "controller.period_s", true, why);
    }

    fn check_geometry(&mut self, rig: &Rig) {
        let why = "the spool moves inside the sleeve";
        self.check_order(rig, "valve.spool_diameter_mm", "valve.sleeve_diameter_mm", false, why);
        let why = "the rod must leave an area for the air to push on";
        self.check_order(rig, "actuator.rod_diameter_m", "actuator.bore_m", true, why);
        let dithers = rig.word("operator.model") == "solenoid" && rig.number("operator.dither_mm") > 0.0;
        if dithers && rig.number("operator.dither_hz") == 0.0 {
            let message = "a dither needs a frequency; write dither_mm = 0 for none";
            self.problem_at_key("operator.dither_hz", message.to_owned());
        }
        for key in ["valve.sonic_conductance_m3_per_s_pa", "valve.critical_ratio"] {
            if rig.word("valve.model") == "iso-6358" && rig.optional_number(key).is_none() {
                self.problem_at_key(
                    key,
                    "valve.model = \"iso-6358\" needs it; the data sheet has it".to_owned(),
                );
            }
        }
        self.check_continuous(rig);
        if rig.integer("encoder.polarity") == 0 {
            self.problem_at_key("encoder.polarity", "must be 1 or -1".to_owned());
        }
    }

    /// What the continuous controller cannot drive.
    fn check_continuous(&mut self, rig: &Rig) {
        if rig.word("controller.model") != "continuous" {
            return;
        }
        let refused = match rig.word("operator.model") {
            "stepper" | "on-off" => "it drives solenoids; a stepper and an on-off valve need samples",
            _ if rig.word("controller.loop") == "open" => {
                "it closes the loop; an open loop is for the sampled one"
            }
            _ if !matches!(rig.word("controller.law"), "gain-profile" | "proportional") => {
                "it has the laws gain-profile and proportional; relays and steps across a dead zone are sampled"
            }
            _ if rig.integer("controller.dead_band_counts") > 0
                || rig.integer("controller.velocity_dead_band") > 0 =>
            {
                "it has no dead bands; they are for the sampled one"
            }
            _ => return,
        };
        self.problem_at_key("controller.model", format!("\"continuous\": {refused}"));
    }

    fn check_friction(&mut self, rig: &Rig) {
        let why = "a body that slips must not be held more than one that sticks";
        for (coulomb, stiction) in [
            ("load.coulomb_extend_n", "load.static_extend_n"),
            ("load.coulomb_retract_n", "load.static_retract_n"),
            ("operator.coulomb_friction_n", "operator.static_friction_n"),
        ] {
            self.check_order(rig, coulomb, stiction, false, why);
        }
    }

    /// A flow that has no steady value ends a run as soon as a chamber is full.
    fn check_flow(&mut self, rig: &Rig) {
        if self.is_clean() && crate::build::speed_outweighs_supply_tube(rig) {
            let message = "the tube from the supply loses less pressure than the speed in the ports gives back behind wide lands: no steady flow near the supply's pressure; make the tube longer or narrower, or write upstream_mach = false";
            self.problem_at_key("valve.upstream_mach", message.to_owned());
        }
    }

    /// A stop gives way: the dead volume must be more than what the piston takes up, with a reserve for
    /// the speed that it arrives at.
    fn check_dead_volumes(&mut self, rig: &Rig) {
        if !self.is_clean() {
            return;
        }
        let keys = ["actuator.residual_volume_1_m3", "actuator.residual_volume_2_m3"];
        for (key, part) in keys.into_iter().zip(crate::build::dead_volume_taken_up(rig)) {
            if part > MOST_TAKEN_UP {
                self.problem_at_key(
                    key,
                    format!(
                        "the piston pressed into its stop at the highest pressure takes up {part:.2} of it, more than {MOST_TAKEN_UP}: give more volume or a larger load.stop_stiffness_n_per_m"
                    ),
                );
            }
        }
    }

    fn check_sensors(&mut self, rig: &Rig) {
        let why = "the sensor's range would be empty";
        self.check_order(rig, "sensors.pressure_min_pa", "sensors.pressure_max_pa", true, why);
        self.check_order(rig, "sensors.spool_min_mm", "sensors.spool_max_mm", true, why);
    }

    fn check_moves(&mut self, rig: &Rig) {
        let moves = rig.moves();
        if moves.is_empty() || moves.len() > MAX_MOVES {
            let message = format!("must have 1 to {MAX_MOVES} moves, has {}", moves.len());
            self.problem_at_key("test.moves", message);
        }
        if moves.iter().any(|(time, _)| whole_microseconds(*time).is_none_or(|us| us > u64::from(u32::MAX))) {
            let message = "times must be whole microseconds from 0 to 4294 s".to_owned();
            self.problem_at_key("test.moves", message);
        }
        if moves.windows(2).any(|pair| pair[1].0 < pair[0].0) {
            self.problem_at_key("test.moves", "must be in order of time".to_owned());
        }
        let last = moves.last().map_or(0.0, |(time, _)| *time);
        // A whole sample between them, so that the last move is in force at one at least.
        if rig
            .optional_number("test.repeat_every_s")
            .is_some_and(|round| round < last + rig.number("controller.period_s"))
        {
            let message = format!("must be a sample period longer than the time of the last move, {last} s");
            self.problem_at_key("test.repeat_every_s", message);
        }
        if moves.iter().any(|(_, target)| i32::try_from(*target).is_err()) {
            self.problem_at_key("test.moves", "counts must fit 32 bits".to_owned());
        }
        if rig.word("controller.loop") == "closed" {
            self.check_setpoints(rig, &moves);
        }
        if rig.switch("controller.exit_on_dead_band") && rig.value("test.targets").is_none() {
            let message = "needs test.targets: timed moves do not wait for the end of the one before";
            self.problem_at_key("controller.exit_on_dead_band", message.to_owned());
        }
        if let Some(Value::Numbers(impulse)) = rig.value("test.impulse")
            && (impulse[0] < 0.0 || impulse[1] <= 0.0 || impulse[2].fract() != 0.0)
        {
            let message = "is [time in s, duration in s, counts]: the duration above 0, whole counts";
            self.problem_at_key("test.impulse", message.to_owned());
        }
        self.check_impulse_stands_on_a_move(rig);
    }

    /// Before the first move a closed loop holds where it is, which no file knows.
    fn check_impulse_stands_on_a_move(&mut self, rig: &Rig) {
        let closed = rig.word("controller.loop") == "closed";
        if let (Some(Value::Numbers(impulse)), Some(Value::Moves(moves))) =
            (rig.value("test.impulse"), rig.value("test.moves"))
            && let Some((first, _)) = moves.first()
            && closed
            && rig.value("test.targets").is_none()
            && impulse[0] < *first
        {
            let message = format!(
                "begins before the first move, at {first} s: there is no setpoint for it to stand on"
            );
            self.problem_at_key("test.impulse", message);
        }
    }

    /// A setpoint that the cylinder cannot reach is a slip of units as a rule.
    fn check_setpoints(&mut self, rig: &Rig, moves: &[(f64, i64)]) {
        let ends = [("safety.end_min_mm", -1.0), ("safety.end_max_mm", 1.0)];
        let pulse = rig.number("encoder.mm_per_count");
        for (end, side) in ends {
            let Some(mm) = rig.optional_number(end) else { continue };
            if let Some((_, target)) =
                moves.iter().find(|(_, target)| side * (*target as f64 * pulse - mm) > 0.0)
            {
                self.problem_at_key(end, format!("setpoint {target} lies beyond it"));
            }
        }
        let stroke = (rig.number("actuator.stroke_m") * 1e3 / rig.number("encoder.mm_per_count")) as i64;
        for (_, target) in moves.iter().filter(|(_, target)| *target < 0 || *target > stroke) {
            let key = if rig.value("test.targets").is_some() { "test.targets" } else { "test.moves" };
            self.problem_at_key(
                key,
                format!("setpoint {target} is outside the stroke of 0 to {stroke} counts"),
            );
        }
    }

    fn check_start(&mut self, rig: &Rig) {
        let why = "the test starts within the stroke";
        self.check_order(rig, "test.position_m", "actuator.stroke_m", false, why);
        if let Some(Value::Integers(_)) = rig.value("test.targets")
            && rig.set[Rig::index("test.moves")]
        {
            self.problem_at_key("test.targets", "give either targets or moves, not both".to_owned());
        }
        let balanced = crate::build::equilibrium_pressure_1(rig);
        if rig.optional_number("test.pressure_1_pa").is_none() && !(1e4..=5e6).contains(&balanced) {
            let message = format!(
                "no pressure in chamber 1 balances it at the start (it would be {balanced:.0} Pa); give test.pressure_1_pa"
            );
            self.problem_at_key("test.pressure_2_pa", message);
        }
    }
}
