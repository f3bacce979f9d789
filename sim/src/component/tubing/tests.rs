//! The tests of every kind of tube.

use super::*;
use pneudrive_solver::bracketed_root;

const AIR: f64 = 286.76;

fn station(gas: &Gas, pressure: f64, temperature: f64) -> GasState {
    GasState { exner: gas.exner(pressure), temperature }
}

/// Pressure at the far end, Pa.
fn far_pressure(gas: &Gas, tube: &Tube, known: &GasState, flow: f64) -> f64 {
    gas.pressure(tube.far_end(known, flow).exner)
}

/// 4fL*/D as printed, VIII.2.
fn span_to_critical(n: f64, mach: f64) -> f64 {
    let square = mach * mach;
    (1.0 - square) / (n * square)
        + (n + 1.0) / (2.0 * n) * ((n + 1.0) * square / (2.0 + (n - 1.0) * square)).ln()
}

/// P/P* as printed, VIII.1.
fn over_critical(n: f64, mach: f64) -> f64 {
    ((n + 1.0) / (2.0 + (n - 1.0) * mach * mach)).sqrt() / mach
}

/// M of 4fL*/D, by bisection.
fn mach_of_span(n: f64, span: f64) -> f64 {
    let (mut low, mut high) = (1e-9, 1.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if span_to_critical(n, middle) > span { low = middle } else { high = middle }
    }
    low
}

const BORE: f64 = 0.004;

fn area() -> f64 {
    std::f64::consts::FRAC_PI_4 * BORE * BORE
}

/// T_0 of air with a static temperature.
fn stagnation(n: f64, mach: f64, temperature: f64) -> f64 {
    temperature * (1.0 + 0.5 * (n - 1.0) * mach * mach)
}

/// A pressure, and the stagnation temperature of air that passes it at a Mach number and a static temperature.
fn passing(gas: &Gas, n: f64, mach: f64, pressure: f64, temperature: f64) -> GasState {
    station(gas, pressure, stagnation(n, mach, temperature))
}

/// VIII.3 for the flow, of air with a static temperature.
fn flow_at(n: f64, mach: f64, pressure: f64, temperature: f64) -> f64 {
    mach * area() * pressure / (AIR * temperature / n).sqrt()
}

/// A pipe of the bore above with 4fL/D as told.
fn pipe(gas: &Gas, span: f64) -> Tube {
    Tube::analytical(gas, span * BORE / 0.02, BORE, 0.005)
}

fn thesis_pipe(gas: &Gas) -> Tube {
    Tube::analytical(gas, 1.0, BORE, 0.005)
}

fn kinds(gas: &Gas) -> [(&'static str, Tube); 6] {
    [
        ("empirical", Tube::empirical(gas, 0.4, 0.00465)),
        ("pipe of 1 m", thesis_pipe(gas)),
        ("pipe of 1 cm", Tube::analytical(gas, 0.01, BORE, 0.005)),
        ("pipe of 100 m", Tube::analytical(gas, 100.0, BORE, 0.02)),
        ("connector", Tube::connector(gas, 0.8, BORE)),
        ("narrow connector", Tube::connector(gas, 0.6, 0.001)),
    ]
}

/// Flows from `-most` to `most`, close together near none.
fn flows(most: f64) -> impl Iterator<Item = f64> {
    (-400..=400).map(move |i| most * (f64::from(i) / 400.0).powi(3))
}

#[test]
fn at_the_reference_flow_the_pressure_falls_by_the_slope_and_rises_for_reverse_flow() {
    let gas = Gas::new(1.4, AIR);
    let tube = Tube::empirical(&gas, 0.4, 0.00465);
    let known = station(&gas, 589e3, 294.0);
    let ratio = |flow| far_pressure(&gas, &tube, &known, flow) / 589e3;
    assert!((ratio(0.00465) - 0.6).abs() < 1e-12);
    assert!((ratio(-0.00465) - 1.0 / 0.6).abs() < 1e-12);
    assert!((ratio(0.0093) - 0.36).abs() < 1e-12, "positive for every flow");
    assert!((ratio(0.0) - 1.0).abs() < 1e-12);
}

#[test]
fn no_tube_and_a_pipe_without_length_have_no_drop() {
    let gas = Gas::new(1.4, AIR);
    let known = GasState { exner: 40.0, temperature: 294.0 };
    for tube in [Tube::none(), Tube::analytical(&gas, 0.0, BORE, 0.005)] {
        let far = tube.far_end(&known, 0.01);
        assert_eq!((far.exner, far.by_flow), (40.0, 0.0));
    }
}

/// Fanno table, n = 1.4 (EQUATIONS section 4): a pipe as long as the table's 4fL*/D ends at M = 1
/// and P*, and one as long as the difference of two lines goes from one to the other.
#[test]
fn pressures_along_a_pipe_are_those_of_the_fanno_table() {
    let table = [(0.2, 14.5333, 5.45545), (0.3, 5.29925, 3.61906), (0.5, 1.06906, 2.13809), (1.0, 0.0, 1.0)];
    let gas = Gas::new(1.4, AIR);
    for (i, &(upper_mach, upper_span, upper)) in table.iter().enumerate() {
        for &(lower_mach, lower_span, lower) in &table[i + 1..] {
            let tube = pipe(&gas, upper_span - lower_span);
            let (p, t) = (400e3, 294.0);
            let known = |mach| passing(&gas, 1.4, mach, p, t);
            let what = format!("M {upper_mach} to {lower_mach}");
            if lower_mach < 1.0 {
                let downstream =
                    far_pressure(&gas, &tube, &known(upper_mach), flow_at(1.4, upper_mach, p, t));
                assert!((downstream / p * upper / lower - 1.0).abs() < 1e-5, "{what}: {downstream}");
            }
            let upstream = far_pressure(&gas, &tube, &known(lower_mach), -flow_at(1.4, lower_mach, p, t));
            assert!((upstream / p * lower / upper - 1.0).abs() < 1e-5, "{what}: {upstream}");
        }
    }
}

/// EQUATIONS section 4: L = 1 m, f = 0.005, 4 mm, 317 kPa and a static temperature of 294 K at the inlet give 0.552
/// at 4.65 g/s.
#[test]
fn a_metre_of_tube_loses_0_448_of_the_pressure_at_the_reference_flow_of_the_thesis() {
    let gas = Gas::new(1.4, AIR);
    let mach = 0.00465 / flow_at(1.4, 1.0, 317e3, 294.0);
    let inlet = passing(&gas, 1.4, mach, 317e3, 294.0);
    let far = far_pressure(&gas, &thesis_pipe(&gas), &inlet, 0.00465);
    assert!((far / 317e3 - 0.552).abs() < 5e-4, "{}", far / 317e3);
}

/// VIII.1 to VIII.18 as printed, M by bisection, at any Mach number, length and heat-capacity ratio.
#[test]
fn the_far_pressure_is_that_of_the_printed_equations() {
    for n in [1.4, 1.3, 1.667] {
        let gas = Gas::new(n, AIR);
        for span in [1e-3, 0.05, 1.0, 5.0, 200.0] {
            let tube = pipe(&gas, span);
            for mach in [1e-3, 0.01, 0.1, 0.2, 0.3, 0.5, 0.8, 0.95, 1.0] {
                let critical = span_to_critical(n, mach);
                let known = passing(&gas, n, mach, 400e3, 294.0);
                let flow = flow_at(n, mach, 400e3, 294.0);
                for (span, flow) in [(-span, flow), (span, -flow)] {
                    // Up to the steepest fall.
                    if critical + span < 0.01 {
                        continue;
                    }
                    let far_mach = mach_of_span(n, critical + span);
                    let expected = 400e3 * over_critical(n, far_mach) / over_critical(n, mach);
                    let got = far_pressure(&gas, &tube, &known, flow * (1.0 - 1e-15));
                    assert!((got / expected - 1.0).abs() < 1e-9, "{n} {span} {mach}: {got} {expected}");
                }
            }
        }
    }
}

/// One adiabatic line has one stagnation temperature (EQUATIONS section 12): walked forward again from the far end,
/// whichever end is known, it comes to the pressure that it began with.
#[test]
fn a_pipe_walked_forward_again_gives_the_pressure_back() {
    for n in [1.4, 1.3] {
        let gas = Gas::new(n, AIR);
        for (length, t0) in [(1.0, 294.0), (0.05, 250.0), (20.0, 350.0)] {
            let tube = Tube::analytical(&gas, length, BORE, 0.005);
            for flow in [1e-9, 1e-6, 1e-4, 5e-4, 1e-3] {
                let chamber = station(&gas, 317e3, t0);
                let upstream = far_pressure(&gas, &tube, &chamber, -flow);
                let back = far_pressure(&gas, &tube, &station(&gas, upstream, t0), flow);
                assert!(
                    upstream > 317e3 * (1.0 - 1e-14) && (back / 317e3 - 1.0).abs() < 1e-9,
                    "{n} {length} {flow}: {back}"
                );
                let downstream = far_pressure(&gas, &tube, &chamber, flow);
                let back = far_pressure(&gas, &tube, &station(&gas, downstream, t0), -flow);
                assert!((back / 317e3 - 1.0).abs() < 1e-9, "{n} {length} {flow}: {back}");
            }
        }
    }
}

#[test]
fn forward_then_backward_through_a_connector_gives_the_pressure_back() {
    for n in [1.4, 1.3] {
        let gas = Gas::new(n, AIR);
        let tube = Tube::connector(&gas, 0.8, BORE);
        for flow in [1e-9, 1e-4, 0.003, 0.006, 0.0068] {
            let far = far_pressure(&gas, &tube, &station(&gas, 317e3, 294.0), flow);
            let back = far_pressure(&gas, &tube, &station(&gas, far, 294.0), -flow);
            assert!(far < 317e3 && (back / 317e3 - 1.0).abs() < 1e-12, "{n} {flow}: {far} {back}");
        }
    }
}

/// 6.58 by the flow function of the gas: the flow between the pressures found is the flow asked for.
#[test]
fn a_connector_passes_the_flow_of_a_restriction() {
    for n in [1.4, 1.3] {
        let gas = Gas::new(n, AIR);
        let tube = Tube::connector(&gas, 0.8, BORE);
        let known = station(&gas, 317e3, 294.0);
        let constant = gas.flow_constant() * (0.8 * area()).powi(2) / 294.0;
        for flow in flows(0.05) {
            let far = tube.far_end(&known, flow).exner;
            let square = if flow > 0.0 {
                gas.flow_function(known.exner, far)
            } else {
                gas.flow_function(far, known.exner)
            };
            let choking = (constant * gas.flow_function(known.exner, 0.0).value).sqrt();
            let expected = if flow > 0.0 { flow.min(choking) } else { -flow };
            let got = (constant * square.value).sqrt();
            assert!((got - expected).abs() < 1e-6 * expected + 1e-9, "{n} {flow}: {got}");
        }
    }
}

/// Newton's method and brackets ask for flows that no tube passes: the far pressure falls on, and
/// the flow at which it reaches any lower pressure is the choking flow to 0.5/s.
#[test]
fn whatever_is_behind_a_choked_tube_the_flow_is_the_choking_flow_to_half_a_percent() {
    for n in [1.4, 1.3] {
        let gas = Gas::new(n, AIR);
        let known = station(&gas, 589e3, 294.0);
        let mut cases = vec![];
        for span in [1e-3, 0.1, 5.0, 100.0] {
            let mach = mach_of_span(n, span);
            let critical = 589e3 / over_critical(n, mach);
            let temperature = 294.0 / stagnation(n, mach, 1.0);
            cases.push((pipe(&gas, span), flow_at(n, mach, 589e3, temperature), critical));
        }
        let most = gas.flow_constant() / 294.0 * gas.flow_function(known.exner, 0.0).value;
        let critical = 589e3 * (2.0 / (n + 1.0)).powf(n / (n - 1.0));
        cases.push((Tube::connector(&gas, 0.8, BORE), 0.8 * area() * most.sqrt(), critical));
        for (tube, choking, critical) in cases {
            for behind in [0.999, 0.9, 0.5, 0.1] {
                let over = |m: f64| far_pressure(&gas, &tube, &known, m) - behind * critical;
                let bracket = [(0.0, over(0.0)), (10.0 * choking, over(10.0 * choking))];
                let flow = bracketed_root(over, bracket, 1e-17);
                let error = flow / choking - 1.0;
                assert!(error.abs() < 0.5 / STEEPEST, "n {n}, flow {choking}, {behind} P*: {error}");
            }
        }
    }
}

/// EQUATIONS section 4: a known downstream end with M > 1 has its pressure raised so that M = 1.
#[test]
fn a_known_downstream_end_is_sonic_at_most() {
    for n in [1.4, 1.3] {
        let gas = Gas::new(n, AIR);
        let tube = thesis_pipe(&gas);
        let sonic = flow_at(n, 1.0, 101.3e3, 294.0 / stagnation(n, 1.0, 1.0));
        for times in [1.0 + 1e-12, 1.5, 4.0] {
            let got = far_pressure(&gas, &tube, &station(&gas, 101.3e3, 294.0), -times * sonic);
            let raised = station(&gas, times * 101.3e3, 294.0);
            let expected = far_pressure(&gas, &tube, &raised, -times * sonic * (1.0 - 1e-14));
            assert!((got / expected - 1.0).abs() < 1e-9, "{n} {times}: {got} {expected}");
        }
    }
}

#[test]
fn without_flow_both_ends_have_the_same_pressure_and_the_drop_begins_with_the_square_of_the_flow() {
    for n in [1.4, 1.3] {
        let gas = Gas::new(n, AIR);
        let known = station(&gas, 317e3, 294.0);
        for (name, tube) in &kinds(&gas)[1..] {
            for flow in [0.0, -0.0, 1e-300, -1e-300, 1e-18, -1e-18] {
                let far = tube.far_end(&known, flow);
                assert!((far.exner / known.exner - 1.0).abs() < 1e-15, "{name} {flow}: {far:?}");
                assert!(far.by_flow.abs() < 1e-6, "{name} {flow}: {far:?}");
            }
            let slope = |flow| tube.far_end(&known, flow).by_flow / flow;
            for flow in [1e-8, 1e-12] {
                assert!((slope(flow) / slope(0.5 * flow) - 1.0).abs() < 1e-3, "{name}");
                assert!((slope(flow) / slope(-flow) + 1.0).abs() < 1e-3, "{name}");
            }
        }
    }
}

/// 4fL/D of a metre of tube at a small flow: P^2 falls by n P^2 M^2 4fL/D (incompressible limit).
#[test]
fn at_a_small_flow_the_drop_is_that_of_fanning() {
    let gas = Gas::new(1.4, AIR);
    let (p, t) = (317e3, 294.0);
    let flow = flow_at(1.4, 1e-3, p, t);
    let far = far_pressure(&gas, &thesis_pipe(&gas), &passing(&gas, 1.4, 1e-3, p, t), flow);
    let fanning = 0.5 * 1.4 * p * 1e-6 * 5.0;
    assert!(((p - far) / fanning - 1.0).abs() < 1e-4, "{} {fanning}", p - far);
}

#[test]
fn the_far_pressure_falls_with_the_flow_and_stays_positive() {
    for n in [1.4, 1.3] {
        let gas = Gas::new(n, AIR);
        let known = station(&gas, 317e3, 294.0);
        for (name, tube) in kinds(&gas) {
            let mut last = f64::INFINITY;
            for flow in flows(0.1) {
                let far = tube.far_end(&known, flow);
                assert!(far.exner > 0.0 && far.exner <= last, "{name} {flow}: {far:?} after {last}");
                assert!(far.by_flow <= 0.0, "{name} {flow}: {far:?}");
                last = far.exner;
            }
        }
    }
}

/// Central differences, with a step small beside the steepest fall.
#[test]
fn slopes_over_flow_and_temperature_are_those_of_the_pressure() {
    for n in [1.4, 1.3] {
        let gas = Gas::new(n, AIR);
        let known = station(&gas, 317e3, 294.0);
        for (name, tube) in kinds(&gas) {
            for flow in flows(0.03).filter(|flow| flow.abs() > 1e-6) {
                let d = 1e-7 * flow.abs();
                let at = |flow| tube.far_end(&known, flow).exner;
                let central = (at(flow + d) - at(flow - d)) / (2.0 * d);
                let got = tube.far_end(&known, flow).by_flow;
                let scale = got.abs() + at(flow) / flow.abs() * 1e-3;
                assert!((got - central).abs() < 1e-3 * scale, "{name} {flow}: {got} {central}");
                let of = |temperature| tube.far_end(&GasState { temperature, ..known }, flow);
                let central = (of(294.0 + 1e-4).exner - of(294.0 - 1e-4).exner) / 2e-4;
                let got = if tube.feels_temperature() { of(294.0).by_temperature(flow, 294.0) } else { 0.0 };
                let scale = got.abs() + at(flow) / 294.0 * 1e-3;
                assert!((got - central).abs() < 1e-3 * scale, "{name} {flow} over T: {got} {central}");
            }
        }
    }
}

/// Where the tangent takes over: below the choking flow by less than a part in a thousand.
#[test]
fn the_fall_reaches_its_bound_unbroken_and_has_no_steeper_place() {
    for n in [1.4, 1.3] {
        let gas = Gas::new(n, AIR);
        let known = station(&gas, 317e3, 294.0);
        for (name, tube) in &kinds(&gas)[1..] {
            let steepness = |fall: f64| {
                // The flow at which the far end is below the known end's w by this part.
                let over = |m: f64| tube.far_end(&known, m).exner - known.exner * (1.0 - fall);
                let m = bracketed_root(over, [(0.0, over(0.0)), (1.0, over(1.0))], 1e-17);
                let far = tube.far_end(&known, m);
                (-far.by_flow * m / far.exner, far.by_flow)
            };
            let steepnesses: Vec<_> = (1..=4000).map(|i| steepness(f64::from(i) / 4001.0)).collect();
            // On the tangent, down to half, the elasticity grows to 2 s and the slope stays.
            let steepest = steepnesses.iter().map(|s| s.0).fold(0.0, f64::max);
            assert!(steepest > STEEPEST && steepest < 2.02 * STEEPEST, "{name} {n}: {steepest}");
            let reached = steepnesses.iter().find(|s| s.0 >= STEEPEST).expect("it chokes").1;
            let bound = steepnesses.iter().map(|s| -s.1).fold(0.0, f64::max);
            assert!((bound / -reached - 1.0).abs() < 1e-6, "{name} {n}: {bound} {reached}");
        }
    }
}

#[test]
fn states_that_are_no_numbers_give_none_and_do_not_panic() {
    let gas = Gas::new(1.4, AIR);
    for (name, tube) in &kinds(&gas)[1..] {
        for exner in [f64::NAN, -1.0] {
            for flow in [0.001, -0.001] {
                let far = tube.far_end(&GasState { exner, temperature: 294.0 }, flow);
                assert!(far.exner.is_nan() || far.exner <= 0.0, "{name}: {far:?}");
            }
        }
    }
}
