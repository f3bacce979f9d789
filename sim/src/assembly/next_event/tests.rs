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

/// Most events in a period of a spool that gets on: its dither may have five cycles in one, with ten events in each.
const MAX_EVENTS: u32 = 100;

/// The guard of an event at `t`.
fn guard_at(assembly: &Assembly, event: Option<Event>, t: f64, x: &StateVector) -> f64 {
    match event {
        Some(Event::Guard(guard)) => assembly.spool_guards(t, x, 0.0)[guard - guard::SPOOL],
        _ => f64::INFINITY,
    }
}

/// Whether a guard of the spool is below zero just after `t`, by more than rounding.
fn is_crossed(assembly: &Assembly, event: Option<Event>, t: f64, x: &StateVector) -> bool {
    let ahead = [1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7];
    ahead.into_iter().any(|ahead| guard_at(assembly, event, t + ahead, x) < -rounding(t))
}

/// Both searches find the same, unless the looks have missed an event, or take a touch that is rounded below zero for one.
fn check(assembly: &Assembly, t: f64, x: &StateVector, clear: StepLimit) -> Result<StepLimit, TestCaseError> {
    let (known, looked) = (assembly.spool_event(t, x), assembly.searched_event(t, x, clear));
    let known = if known.until < clear.until { known } else { clear };
    if known.event == looked.event {
        let apart = (known.until - looked.until).abs();
        // A guard with a small slope is zero for longer than that.
        let zeros = [known, looked].map(|found| guard_at(assembly, found.event, found.until, x).abs());
        let same =
            apart <= 1e-15 + 1e-12 * (clear.until - t) || zeros.iter().all(|zero| *zero <= rounding(t));
        prop_assert!(same, "{apart:e} s, {zeros:?}: {known:?} {looked:?}");
    } else {
        let first = if known.until < looked.until { known } else { looked };
        let crossed = is_crossed(assembly, first.event, first.until, x);
        prop_assert!(crossed == (first == known), "{known:?} {looked:?}");
    }
    Ok(known)
}

/// An event of the spool's guards, and when it comes.
type Passed = (Event, f64);

/// Requests at random, and all events of the spool between them, with a look at each branch of the hysteresis.
fn follow(settings: &[(&str, f64)], counts: &[i16]) -> Result<Vec<Passed>, TestCaseError> {
    let (mut assembly, mut x) = assembly(settings);
    let (mut t, mut events, mut passed) = (0.0, 0, Vec::new());
    for (sample, &counts) in (1_u32..).zip(counts) {
        assembly.drive(t, &mut x, Request { counts, step: 0 });
        let (end, before) = (PERIOD * f64::from(sample), events);
        while t < end {
            prop_assert!(events - before <= MAX_EVENTS, "at {t} s");
            let time_event = StepLimit { until: assembly.next_time_event(t), event: Some(Event::Time) };
            let clear = time_event.within(end).within(t + assembly.parts.operator.max_step());
            // In a stop nothing is known beforehand.
            if !assembly.parts.operator.has_closed_form() {
                return Ok(passed);
            }
            let next = check(&assembly, t, &x, clear)?;
            t = next.until;
            if let Some(event) = next.event {
                assembly.handle_event(event, t, &mut x);
                events += 1;
                passed.extend(matches!(event, Event::Guard(_)).then_some((event, t)));
            }
        }
    }
    Ok(passed)
}

/// The same as the integrator has it: branches that move nothing end no step.
fn follow_steps(settings: &[(&str, f64)], counts: &[i16]) -> Vec<Passed> {
    let (mut assembly, mut x) = assembly(settings);
    let (mut t, mut passed) = (0.0, Vec::new());
    for (sample, &counts) in (1_u32..).zip(counts) {
        assembly.drive(t, &mut x, Request { counts, step: 0 });
        let end = PERIOD * f64::from(sample);
        while t < end {
            if !assembly.parts.operator.has_closed_form() {
                return passed;
            }
            let next = assembly.find_step_limit(t, &x).within(end);
            t = next.until;
            if let Some(event) = next.event {
                assembly.handle_event(event, t, &mut x);
                passed.extend(matches!(event, Event::Guard(_)).then_some((event, t)));
            }
        }
    }
    passed
}

/// Both methods find the same events, as far as a motion that is nearly at rest allows.
fn check_both_methods(settings: &[(&str, f64)], counts: &[i16]) -> Result<usize, TestCaseError> {
    let (looked, stepped) = (follow(settings, counts)?, follow_steps(settings, counts));
    for ((event, at), (other, when)) in looked.iter().zip(&stepped) {
        prop_assert!(event == other && (at - when).abs() < 1e-9, "{event:?} at {at}, {other:?} at {when}");
    }
    prop_assert_eq!(looked.len(), stepped.len());
    Ok(looked.len())
}

#[test]
fn a_spool_under_the_dither_of_the_thesis_has_events_all_the_time() {
    let counts: Vec<i16> = (0..60).map(|i| 90 * (i % 10)).collect();
    let events = check_both_methods(&[], &counts).expect("the same events");
    assert!(events > 15, "{events}");
}

/// The keys that the spool of a test has.
const KEYS: [&str; 9] = [
    "operator.spool_mass_kg",
    "operator.damping_n_s_per_m",
    "operator.spring_n_per_mm",
    "operator.coulomb_friction_n",
    "operator.static_friction_n",
    "operator.dither_mm",
    "operator.dither_hz",
    "operator.hysteresis_percent",
    "valve.underlap_mm",
];

fn settings(values: [f64; KEYS.len()]) -> [(&'static str, f64); KEYS.len()] {
    std::array::from_fn(|i| (KEYS[i], values[i]))
}

/// Its stiction is its Coulomb friction: it breaks away without more force than holds it back, and its speed is less than
/// what rounding leaves open of it.
#[test]
fn a_spool_that_breaks_away_without_a_surplus_of_force_gets_on() {
    let settings = settings([
        0.019466369930507734,
        19.551723881100788,
        41.21408550965621,
        2.81287833040538,
        2.81287833040538,
        0.27142283262790035,
        229.4488644476724,
        7.726740793076571,
        0.0,
    ]);
    let counts = [
        -1279, -315, 474, -1181, -1330, 1104, -178, -213, -21, -965, -39, 616, 376, -1147, -151, 913, -101,
        -188, 80, 311, -77, -1166, 201, -165, 543, 149, 131, 333, -171, 352, -176, -140, 47, 1230, 196, -495,
        142, -650, 978, 102,
    ];
    check_both_methods(&settings, &[[0; 15].as_slice(), &counts, &[0; 5]].concat()).expect("the same events");
}

/// A move from one edge beyond the other and back, over before a look at it: it began at an edge, but for rounding.
#[test]
fn a_spool_that_begins_at_an_edge_passes_the_other_one_for_a_moment() {
    let settings = settings([
        0.022153889354345917,
        24.414097405847688,
        15.793645689881066,
        0.0,
        0.0,
        0.11090303784879625,
        57.90333995432954,
        8.204460732989267,
        -0.01531569369086547,
    ]);
    let counts = [
        -220, 752, -35, -977, 298, 90, -443, 90, 335, 85, -644, -107, 139, -363, -25, -43, -401, -366, 68,
        -145, 0, -339, 281, 0, 0, 0, 0, -423, -1110, -274, -14, 246, -733, -17, 498, 139, 1002, 47, -1048, 5,
        -595, 409, -921, -619, 705, -1434,
    ];
    check_both_methods(&settings, &counts).expect("the same events");
}

/// Without hysteresis a dither alone breaks the spool away where it exceeds the stiction.
#[test]
fn a_held_spool_without_hysteresis_breaks_away_where_the_dither_exceeds_its_stiction() {
    let (stiction, spring, dither, hertz) = (2.0, 25.0, 0.26, 100.0);
    // A null that drifts takes nothing from that.
    for drift in [0.0, 0.01] {
        let (assembly, x) = assembly(&[
            ("operator.static_friction_n", stiction),
            ("operator.coulomb_friction_n", 1.0),
            ("operator.spring_n_per_mm", spring),
            ("operator.dither_mm", dither),
            ("operator.dither_hz", hertz),
            ("operator.hysteresis_percent", 0.0),
            ("valve.underlap_mm", 0.05),
            ("valve.null_drift_mm_per_h", drift),
        ]);
        let found = assembly.spool_event(0.0, &x);
        let expected = (stiction / (spring * dither)).asin() / (2.0 * std::f64::consts::PI * hertz);
        assert!((found.until - expected).abs() < 1e-12, "{found:?} {expected}");
    }
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
        check_both_methods(&settings([
            mass, damping, spring, coulomb, coulomb + stiction, amplitude, frequency, hysteresis, underlap,
        ]), &counts)?;
    }
}
