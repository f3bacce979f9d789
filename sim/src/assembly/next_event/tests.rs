//! The events of random spools, against a search that looks at their guards.

use super::*;
use crate::assembly::build;
use crate::component::operator::Request;
use crate::values::Rig;
use proptest::prelude::*;

/// s.
const PERIOD: f64 = 1.3e-3;

fn assembly(settings: &[(&str, f64)]) -> (Assembly, StateVector) {
    let model = ["operator.model=solenoid", "valve.flow_force=none"].map(str::to_owned);
    let settings = settings.iter().map(|(key, value)| format!("{key}={value:?}"));
    let rig = Rig::read_with("test", "", &settings.chain(model).collect::<Vec<_>>()).expect("valid");
    let (parts, x) = build::drive(&rig);
    (Assembly::new(parts, &x), x)
}

/// Whether a guard of the spool is negative just after `t`.
fn is_crossed(assembly: &Assembly, event: Event, t: f64, x: &StateVector) -> bool {
    let Event::Guard(guard) = event else { return false };
    let value = |ahead: f64| assembly.spool_guards(t + ahead, x, 0.0)[guard - guard::SPOOL];
    [1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7].into_iter().any(|ahead| value(ahead) < 0.0)
}

/// Both searches find the same, unless the looks have missed an event.
fn check(assembly: &Assembly, t: f64, x: &StateVector, clear: StepLimit) -> Result<StepLimit, TestCaseError> {
    let [known, looked] = [assembly.spool_event(t, x, clear), assembly.searched_event(t, x, clear)];
    if known.event == looked.event {
        let apart = (known.until - looked.until).abs();
        prop_assert!(apart <= 1e-15 + 1e-12 * (clear.until - t), "{apart:e} s: {known:?} {looked:?}");
    } else {
        prop_assert!(known.until < looked.until, "{known:?} {looked:?}");
        let event = known.event.expect("an event");
        prop_assert!(is_crossed(assembly, event, known.until, x), "{known:?} {looked:?}");
    }
    Ok(known)
}

/// Requests at random, and all events between them; how many there are.
fn follow(settings: &[(&str, f64)], counts: &[i16]) -> Result<u32, TestCaseError> {
    let (mut assembly, mut x) = assembly(settings);
    let (mut t, mut events) = (0.0, 0);
    for (sample, &counts) in (1_u32..).zip(counts) {
        assembly.drive(t, &mut x, Request { counts, step: 0 });
        let end = PERIOD * f64::from(sample);
        while t < end {
            let time_event = StepLimit { until: assembly.next_time_event(t), event: Some(Event::Time) };
            let clear = time_event.within(end).within(t + assembly.parts.operator.max_step());
            // In a stop nothing is known beforehand.
            if !assembly.parts.operator.has_closed_form() {
                return Ok(events);
            }
            let next = check(&assembly, t, &x, clear)?;
            t = next.until;
            if let Some(event) = next.event {
                assembly.handle_event(event, t, &mut x);
                events += 1;
            }
        }
    }
    Ok(events)
}

#[test]
fn a_spool_under_the_dither_of_the_thesis_has_events_all_the_time() {
    let counts: Vec<i16> = (0..60).map(|i| 90 * (i % 10)).collect();
    let events = follow(&[], &counts).expect("the same events");
    assert!(events > 25, "{events}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn what_is_known_of_a_spool_is_what_its_guards_say(
        (mass, damping, spring) in (0.005..0.1, 0.0..60.0, 10.0..50.0),
        (coulomb, stiction) in prop_oneof![Just((0.0, 0.0)), (0.0..3.0, Just(0.0)), (0.0..3.0, 0.0..2.0)],
        (amplitude, frequency, hysteresis) in (0.0..0.4, 30.0..300.0, 0.5..10.0),
        underlap in -0.1..0.1,
        counts in prop::collection::vec(-1500_i16..1500, 60),
    ) {
        follow(&[
            ("operator.spool_mass_kg", mass),
            ("operator.damping_n_s_per_m", damping),
            ("operator.spring_n_per_mm", spring),
            ("operator.coulomb_friction_n", coulomb),
            ("operator.static_friction_n", coulomb + stiction),
            ("operator.dither_mm", amplitude),
            ("operator.dither_hz", frequency),
            ("operator.hysteresis_percent", hysteresis),
            ("valve.underlap_mm", underlap),
        ], &counts)?;
    }
}
