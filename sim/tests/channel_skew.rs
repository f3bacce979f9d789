//! One converter reads the channels of a sample one after the other (5.3.1, `sensors.channel_skew_s`).

use pneudrive_controller::Command;
use pneudrive_sim::follow::{Reading, Timing, follow};
use pneudrive_sim::plant::{Accuracy, Plant};
use pneudrive_sim::{Rig, run};

const PERIOD_S: f64 = 1.3e-3;
const TIMING: Timing = Timing { period_us: 1300, delay_us: 500 };

/// Chamber 2 of a piston that nothing can move, filled from the supply through a wide-open land without clearance: the
/// flow is choked up to 311 kPa. Without tubes, upstream Mach numbers and flow nodes it is that of 6.39.
const FILLED: &str = "
[controller]
loop = \"open\"
[operator]
model = \"on-off\"
[valve]
model = \"single-restriction\"
spool_diameter_mm = 10.0
[tubing]
model = \"none\"
[load]
static_extend_n = 1e5
static_retract_n = 1e5
[test]
position_m = 0.1
pressure_1_pa = 150000
pressure_2_pa = 150000
";

fn rig(text: &str, skew_s: f64) -> Rig {
    let skew = [format!("sensors.channel_skew_s={skew_s:?}")];
    Rig::read_with("skewed", text, &skew).expect("a valid rig")
}

fn readings(rig: &Rig, counts: i16, samples: usize) -> Vec<Reading> {
    let command = Command { counts, step: 0, drive_enable: true };
    follow(rig, Accuracy::default(), TIMING, &vec![command; samples]).expect("a transient")
}

/// dP/dt = n R T m / V with m = C_d A P_s sqrt(n / (R T)) (2 / (n+1))^((n+1) / (2 (n-1))): the second pressure of a sample
/// is that of one skew later.
#[test]
fn a_pressure_on_a_ramp_is_read_ahead_by_its_slope_times_the_skew() {
    let [n, r, t] = [1.4_f64, 286.76, 294.0];
    // pi D x, and pi/4 (D^2 - d^2) (L - y) with the dead volume behind it.
    let area = std::f64::consts::PI * 10e-3 * 1e-3;
    let volume = 2e-5 + std::f64::consts::FRAC_PI_4 * (0.05_f64.powi(2) - 0.025_f64.powi(2)) * 0.2;
    let flux = 589e3 * (n / (r * t)).sqrt() * (2.0 / (n + 1.0)).powf((n + 1.0) / (2.0 * (n - 1.0)));
    let slope = n * r * t * 0.8 * area * flux / volume;
    let filled = |skew| readings(&rig(FILLED, skew), -2048, 10);
    let together = filled(0.0);
    for skew in [50e-6, 100e-6, 249e-6] {
        for (k, (at_once, skewed)) in together.iter().zip(filled(skew)).enumerate().skip(1) {
            assert!(at_once.pressures[1] < 311e3, "sample {k} is no longer choked: {at_once:?}");
            let ahead = skewed.pressures[1] - at_once.pressures[1];
            // A nanosecond is 0.013 Pa.
            let by_hand = slope * skew;
            assert!((ahead - by_hand).abs() < 0.01, "sample {k}, {skew} s: {ahead} Pa, not {by_hand} Pa");
            assert_eq!(skewed.position, at_once.position, "the encoder is latched at the sample");
            assert_eq!(skewed.pressures[0], at_once.pressures[0], "the first channel is read at the sample");
        }
    }
}

/// The plant knows each instant between two samples: what the channels read is what it shows there, and reading it leaves
/// no trace in it.
#[test]
fn each_channel_reads_the_plant_at_its_own_instant() {
    let text = "[controller]\nloop = \"open\"\n";
    let skewed = rig(text, 100e-6);
    let mut plant = Plant::new(&rig(text, 0.0), Accuracy::default(), 0);
    for (k, reading) in readings(&skewed, 700, 60).into_iter().enumerate() {
        // How far steps go depends on it: it is known before somebody looks, as in a run.
        plant.command(Command { counts: 700, step: 0, drive_enable: true });
        let [now, second, third] =
            [0.0, 100e-6, 200e-6].map(|later| plant.look(k as f64 * PERIOD_S + later).expect("a look"));
        assert!((reading.position - now.position).abs() < 1e-12, "sample {k}");
        assert!((reading.pressures[0] - now.pressures[0]).abs() < 1e-4, "sample {k}");
        assert!((reading.pressures[1] - second.pressures[1]).abs() < 1e-4, "sample {k}");
        assert!((reading.spool - third.spool).abs() < 1e-12, "sample {k}");
        plant.next_sample().expect("a sample");
    }
}

/// The gain profile uses no pressure, so its transient is the same whenever they are read; what is recorded of them is not.
#[test]
fn a_loop_over_the_encoder_does_not_feel_the_skew() {
    let of = |skew| run(&rig("[test]\nduration_s = 0.6\n", skew), Accuracy::default()).expect("a run");
    let (together, skewed) = (of(0.0), of(100e-6));
    assert_eq!(together.rows.len(), skewed.rows.len());
    for (one, other) in together.rows.iter().zip(&skewed.rows) {
        assert_eq!(one.plant, other.plant, "at {} s", one.time);
    }
    let pressures =
        |run: &pneudrive_sim::Run| run.observations.iter().map(|seen| seen.pressure_2).collect::<Vec<_>>();
    assert_ne!(pressures(&together), pressures(&skewed), "the second pressure is another reading");
}

#[test]
fn a_skew_must_leave_time_for_all_channels_before_the_output() {
    for (skew, is_valid) in [("0.000249", true), ("0.00025", false), ("0.0001005", false)] {
        let read = Rig::read_with("skewed", "", &[format!("sensors.channel_skew_s={skew}")]);
        assert_eq!(read.is_ok(), is_valid, "{skew}: {:?}", read.err());
    }
    let continuous = ["controller.model=\"continuous\"", "sensors.channel_skew_s=0.0001"].map(str::to_owned);
    assert!(Rig::read_with("skewed", "", &continuous).is_err(), "it acts at once");
}
