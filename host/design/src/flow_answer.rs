//! A flow as a data sheet states it: "350 l/min", with the pressures that it holds for as in "350 l/min, 6 to 5 bar(g)".
//!
//! Catalogues mix up three flows: the nominal flow (6 to 5 bar gauge), the flow at another pressure drop, and the free flow
//! to the surroundings, which is one and a half times as large. A flow without pressures is taken as nominal, with a remark.

use pneudrive_sim::rigfile::read_quantity;

use crate::conductance::{Conductance, NOMINAL};

/// Pressure from which the gauges of ISO 8778 count, Pa.
const REFERENCE: f64 = 1e5;

/// A flow between two pressures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StatedFlow {
    /// The flow, m3/s of air at the reference atmosphere (ANR).
    pub flow: f64,
    /// Absolute pressures in front of the valve and behind it, Pa; None if the text does not state them.
    pub pressures: Option<[f64; 2]>,
}

impl StatedFlow {
    /// The flow that a text states.
    ///
    /// # Errors
    /// The problem and the remedy.
    pub fn read(text: &str) -> Result<StatedFlow, String> {
        let (flow, conditions) = match separating_comma(text) {
            Some(place) => (&text[..place], Some(text[place + 1..].trim())),
            None => (text, None),
        };
        let flow = read_quantity(flow, "m3/s")?.value;
        Ok(StatedFlow { flow, pressures: conditions.map(pressures).transpose()? })
    }

    /// The conductance of a valve with this flow and a critical ratio b: C = Q/(p1 f(p2/p1, b)).
    #[must_use]
    pub fn conductance(&self, critical_ratio: f64) -> Conductance {
        Conductance::of_flow(self.flow, self.pressures.unwrap_or(NOMINAL), critical_ratio)
    }
}

/// The comma after the flow: a comma between two digits is a decimal sign.
fn separating_comma(text: &str) -> Option<usize> {
    let is_digit = |letter: Option<char>| letter.is_some_and(|letter| letter.is_ascii_digit());
    let between = |place: usize| {
        is_digit(text[..place].chars().next_back()) && is_digit(text[place + 1..].chars().next())
    };
    text.match_indices(',').map(|(place, _)| place).find(|&place| !between(place))
}

/// Absolute pressures of "6 to 5 bar(g)", Pa.
fn pressures(text: &str) -> Result<[f64; 2], String> {
    let form = || format!("\"{text}\": the pressures are said as in \"350 l/min, 6 to 5 bar(g)\"");
    let (up, down) = text.split_once(" to ").ok_or_else(form)?;
    let unit = down.trim_start_matches(|c: char| c.is_ascii_digit() || "., ".contains(c));
    let absolute = |text: &str| {
        let reading = read_quantity(text, "Pa").map_err(|_| form())?;
        if !reading.says_from_where {
            return Err(format!("\"{text}\" may be gauge or absolute: write {unit}(g) or {unit}(a)"));
        }
        Ok(if reading.gauge { reading.value + REFERENCE } else { reading.value })
    };
    let ends = [absolute(&format!("{} {unit}", up.trim()))?, absolute(down)?];
    if ends[0] > ends[1] && ends[1] >= 0.0 {
        Ok(ends)
    } else {
        Err(format!("\"{text}\": the pressure falls from the first to the second"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flow_with_its_pressures_counts_at_these() {
        let read = |text| StatedFlow::read(text).expect("a flow");
        let nominal = read("350 l/min, 6 to 5 bar(g)");
        assert_eq!(nominal.pressures, Some([7e5, 6e5]));
        assert_eq!(read("350 l/min").pressures, None);
        assert_eq!(read("350 l/min, 7 to 6 bar(a)").pressures, Some([7e5, 6e5]));
        assert_eq!(
            read("350 l/min (ANR), 87 to 72.5 psig").pressures.map(|ends| ends[0].round()),
            Some(699_844.0)
        );
        assert_eq!(read("0,5 l/min,6,5 to 5,5 bar(g)").pressures, Some([7.5e5, 6.5e5]));
        assert!((nominal.conductance(0.3).sonic - read("350 l/min").conductance(0.3).sonic).abs() < 1e-22);
        // Free flow is choked: C = Q/p1, 420/60 l/s / 7 bar.
        let free = read("420 l/min, 6 to 0 bar(g)").conductance(0.3);
        assert!((free.sonic * 1e8 - 1.0).abs() < 1e-12, "{free:?}");
    }

    #[test]
    fn a_flow_that_cannot_be_meant_is_refused_with_what_to_write() {
        for (text, says) in [
            ("350", "needs a unit"),
            ("350 l/min, 6 bar", "as in \"350 l/min, 6 to 5 bar(g)\""),
            ("350 l/min, 6 to 5 bar", "may be gauge or absolute"),
            ("350 l/min, 0.6 to 0.5 MPa", "write MPa(g) or MPa(a)"),
            ("350 l/min, 5 to 6 bar(g)", "falls from the first to the second"),
        ] {
            let message = StatedFlow::read(text).expect_err("refused");
            assert!(message.contains(says), "{text}: {message}");
        }
    }
}
