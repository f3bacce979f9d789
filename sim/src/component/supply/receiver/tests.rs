use super::*;
use crate::component::valve::iso6358::NEARLY_FULL;
use pneudrive_solver::{Derivative, Event, Integrator, Method, System};

const LINE: f64 = 7e5;
const TEMPERATURE: f64 = 293.15;

fn gas() -> Gas {
    Gas::new(1.4, 286.76)
}

fn feed(check_valve: bool) -> Feed {
    Feed::new([LINE, TEMPERATURE], 8e-9, 0.25, check_valve)
}

fn air(pressure: f64, temperature: f64) -> ChamberAir {
    let [mass, exner] = ChamberAir::state_of(&gas(), pressure, temperature, 2e-3);
    ChamberAir::of_state(&gas(), mass, exner, 2e-3)
}

fn flow(feed: &Feed, pressure: f64) -> f64 {
    feed.flow(&air(pressure, TEMPERATURE)).0
}

/// By hand: 8e-9 1.185 7e5 = 6.636 g/s, choked; r = 0.625 is half way from b to 1, so sqrt(3)/2 of it.
#[test]
fn the_line_fills_it_by_iso_6358() {
    assert!((flow(&feed(false), 1e5) - 6.636e-3).abs() < 1e-12);
    assert!((flow(&feed(false), 0.625 * LINE) - 6.636e-3 * 0.75_f64.sqrt()).abs() < 1e-12);
    let warm = feed(false).flow(&air(1e5, 400.0));
    assert!((warm.0 - 6.636e-3).abs() < 1e-12 && warm.1 == TEMPERATURE, "the line's air decides: {warm:?}");
}

#[test]
fn air_flows_back_as_it_is_unless_a_check_valve_keeps_it() {
    let hot = air(8e5, 1.21 * TEMPERATURE);
    let (back, temperature) = feed(false).flow(&hot);
    let share = (1.0 - ((0.875 - 0.25) / 0.75_f64).powi(2)).sqrt();
    assert!((back + 8e-9 * 1.185 * 8e5 / 1.1 * share).abs() < 1e-9, "{back}");
    assert!((temperature / 1.21 - TEMPERATURE).abs() < 1e-9);
    assert_eq!(feed(true).flow(&hot).0, 0.0);
}

/// Value and slope are continuous at r = 0.999, and the flow falls to 0 with a finite slope and without a jump.
#[test]
fn next_to_the_pressure_of_the_line_the_flow_goes_to_0_in_proportion() {
    for b in [0.0, 0.25, 0.5, 0.9] {
        let feed = Feed::new([LINE, TEMPERATURE], 8e-9, b, false);
        let step = 1e-9;
        let slope = |r: f64| (feed.opening.share(r + step) - feed.opening.share(r - step)) / (2.0 * step);
        let [before, after] = [-2.0 * step, 2.0 * step].map(|by| slope(NEARLY_FULL + by));
        assert!((before / after - 1.0).abs() < 1e-4, "{b}: {before} {after}");
        let shares: Vec<f64> =
            (0..=1000).map(|i| feed.opening.share(NEARLY_FULL + 1e-6 * f64::from(i))).collect();
        assert!(shares.windows(2).all(|pair| pair[1] < pair[0]) && shares[1000] == 0.0, "{b}");
        let [full, half] = [1e-6, 5e-7].map(|missing| feed.opening.share(1.0 - missing));
        assert!((full / half - 2.0).abs() < 1e-3, "{b}: in proportion");
        // Nowhere farther from the ellipse than 17.5 % of phi_1.
        let off = |r: f64| {
            (feed.opening.share(r) - feed.opening.ellipse.ellipse(r).0.sqrt()).abs()
                / feed.opening.nearly_full[0]
        };
        let most = (0..1000).map(|i| off(NEARLY_FULL + 1e-6 * f64::from(i))).fold(0.0, f64::max);
        assert!(most < 0.175, "{b}: {most}");
    }
}

/// 2 l: D = 108.4 mm, 216.8 mm long, 0.0923 m2.
#[test]
fn the_walls_are_those_of_a_closed_cylinder_twice_as_long_as_wide() {
    let area = wall_area(2e-3);
    assert!((area - 0.092_26).abs() < 1e-4, "{area}");
    let diameter = (area / (2.5 * PI)).sqrt();
    assert!((PI / 4.0 * diameter * diameter * 2.0 * diameter - 2e-3).abs() < 1e-15);
}

/// A receiver of which nothing is drawn.
struct Alone(Receiver);

impl System<2, 0, 0> for Alone {
    fn derivative(&mut self, _: f64, x: &[f64; 2]) -> [f64; 2] {
        let air = self.0.air(&gas(), *x);
        self.0.derivative(&gas(), &air, [(0.0, 0.0); 2])
    }
    fn guards(&mut self, _: f64, _: &[f64; 2]) -> [f64; 0] {
        []
    }
    fn handle_event(&mut self, _: Event, _: f64, _: &mut [f64; 2]) -> Derivative {
        Derivative::Discontinuous
    }
}

/// Its pressure (Pa) after a time (s), from a pressure on, in this many steps of one length, of which the first is approached by shorter
/// ones.
pub(in crate::component::supply) fn pressure_after(
    receiver: Receiver,
    from: f64,
    time: f64,
    steps: u32,
) -> f64 {
    let start = receiver.state_of(&gas(), from, TEMPERATURE);
    let mut integrator = Integrator::<2, 0, 0>::new(Method::Merson, 1e6, [1e-5, 1.0], start);
    for step in 1..=steps {
        let t = time * f64::from(step) / f64::from(steps);
        integrator.integrate_to(&mut Alone(receiver), t, t).expect("smooth");
    }
    receiver.air(&gas(), *integrator.state(time)).pressure
}

/// What a receiver of 2 l that empties from 7 bar into a line of half a bar has after half of tau, over the closed form
/// (sim/tests/receiver.rs), less 1.
fn off_after(steps: u32) -> f64 {
    let feed = Feed::new([5e4, TEMPERATURE], 8e-9, 0.25, false);
    let receiver =
        Receiver { volume: 2e-3, feed, regulator: None, heat_per_kelvin: 0.0, wall_temperature: TEMPERATURE };
    let tau = 2e-3 / (feed.opening.choked * 286.76 * TEMPERATURE.sqrt());
    let end = pressure_after(receiver, LINE, 0.5 * tau, steps);
    (end / (LINE * 1.1_f64.powi(-7)) - 1.0).abs()
}

#[test]
fn the_error_of_its_pressure_falls_with_the_order_of_the_method() {
    let observed = (off_after(8) / off_after(16)).log2();
    assert!((observed - 4.0).abs() < 0.2, "{observed}");
}
