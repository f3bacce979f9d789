//! The flow figures of data sheets as sonic conductance C and critical pressure ratio b (ISO 6358-1).
//!
//! ```text
//! Q  = C p_1 sqrt(T_0/T_1) f(p_2/p_1)                                 volume flow at the reference atmosphere (ANR)
//! f(r) = 1 for r <= b,   sqrt(1 - ((r - b)/(1 - b))^2) above
//! Q_n = C p_1 f(6/7),   p_1 = 7 bar, p_2 = 6 bar, both absolute, T_1 = T_0 = 20 degC
//! ```
//!
//! The nominal flow Q_n of catalogues is that from 6 to 5 bar gauge at 20 degC, in litres a minute of air at the reference
//! atmosphere (ISO 8778: 100 kPa, 20 degC, 65 % humidity). The surroundings count as 100 kPa there.

/// Pressures of the nominal flow, Pa: 6 and 5 bar above 100 kPa.
pub const NOMINAL: [f64; 2] = [7e5, 6e5];

/// A resistance to flow after ISO 6358-1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductance {
    /// C, m3/(s Pa) of air at the reference atmosphere; 1 dm3/(s bar) is 1e-8.
    pub sonic: f64,
    /// b, from 0 to below 1.
    pub critical_ratio: f64,
}

impl Conductance {
    /// From a flow (m3/s) between absolute pressures (Pa), the higher first, and the critical ratio.
    #[must_use]
    pub fn of_flow(flow: f64, [up, down]: [f64; 2], critical_ratio: f64) -> Conductance {
        let unit = Conductance { sonic: 1.0, critical_ratio };
        Conductance { sonic: flow / (up * unit.part(down / up)), critical_ratio }
    }

    /// f: the part of the choked flow that is left at a ratio of pressures.
    #[must_use]
    pub fn part(&self, ratio: f64) -> f64 {
        let beyond = ((ratio - self.critical_ratio) / (1.0 - self.critical_ratio)).max(0.0);
        (1.0 - beyond * beyond).max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: r = 6/7, (r - 0.3)/0.7 = 0.7959, f = 0.6054, C = 350/60 l/s / (7 bar 0.6054) = 1.3765 dm3/(s bar).
    #[test]
    fn a_valve_of_350_litres_a_minute_has_1_38_litres_a_second_and_bar() {
        let valve = Conductance::of_flow(350e-3 / 60.0, NOMINAL, 0.3);
        assert!((valve.sonic - 1.3765e-8).abs() < 1e-12, "{valve:?}");
    }

    #[test]
    fn below_the_critical_ratio_all_of_the_choked_flow_passes() {
        let valve = Conductance { sonic: 2e-8, critical_ratio: 0.4 };
        assert_eq!(valve.part(0.0), 1.0);
        assert_eq!(valve.part(0.4), 1.0);
        assert!((valve.part(0.7) - 0.75_f64.sqrt()).abs() < 1e-15);
        assert_eq!(valve.part(1.0), 0.0);
    }

    /// An unknown b between 0.2 and 0.5 makes C of a given nominal flow uncertain by a sixth to either side.
    #[test]
    fn what_is_not_known_of_b_is_uncertain_in_c() {
        let [low, high] = [0.2, 0.5].map(|b| Conductance::of_flow(1.0, NOMINAL, b).sonic);
        let middle = Conductance::of_flow(1.0, NOMINAL, 0.3).sonic;
        assert!(
            (low / middle - 1.06).abs() < 0.01 && (high / middle - 0.87).abs() < 0.02,
            "{} {}",
            low / middle,
            high / middle
        );
    }
}
