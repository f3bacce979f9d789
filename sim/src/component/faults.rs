//! What goes wrong with a drive, and when (`[[faults.event]]` of a rig file).
//!
//! | kind | from its instant on |
//! |---|---|
//! | swapped-tubes | valve port 1 feeds chamber 2, port 2 chamber 1; a tube stays with its chamber |
//! | stuck-spool | the spool stays where it is, with any operator |
//! | supply-dip | the supply has another pressure for a while; of several dips the deepest counts |
//! | leak | a hole leads from a chamber to the surroundings (`leak`); several add up |
//! | encoder-loss | the count stays that of the sample before (`sensing`) |
//! | encoder-jump | the count is off by a number; several add up |
//! | sensor-open | a sensor reads raw 0 |
//!
//! The first four change the plant, between outputs and samples as well: their instants are the
//! integrator's, and a step ends on each. The others are in the sensors, and are seen at the first
//! sample that is not before them. At one instant a fault comes before an output.

mod leak;
mod sensing;

pub(crate) use leak::through_hole;
pub(crate) use sensing::SensorFaults;

use std::f64::consts::PI;

use crate::plant::seconds;

/// A sensor that can come off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OpenSensor {
    /// Pressure in chamber 1.
    Pressure1,
    /// Pressure in chamber 2.
    Pressure2,
    /// Spool displacement.
    Spool,
}

/// What goes wrong.
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
        /// By so many counts.
        counts: i32,
    },
    /// A sensor reads raw 0.
    SensorOpen(OpenSensor),
}

/// Something that goes wrong at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaultEvent {
    /// Microseconds from the start of the test.
    pub at_us: u64,
    /// What it is.
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

/// What is wrong with the plant at present.
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
    /// What is wrong since the last of those.
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
