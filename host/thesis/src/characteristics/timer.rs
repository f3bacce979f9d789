//! The shortest sample period (7.1.5, Fig. 7.13).
//!
//! The thesis's timer stretched a period that its interrupt could not keep: below 0.28 ms the interrupts came as fast
//! as they were served. Here the time from sample to output is `controller.delay_s`, C(26). A period that leaves no
//! room for it is refused, not stretched. The actual period of a timer is measured on a board.

use super::points::{evenly, over};
use super::{Characteristic, Figure, Graph, Unfit};
use pneudrive_sim::Rig;
use pneudrive_sim::keys;

pub(super) const ABOUT: &str = "sample period that a drive has over the one asked for (7.1.5, Fig. 7.13)";

/// Periods are requested up to at least this one, us.
const LONGEST_US: u64 = 3000;

pub(super) fn measure(rig: &Rig) -> Result<Characteristic, Unfit> {
    let own = u64::from(rig.period_us().get());
    let floor = floor_us(rig, own);
    let asked = evenly(floor as f64, (2 * own).max(LONGEST_US) as f64, 100);
    let asked = asked.into_iter().map(f64::round).filter(|&us| takes(rig, us as u64));
    let asked: Vec<f64> = asked.map(|us| us * 1e-3).collect();
    let delay = 1e3 * rig.get(&keys::controller::DELAY_S);
    Ok(Characteristic {
        notes: vec![
            "A shorter period than the floor is refused; the thesis's timer stretched it, to 0.28 ms at least. On a board, whether its interrupt is in time is watched (safety.late_sample_us), and `identify --timer` holds the periods of records against those asked for.".to_owned(),
        ],
        across: "requested period, ms",
        graphs: vec![Graph {
            title: "sample period, ms",
            series: vec![
                over("sample to sample", &asked, |period| period),
                over("sample to output", &asked, |_| delay),
            ],
        }],
        figures: vec![
            Figure::computed("shortest sample period".to_owned(), floor as f64 * 1e-3, "ms"),
            Figure::computed("sample to output".to_owned(), delay, "ms"),
        ],
        ..Characteristic::default()
    })
}

/// Whether a rig accepts a period of this many microseconds.
fn takes(rig: &Rig, period_us: u64) -> bool {
    rig.with_numbers(&[(keys::controller::PERIOD_S.path, period_us as f64 / 1e6)]).is_ok()
}

/// The shortest period that a rig takes, by bisection down from its own, microseconds.
fn floor_us(rig: &Rig, own: u64) -> u64 {
    let (mut refused, mut taken) = (0, own);
    while taken - refused > 1 {
        let middle = refused.midpoint(taken);
        if takes(rig, middle) { taken = middle } else { refused = middle }
    }
    taken
}

#[cfg(test)]
mod tests {
    use super::super::servo_b as rig;
    use super::*;

    fn floor_ms(settings: &[&str]) -> f64 {
        measure(&rig(settings)).expect("any rig has a period").figures[0].value().expect("a figure")
    }

    #[test]
    fn a_period_must_be_longer_than_the_delay_of_the_output_and_the_microsecond_in_which_that_is_late() {
        assert!((floor_ms(&[]) - 0.502).abs() < 1e-12, "C(26) is 0.5 ms");
        assert!((floor_ms(&["controller.delay_s=0.00028"]) - 0.282).abs() < 1e-12);
    }

    #[test]
    fn a_quick_controller_has_the_shortest_period_of_its_parameter() {
        assert!((floor_ms(&["controller.delay_s=0.00002"]) - 0.1).abs() < 1e-12);
    }

    /// `direction_setup_us` and `pulse_width_us` come one after the other within a period.
    #[test]
    fn a_stepper_needs_time_for_its_pulse() {
        let slow =
            ["operator.model=stepper", "operator.pulse_width_us=600", "operator.direction_setup_us=100"];
        assert!((floor_ms(&slow) - 0.701).abs() < 1e-12);
    }
}
