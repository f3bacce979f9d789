//! The approach of a drive to the start of a test. A test runs from the place that it was designed for. A drive that
//! stands elsewhere goes there slowly, after a question.

use anyhow::{Result, bail};
use pneudrive_session::slow_move::GO_MM_PER_S;
use pneudrive_sim::Rig;
use pneudrive_sim::component::controller::{Loop, keys as controller};
use pneudrive_sim::keys;
use serde_json::{Value, json};

/// A drive this near to the start counts as there, mm.
const NEAR_MM: f64 = 1.0;

/// How far it may have crept since it was found at the start, mm.
const CREPT_MM: f64 = 3.0;

/// How far from the start its approach may end, mm.
const REACHED_MM: f64 = 5.0;

/// How far it may stand from the place that the question named, mm.
const MOVED_MM: f64 = 20.0;

/// Where a drive stands, and where its test starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// Where it stands.
    pub from_mm: f64,
    /// Where the test starts.
    pub to_mm: f64,
}

impl Approach {
    /// The approach from a place to the start of a rig's test. None in open loop, where a test starts wherever the drive
    /// stands.
    pub fn of(rig: &Rig, from_mm: f64) -> Option<Approach> {
        let to_mm = 1e3 * rig.get(&keys::test::POSITION_M);
        (rig.get(&controller::LOOP) == Loop::Closed).then_some(Approach { from_mm, to_mm })
    }

    fn length_mm(&self) -> f64 {
        (self.to_mm - self.from_mm).abs()
    }

    /// The question for the user; null if there is none.
    pub fn question(&self) -> Value {
        if self.length_mm() <= NEAR_MM {
            return Value::Null;
        }
        let Approach { from_mm, to_mm } = self;
        let text = format!(
            "The drive stands at {from_mm:.1} mm, and the test starts at {to_mm:.1} mm. It first goes there at {GO_MM_PER_S:.0} mm/s, {:.1} mm in {:.1} s; then the test runs.",
            self.length_mm(),
            self.length_mm() / GO_MM_PER_S
        );
        json!({ "from_mm": from_mm, "to_mm": to_mm, "text": text })
    }

    /// Whether the drive has to approach the start first. `agreed_mm`: where it stood when the page agreed to that, mm.
    ///
    /// # Errors
    /// When the page has not agreed to it.
    pub fn is_to_go(&self, agreed_mm: Option<f64>) -> Result<bool> {
        let Approach { from_mm, to_mm } = self;
        match agreed_mm {
            None if self.length_mm() <= CREPT_MM => Ok(false),
            None => bail!(
                "not run: the drive stands at {from_mm:.1} mm and the test starts at {to_mm:.1} mm; run it again and agree that it goes there"
            ),
            Some(agreed_mm) if (agreed_mm - from_mm).abs() > MOVED_MM => bail!(
                "not run: the drive stood at {agreed_mm:.1} mm when you were asked and stands at {from_mm:.1} mm now; run it again"
            ),
            Some(_) => Ok(self.length_mm() > NEAR_MM),
        }
    }

    /// Refuses the test of a drive whose approach has ended elsewhere.
    pub fn check_end(&self) -> Result<()> {
        if self.length_mm() <= REACHED_MM {
            return Ok(());
        }
        bail!(
            "not run: the drive came to {:.1} mm, and the test starts at {:.1} mm; it holds there",
            self.from_mm,
            self.to_mm
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn approach(from_mm: f64) -> Approach {
        let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
        Approach::of(&rig, from_mm).expect("a closed loop")
    }

    #[test]
    fn a_drive_at_the_start_has_nothing_to_ask_and_one_that_crept_nowhere_to_go() {
        assert_eq!(approach(98.7).question(), Value::Null);
        assert!(!approach(101.0).is_to_go(None).expect("it crept"));
        assert!(!approach(98.7).is_to_go(Some(101.0)).expect("it crept back"));
    }

    #[test]
    fn an_approach_is_asked_for_in_mm_and_mm_per_s_and_made_once_the_page_agrees() {
        let question = approach(150.0).question();
        let text = question["text"].as_str().expect("a text");
        assert!(text.contains("stands at 150.0 mm") && text.contains("starts at 98.7 mm"), "{text}");
        assert!(text.contains("50 mm/s, 51.3 mm in 1.0 s"), "{text}");
        assert!(approach(150.0).is_to_go(None).is_err(), "nobody has agreed");
        assert!(approach(150.0).is_to_go(question["from_mm"].as_f64()).expect("agreed"));
        assert!(approach(200.0).is_to_go(Some(150.0)).is_err(), "it stands elsewhere now");
    }

    #[test]
    fn a_test_is_not_run_by_a_drive_that_has_not_come_to_its_start() {
        assert!(approach(97.0).check_end().is_ok() && approach(80.0).check_end().is_err());
    }

    #[test]
    fn an_open_loop_starts_wherever_the_drive_stands() {
        let rig = Rig::read("open", "[controller]\nloop = \"open\"\n").expect("a rig");
        assert_eq!(Approach::of(&rig, 10.0), None);
    }
}
