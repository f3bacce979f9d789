//! The integer law against an independent model of it in f64, over a grid with the edges of every
//! range. All values stay below 2^53, so the oracle is exact and so is the comparison.

use crate::bench::{ControllerBench, WIDE, changed};
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Parameters, Sample};

/// n_DAC2 of Appendix IX (a) to (d), in real numbers, with a quasi-transient pressure difference n_q fed back.
fn oracle(parameters: &Parameters, setpoint: f64, positions: &[f64], n_q: f64) -> f64 {
    let get = |id| f64::from(parameters.get(id).expect("known id"));
    let n = |back: f64| {
        let k = positions.len() as f64 - 1.0 - back;
        positions[if k < 0.0 { 0 } else { k as usize }]
    };
    let (wv, wa) = (get(id::VELOCITY_WINDOW_SAMPLES), get(id::ACCELERATION_WINDOW_SAMPLES));
    let n_p = setpoint - n(0.0);
    let n_v = n(0.0) - n(wv);
    let n_a = n_v - (n(wa) - n(wa + wv));
    let index = (n_p.abs() / get(id::PROFILE_SPAN_COUNTS)).floor().min(255.0);
    let gain = match get(id::LAW) {
        0.0 => get(id::GAIN_PROFILE + index as u16),
        _ => get(id::PROPORTIONAL_GAIN),
    };
    let n_v_used = if n_v.abs() < get(id::VELOCITY_DEAD_BAND) { 0.0 } else { n_v };
    let raw = gain * n_p
        - get(id::VELOCITY_GAIN) * n_v_used
        - get(id::ACCELERATION_GAIN) * n_a
        - get(id::PRESSURE_DAMPING_GAIN) * n_q;
    let saturated = raw.clamp(f64::from(i32::MIN), f64::from(i32::MAX));
    let across = if get(id::LAW) == 2.0 { get(id::DEAD_ZONE_COUNTS) * sign(n_p) } else { 0.0 };
    let demand = if n_p.abs() < get(id::DEAD_BAND_COUNTS) {
        0.0
    } else {
        (saturated / get(id::SCALE)).trunc() + across
    };
    (demand + get(id::NULL_OFFSET_COUNTS)).clamp(-2048.0, 2048.0)
}

fn sign(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.signum() }
}

/// Runs the controller over the positions and compares every command with the oracle's.
fn agree(changes: &[(u16, i32)], setpoint: i32, positions: &[i32]) {
    let changes = [WIDE.as_slice(), changes].concat();
    let parameters = changed(&changes);
    let mut bench = ControllerBench::running(&changes, &[(0, setpoint)]);
    let mut history = Vec::new();
    for &position in positions {
        history.push(f64::from(position));
        let expected = oracle(&parameters, f64::from(setpoint), &history, 0.0);
        let counts = bench.take(Sample { position, ..Sample::default() });
        assert_eq!(f64::from(counts), expected, "{changes:?}, setpoint {setpoint}, positions {history:?}");
    }
}

/// Errors around every edge of the profile, and far beyond it.
fn errors() -> Vec<i32> {
    let mut errors: Vec<i32> = (-60..=60).collect();
    for edge in [255 * 4, 256 * 4, 2048, 65_536, 8_388_607, 500_000_000] {
        errors.extend([edge - 1, edge, edge + 1, -edge - 1, -edge, -edge + 1]);
    }
    errors
}

#[test]
fn the_gain_profile_law_is_appendix_ix_at_rest() {
    for error in errors() {
        agree(&[], 8192 + error, &[8192]);
        agree(&[(id::SCALE, 65_536)], 8192 + error, &[8192]);
    }
}

#[test]
fn the_proportional_law_is_one_gain() {
    for error in errors() {
        for gain in [0, 1, 300, 65_535] {
            agree(&[(id::LAW, 1), (id::PROPORTIONAL_GAIN, gain)], error, &[0]);
        }
    }
}

/// Moore's law is the proportional one and a step across the dead zone of the valve.
#[test]
fn moores_law_steps_across_the_dead_zone_in_the_direction_of_the_error() {
    for error in errors() {
        for (gain, dead_zone) in [(0, 102), (300, 102), (300, 0), (65_535, 2048)] {
            let moore = [(id::LAW, 2), (id::PROPORTIONAL_GAIN, gain), (id::DEAD_ZONE_COUNTS, dead_zone)];
            agree(&moore, error, &[0]);
        }
        agree(&[(id::LAW, 2), (id::DEAD_BAND_COUNTS, 10), (id::NULL_OFFSET_COUNTS, 7)], error, &[0]);
    }
}

/// The relay in real numbers: s, and which way it is switched.
fn relay(side: f64, s: f64, dead_zone: f64, hysteresis: f64) -> f64 {
    let now = sign(s);
    match s.abs() {
        s if s >= dead_zone => now,
        s if now == side && s >= (dead_zone - hysteresis).max(0.0) => now,
        _ => 0.0,
    }
}

/// q less its mean, which forgets in 64 samples, in real numbers.
#[derive(Default)]
struct QuasiTransient {
    /// 64 times the mean.
    sum: Option<f64>,
}

impl QuasiTransient {
    fn take(&mut self, [pressure_1, pressure_2]: [i16; 2]) -> f64 {
        let q = f64::from(pressure_1) - f64::from(pressure_2);
        let sum = self.sum.get_or_insert(64.0 * q);
        *sum += q - (*sum / 64.0).floor();
        q - (*sum / 64.0).floor()
    }
}

/// Pressures that rise and fall again and again, raw.
fn pressures(k: i32) -> [i16; 2] {
    [2000 + (k * 7) % 300, 2000 - (k * 11) % 200].map(|raw| raw as i16)
}

/// Thesis 9.1.2, on a path through the dead band with every direction of velocity and pressure.
#[test]
fn every_law_with_a_gain_damps_by_the_quasi_transient_pressure() {
    for (law, gain) in [(0, 0), (0, 900), (1, 900), (2, 65_535)] {
        let changes = [
            (id::LAW, law),
            (id::PROPORTIONAL_GAIN, 300),
            (id::VELOCITY_GAIN, 100),
            (id::DEAD_BAND_COUNTS, 5),
            (id::PRESSURE_DAMPING_GAIN, gain),
        ];
        let changes = [WIDE.as_slice(), &changes].concat();
        let (parameters, mut transient) = (changed(&changes), QuasiTransient::default());
        let (mut controller, mut history) = (ControllerBench::running(&changes, &[(0, 0)]), Vec::new());
        for k in 0..400 {
            let position = ((f64::from(k) / 20.0).sin() * 30.0).trunc();
            history.push(position);
            let [pressure_1, pressure_2] = pressures(k);
            let n_q = transient.take([pressure_1, pressure_2]);
            let position = position as i32;
            let counts = controller.take(Sample { position, pressure_1, pressure_2, ..Sample::default() });
            assert_eq!(f64::from(counts), oracle(&parameters, 0.0, &history, n_q), "law {law}, k {k}");
        }
    }
}

/// Burrows' law on a path with every direction of error, velocity and pressure.
#[test]
fn the_on_off_law_is_a_relay_on_position_velocity_and_quasi_transient_pressure() {
    for (dead_zone, hysteresis, scale) in [(0, 0, 256), (8, 0, 256), (8, 3, 256), (40, 60, 1)] {
        let changes = [
            (id::LAW, 3),
            (id::PROPORTIONAL_GAIN, 256),
            (id::VELOCITY_GAIN, 100),
            (id::ACCELERATION_GAIN, 0),
            (id::DEAD_BAND_COUNTS, dead_zone),
            (id::RELAY_HYSTERESIS_COUNTS, hysteresis),
            (id::SCALE, scale),
        ];
        let changes = [WIDE.as_slice(), &changes].concat();
        let (mut controller, mut history) = (ControllerBench::running(&changes, &[(0, 0)]), vec![0.0; 5]); // at 0 before k = 0
        let (mut side, mut transient) = (0.0, QuasiTransient::default());
        for k in 0..400 {
            let position = (f64::from(k) / 20.0).sin() * 30.0;
            let [pressure_1, pressure_2] = pressures(k);
            history.push(position.trunc());
            let n_q = transient.take([pressure_1, pressure_2]);
            let (n, before) = (history[history.len() - 1], history[history.len() - 6]);
            let s = ((-256.0 * n - 100.0 * (n - before) - 775.0 * n_q) / f64::from(scale)).trunc();
            side = relay(side, s, f64::from(dead_zone), f64::from(hysteresis));
            let position = position.trunc() as i32;
            let counts = controller.take(Sample { position, pressure_1, pressure_2, ..Sample::default() });
            assert_eq!(f64::from(counts), side * 2048.0, "k {k}, s {s}");
        }
    }
}

#[test]
fn velocity_and_acceleration_are_fed_back_while_moving() {
    let path: Vec<i32> = (0..40).map(|k: i32| 8192 + 3 * k + k * k - k * k * k / 50).collect();
    for gains in [(0, 0), (1, 1), (1000, 0), (0, 1000), (65_535, 65_535)] {
        for windows in [(5, 3), (1, 1), (63, 63), (2, 9)] {
            agree(
                &[
                    (id::VELOCITY_GAIN, gains.0),
                    (id::ACCELERATION_GAIN, gains.1),
                    (id::VELOCITY_WINDOW_SAMPLES, windows.0),
                    (id::ACCELERATION_WINDOW_SAMPLES, windows.1),
                ],
                9000,
                &path,
            );
        }
    }
}

#[test]
fn dead_bands_and_the_null_offset_act_at_their_edges() {
    for error in -12..=12 {
        for offset in [-2048, -5, 0, 7, 2048] {
            agree(&[(id::DEAD_BAND_COUNTS, 10), (id::NULL_OFFSET_COUNTS, offset)], error, &[0]);
        }
    }
    let creeping: Vec<i32> = (0..30).collect();
    for dead_band in [0, 4, 5, 6] {
        agree(&[(id::VELOCITY_DEAD_BAND, dead_band), (id::VELOCITY_GAIN, 500)], 100, &creeping);
    }
}

#[test]
fn the_ends_of_every_range_saturate_and_do_not_overflow() {
    let jumps = [0, i32::MAX, i32::MIN + 1, i32::MAX, 0, 1, -1, i32::MIN + 1];
    for setpoint in [i32::MIN + 1, -1, 0, i32::MAX] {
        for scale in [1, 256, i32::MAX] {
            agree(
                &[(id::LAW, 1), (id::PROPORTIONAL_GAIN, 1), (id::SCALE, scale)],
                setpoint.clamp(-1_000_000_000, 1_000_000_000),
                &jumps.map(|j| j / 4),
            );
        }
    }
}
