//! Requirements on drives with each model of the encoder.

use pneudrive_controller::Fault;
use pneudrive_sim::component::encoder::mm_per_count;
use pneudrive_sim::{Accuracy, Rig, Run, run};

/// The tuned drive B with settings, and a fault if one is told.
fn rig(settings: &[&str], event: &str) -> Rig {
    let text = pneudrive_sim::rigfile::builtin("servo-b-tuned").expect("a built-in rig");
    let text = format!("{text}\n{event}\n");
    let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
    Rig::read_with("servo-b-tuned", &text, &settings).unwrap_or_else(|problems| panic!("{problems}"))
}

fn simulate(rig: &Rig) -> Run {
    run(rig, Accuracy::of(rig)).expect("a transient")
}

/// A potentiometer on a converter of 12 bits; gains are as large a millimetre as those of the file.
const POTENTIOMETER: [&str; 8] = [
    "encoder.model=potentiometer",
    "encoder.zero_mm=-5",
    "encoder.range_mm=310",
    "controller.gain_profile=[11000, 8500, 6700, 4900, 3600, 2500, 1750, 1610]",
    "controller.profile_span_counts=1",
    "controller.velocity_gain=12500",
    "controller.acceleration_gain=25000",
    "test.moves=[[0.0, 1304], [0.3, 2608], [1.72, 1304]]",
];

/// A spool that slides freely, and a load that slides as easily as it starts: where the drive stops, the encoder decides.
const SMOOTH: [&str; 9] = [
    "operator.hysteresis_percent=0",
    "operator.dither_mm=0",
    "operator.static_friction_n=0",
    "operator.coulomb_friction_n=0",
    "load.viscous_n_s_per_m=200",
    "load.static_extend_n=15",
    "load.coulomb_extend_n=15",
    "load.static_retract_n=15",
    "load.coulomb_retract_n=15",
];

/// Furthest from the setpoint at the end of each move, counts.
fn error_at_rest(run: &Run, rig: &Rig) -> f64 {
    let ends = [(1.4, 1.72), (2.8, 3.1)];
    let at_rest = |time: f64| ends.iter().any(|(from, to)| (*from..*to).contains(&time));
    let rows = run.rows.iter().filter(|row| at_rest(row.time));
    let count = |position: f64| position * 1e3 / mm_per_count(rig);
    rows.map(|row| (count(row.plant.position) - f64::from(row.observation.setpoint)).abs())
        .fold(0.0, f64::max)
}

/// An absolute encoder that counts like a quadrature encoder changes nothing but what the axis knows at the start.
#[test]
fn with_counts_of_equal_length_the_transient_is_equal_in_every_bit() {
    let quadrature = simulate(&rig(&[], ""));
    for zero in ["encoder.zero_mm=0", "encoder.zero_mm=-6.025", "encoder.zero_mm=-24.1"] {
        let ssi = simulate(&rig(&["encoder.model=ssi", zero], ""));
        assert_eq!(ssi.bits(), quadrature.bits(), "{zero}");
        assert_eq!(ssi.observations, quadrature.observations, "{zero}");
    }
}

/// Counts of 0.076 mm and of 0.012 mm; the finer ones ask for openings of the valve that pass next to nothing.
#[test]
fn a_drive_positions_to_the_resolution_of_its_encoder() {
    let fine = ["encoder.model=ssi", "encoder.zero_mm=-5"];
    for (settings, counts) in [(&[][..], 4.0), (&fine, 4.0), (&POTENTIOMETER, 1.0)] {
        let rig = rig(&[settings, &SMOOTH].concat(), "");
        let run = simulate(&rig);
        let error = error_at_rest(&run, &rig);
        assert!(error < counts && run.fault.is_none(), "{settings:?}: {error} counts, {:?}", run.fault);
    }
}

/// As near as the file's drive comes with its quadrature encoder: of the 0.67 mm the curve makes 0.62.
#[test]
fn with_noise_and_a_curved_line_the_drive_comes_to_rest_within_a_millimetre() {
    let more = ["encoder.noise_counts=0.5", "encoder.linearity_percent=0.2"];
    let rig = rig(&[&POTENTIOMETER[..], &more].concat(), "");
    let run = simulate(&rig);
    let error = error_at_rest(&run, &rig) * mm_per_count(&rig);
    assert!(error < 1.0 && run.fault.is_none(), "{error} mm, {:?}", run.fault);
}

#[test]
fn an_absolute_reading_that_jumps_trips_as_a_fault_of_the_encoder() {
    let jump =
        |counts: i32| format!("[[faults.event]]\nkind = \"encoder-jump\"\nat_s = 0.8\ncounts = {counts}");
    for (settings, counts) in [(&POTENTIOMETER[..], 600), (&["encoder.model=ssi"], 3600)] {
        for sign in [-1, 1] {
            let tripped = simulate(&rig(settings, &jump(sign * counts))).fault;
            assert_eq!(tripped.map(|(fault, _)| fault), Some(Fault::EncoderStep), "{settings:?}");
        }
        assert_eq!(simulate(&rig(settings, "")).fault, None, "{settings:?}");
    }
}
