//! Faults of a drive and their times (`[[faults.event]]` of a rig file).
//!
//! | kind | from its instant on |
//! |---|---|
//! | swapped-tubes | valve port 1 feeds chamber 2, port 2 chamber 1; a tube stays with its chamber |
//! | stuck-spool | the spool stays where it is, with any operator |
//! | supply-dip | the supply, or the line in front of its receiver or regulator, has another pressure for a while; of several the deepest counts |
//! | leak | a hole leads from a chamber to the surroundings (`leak`); several add up |
//! | encoder-loss | the count stays that of the sample before (`sensing`) |
//! | encoder-jump | the count is off by a number; several add up |
//! | sensor-open | a sensor reads raw 0 |
//!
//! The first four change the plant, also between outputs and samples: the integrator locates their instants, and a
//! step ends on each. The others are in the sensors and appear at the first sample at or after their instant. At one
//! instant a fault precedes an output.

mod leak;
mod sensing;

pub(crate) use leak::through_hole;
pub(crate) use sensing::SensorFaults;

use std::f64::consts::PI;

use crate::component::actuator::vent;
use crate::component::supply::regulator;
use crate::component::{exhaust, supply};
use crate::key::{
    self, Choice, Key, Kind, Preset, Tables, integer, keys, number, optional_number, other, words,
};
use crate::values::{Fields, Findings, Rig, Value, field, seconds, whole_microseconds};

const COUNT: i64 = i32::MAX as i64;

/// Every kind and its effect.
#[rustfmt::skip]
const KINDS: &[(&str, &str)] = &[
    ("swapped-tubes", "the tubes of chambers 1 and 2 are on each other's port of the valve"),
    ("stuck-spool", "the spool stays where it is"),
    ("supply-dip", "the supply has another pressure for a while"),
    ("leak", "a hole leads from a chamber to the surroundings"),
    ("encoder-loss", "the count stays that of the sample before"),
    ("encoder-jump", "the count is off by a number"),
    ("sensor-open", "a sensor reads raw 0"),
];

#[rustfmt::skip]
const KIND: Kind = Kind::Choice(&[
    ("swapped-tubes", true), ("stuck-spool", true), ("supply-dip", true), ("leak", true),
    ("encoder-loss", true), ("encoder-jump", true), ("sensor-open", true),
]);

keys! {
    EVENT: Option<Vec<Fields>> = other("faults.event", Kind::Tables(&EVENTS), Preset::Absent("nothing goes wrong"), "", "Faults and their times, one table [[faults.event]] each.");
}

/// The list of events.
pub(crate) static EVENTS: Tables = Tables {
    path: "faults.event",
    entry: "event",
    entry_with: "a fault of the kind",
    words: KINDS,
    fields: FIELDS,
};

#[rustfmt::skip]
static FIELDS: &[Key] = &[
    other::<String>("faults.event.kind", KIND, Preset::Absent("must be given"), "", "Kind of fault.").key,
    optional_number("faults.event.at_s", 0.0, 4000.0, "must be given", "", "Time from the start of the test; whole microseconds.").key,
    optional_number("faults.event.pressure_pa", 1e4, 5e6, "midway between exhaust.pressure_pa and supply.pressure_pa", "", "Absolute supply pressure during the dip.").of(&["supply-dip"]).key,
    number("faults.event.duration_s", 0.5, 1e-6, 4000.0, "", "Duration of the dip; whole microseconds.").of(&["supply-dip"]).key,
    integer("faults.event.chamber", 1, 1, 2, "", "The chamber that leaks.").of(&["leak"]).key,
    number("faults.event.diameter_mm", 1.0, 1e-3, 10.0, "", "Bore of the hole, as that of an ideal nozzle that passes as much; a sharp hole passes 0.6 to 0.8 of it.").of(&["leak"]).key,
    integer("faults.event.counts", 1000, -COUNT, COUNT, "", "By how much the count is off.").of(&["encoder-jump"]).key,
    key::choice::<OpenSensor>("faults.event.sensor", "", "The sensor that fails.").of(&["sensor-open"]).key,
];

words! {
    /// A sensor that can come off.
    pub enum OpenSensor {
        /// Pressure in chamber 1.
        Pressure1 = "pressure-1",
        /// Pressure in chamber 2.
        Pressure2 = "pressure-2",
        /// Spool displacement.
        Spool = "spool",
    }
}

/// The kind of a fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaultKind {
    /// The ports of the valve are joined to the chambers crosswise.
    SwappedTubes,
    /// The spool does not move any more.
    StuckSpool,
    /// The supply has another pressure for a while.
    SupplyDip {
        /// Pa, absolute.
        pressure: f64,
        /// Microseconds.
        duration_us: u64,
    },
    /// A hole from a chamber to the surroundings.
    Leak {
        /// Index of the chamber, 0 or 1.
        chamber: usize,
        /// Of an ideal nozzle that passes as much, m.
        diameter: f64,
    },
    /// The count changes no more.
    EncoderLoss,
    /// The count is off from now on.
    EncoderJump {
        /// The jump, counts.
        counts: i32,
    },
    /// A sensor reads raw 0.
    SensorOpen(OpenSensor),
}

impl FaultKind {
    /// Whether it needs a sensor of a pressure.
    pub(crate) fn is_of_pressure_sensor(self) -> bool {
        matches!(self, FaultKind::SensorOpen(OpenSensor::Pressure1 | OpenSensor::Pressure2))
    }
}

/// Something that goes wrong at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaultEvent {
    /// Microseconds from the start of the test.
    pub at_us: u64,
    /// Its kind.
    pub kind: FaultKind,
}

impl FaultEvent {
    /// When it ends, if it does.
    fn end_us(&self) -> Option<u64> {
        match self.kind {
            FaultKind::SupplyDip { duration_us, .. } => Some(self.at_us + duration_us),
            _ => None,
        }
    }

    fn holds_at(&self, us: u64) -> bool {
        self.at_us <= us && self.end_us().is_none_or(|end| us < end)
    }

    fn is_of_plant(&self) -> bool {
        use FaultKind::{Leak, StuckSpool, SupplyDip, SwappedTubes};
        matches!(self.kind, SwappedTubes | StuckSpool | SupplyDip { .. } | Leak { .. })
    }
}

/// The present faults of the plant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PlantFaults {
    /// Ports and chambers are joined crosswise.
    pub swapped_tubes: bool,
    /// The spool is stuck.
    pub stuck_spool: bool,
    /// The supply's pressure while it is not its own, Pa.
    pub supply_pressure: Option<f64>,
    /// Area of the holes in each chamber, m^2.
    pub leak_areas: [f64; 2],
}

impl PlantFaults {
    fn add(&mut self, kind: FaultKind) {
        match kind {
            FaultKind::SwappedTubes => self.swapped_tubes = true,
            FaultKind::StuckSpool => self.stuck_spool = true,
            FaultKind::SupplyDip { pressure, .. } => {
                self.supply_pressure =
                    Some(self.supply_pressure.map_or(pressure, |other| other.min(pressure)));
            }
            FaultKind::Leak { chamber, diameter } => {
                self.leak_areas[chamber] += PI / 4.0 * diameter * diameter;
            }
            FaultKind::EncoderLoss | FaultKind::EncoderJump { .. } | FaultKind::SensorOpen(_) => {}
        }
    }
}

/// The faults of the plant in their order, and how far they have come.
#[derive(Clone, Debug, Default)]
pub(crate) struct Schedule {
    events: Vec<FaultEvent>,
    /// When something begins or ends, microseconds.
    instants: Vec<u64>,
    /// How many of them have passed.
    passed: usize,
    /// The faults since the last of those.
    pub now: PlantFaults,
}

impl Schedule {
    /// The schedule of the events that change the plant.
    pub fn new(events: &[FaultEvent]) -> Schedule {
        let events: Vec<FaultEvent> = events.iter().copied().filter(FaultEvent::is_of_plant).collect();
        let ends = events.iter().filter_map(FaultEvent::end_us);
        let mut instants: Vec<u64> = events.iter().map(|event| event.at_us).chain(ends).collect();
        instants.sort_unstable();
        instants.dedup();
        Schedule { events, instants, passed: 0, now: PlantFaults::default() }
    }

    /// The same on a clock that has run for this many microseconds before the start of the test.
    pub fn later_by(mut self, us: u64) -> Schedule {
        self.events.iter_mut().for_each(|event| event.at_us += us);
        self.instants.iter_mut().for_each(|instant| *instant += us);
        self
    }

    /// When something begins or ends next, s; infinity for never.
    pub fn next_time_event(&self) -> f64 {
        self.instants.get(self.passed).map_or(f64::INFINITY, |&us| seconds(us))
    }

    /// Passes every instant up to `t`; false if there is none.
    pub fn pass(&mut self, t: f64) -> bool {
        let before = self.passed;
        while self.next_time_event() <= t {
            self.passed += 1;
        }
        if self.passed == before {
            return false;
        }
        let us = self.instants[self.passed - 1];
        self.now = PlantFaults::default();
        for event in self.events.iter().filter(|event| event.holds_at(us)) {
            self.now.add(event.kind);
        }
        true
    }
}

impl Rig {
    /// The faults, in the order of the file.
    #[must_use]
    pub fn fault_events(&self) -> Vec<FaultEvent> {
        self.get(&keys::EVENT).iter().flatten().map(|event| self.fault_event(event)).collect()
    }

    fn fault_event(&self, event: &Fields) -> FaultEvent {
        let number = |name: &str| match field(event, name) {
            Some(Value::Number(number)) => Some(*number),
            _ => None,
        };
        let integer = |name: &str| match field(event, name) {
            Some(Value::Integer(integer)) => *integer,
            _ => panic!("an event of its kind has {name}"),
        };
        let word = |name: &str| match field(event, name) {
            Some(Value::Word(word)) => word.as_str(),
            _ => panic!("an event of its kind has {name}"),
        };
        let microseconds = |name: &str| number(name).and_then(whole_microseconds).unwrap_or(0);
        let midway = || 0.5 * (self.get(&exhaust::keys::PRESSURE_PA) + self.get(&supply::keys::PRESSURE_PA));
        let kind = match word("kind") {
            "swapped-tubes" => FaultKind::SwappedTubes,
            "stuck-spool" => FaultKind::StuckSpool,
            "supply-dip" => FaultKind::SupplyDip {
                pressure: number("pressure_pa").unwrap_or_else(midway),
                duration_us: microseconds("duration_s"),
            },
            "leak" => FaultKind::Leak {
                chamber: usize::from(integer("chamber") == 2),
                diameter: number("diameter_mm").unwrap_or(0.0) * 1e-3,
            },
            "encoder-loss" => FaultKind::EncoderLoss,
            "encoder-jump" => FaultKind::EncoderJump { counts: integer("counts") as i32 },
            _ => FaultKind::SensorOpen(OpenSensor::of_word(word("sensor")).unwrap_or(OpenSensor::Spool)),
        };
        FaultEvent { at_us: microseconds("at_s"), kind }
    }
}

/// The constraints between events and the rest of a rig.
pub(crate) fn check(rig: &Rig, findings: &mut Findings) {
    let events = rig.fault_events();
    if events.is_empty() {
        return;
    }
    let line = regulator::line_pressure(rig);
    let (low, high) = (rig.get(&exhaust::keys::PRESSURE_PA), rig.get(line));
    let vented = rig.get(&vent::keys::VENTED).chamber();
    for event in events {
        if let FaultKind::Leak { chamber, .. } = event.kind
            && vented == Some(chamber)
        {
            findings.note(
                &keys::EVENT,
                format!("chamber = {} is vented (actuator.vented): a hole in it has no effect", chamber + 1),
            );
        }
        if let FaultKind::SupplyDip { pressure, .. } = event.kind
            && !(low < pressure && pressure < high)
        {
            findings.note(&keys::EVENT, format!("pressure_pa = {pressure} is not a dip: it must be between exhaust.pressure_pa = {low} and {} = {high}", line.path));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dip(at_us: u64, duration_us: u64, pressure: f64) -> FaultEvent {
        FaultEvent { at_us, kind: FaultKind::SupplyDip { pressure, duration_us } }
    }

    #[test]
    fn of_dips_that_overlap_the_deepest_counts_and_the_supply_recovers_after_the_last() {
        let mut schedule = Schedule::new(&[dip(200, 100, 2e5), dip(100, 300, 4e5)]);
        let mut seen = Vec::new();
        while schedule.next_time_event().is_finite() {
            let t = schedule.next_time_event();
            assert!(schedule.pass(t));
            seen.push(((t * 1e6).round() as u64, schedule.now.supply_pressure));
        }
        assert_eq!(seen, [(100, Some(4e5)), (200, Some(2e5)), (300, Some(4e5)), (400, None)]);
    }

    #[test]
    fn holes_in_one_chamber_add_up() {
        let hole = |at_us, diameter| FaultEvent { at_us, kind: FaultKind::Leak { chamber: 1, diameter } };
        let mut schedule = Schedule::new(&[hole(0, 3e-3), hole(5, 4e-3)]);
        assert!(schedule.pass(5e-6));
        let [none, both] = schedule.now.leak_areas;
        assert_eq!(none, 0.0);
        assert!((both - PI / 4.0 * 25e-6).abs() < 1e-18);
    }

    #[test]
    fn nothing_is_passed_before_its_instant_and_sensors_have_none() {
        let sensor = FaultEvent { at_us: 10, kind: FaultKind::EncoderLoss };
        assert_eq!(Schedule::new(&[sensor]).next_time_event(), f64::INFINITY);
        let mut schedule = Schedule::new(&[FaultEvent { at_us: 20, kind: FaultKind::StuckSpool }]);
        assert!(!schedule.pass(19e-6) && !schedule.now.stuck_spool);
        assert!(schedule.pass(20e-6) && schedule.now.stuck_spool);
    }
}
