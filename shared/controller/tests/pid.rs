//! The law "pid" against an independent model of it in f64. All values stay below 2^53, so the model is exact and so is the
//! comparison.

use pneudrive_controller::law::{Law, Running};
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Parameters, Sample};

use crate::bench::{ControllerBench, WIDE, changed};

/// The equations of the law in real numbers.
struct PidModel<'a> {
    parameters: &'a Parameters,
    positions: Vec<f64>,
    integral: f64,
}

impl PidModel<'_> {
    fn get(&self, id: u16) -> f64 {
        f64::from(self.parameters.get(id).expect("known id"))
    }

    /// The position so many samples ago; a drive at rest stood where the first one found it.
    fn before(&self, samples: f64) -> f64 {
        let place = self.positions.len() as f64 - 1.0 - samples;
        self.positions[place.max(0.0) as usize]
    }

    fn demand(&mut self, setpoint: f64, position: f64) -> f64 {
        self.positions.push(position);
        let (wv, wa) = (self.get(id::VELOCITY_WINDOW_SAMPLES), self.get(id::ACCELERATION_WINDOW_SAMPLES));
        let error = setpoint - position;
        let velocity = position - self.before(wv);
        let acceleration = velocity - (self.before(wa) - self.before(wa + wv));
        let idle = error.abs() < self.get(id::DEAD_BAND_COUNTS);
        let fed_back = if idle {
            0.0
        } else {
            self.get(id::PROPORTIONAL_GAIN) * error
                - self.get(id::VELOCITY_GAIN) * velocity
                - self.get(id::ACCELERATION_GAIN) * acceleration
        };
        let (scale, null) = (self.get(id::SCALE), self.get(id::NULL_OFFSET_COUNTS));
        let demand = |integral: f64| {
            let sum = fed_back + (integral / 256.0).trunc();
            (sum.clamp(f64::from(i32::MIN), f64::from(i32::MAX)) / scale).trunc() + null
        };
        let band = self.get(id::INTEGRAL_BAND_COUNTS);
        if !idle && (band == 0.0 || error.abs() <= band) {
            let end = 256.0 * scale * 2048.0;
            let next = (self.integral + self.get(id::INTEGRAL_GAIN) * error).clamp(-end, end);
            let asked = demand(next);
            if asked.abs() <= 2048.0 || asked * error <= 0.0 {
                self.integral = next;
            }
        }
        demand(self.integral).clamp(-2048.0, 2048.0)
    }
}

const PID: (u16, i32) = (id::LAW, Law::Pid as i32);

fn integral(bench: &ControllerBench) -> i64 {
    let Running::Pid(pid) = bench.state.law() else { panic!("the law that was chosen") };
    pid.integral()
}

/// Runs the controller over the positions; every command and every integral is the model's.
fn agree(changes: &[(u16, i32)], setpoint: i32, positions: impl Iterator<Item = i32>) {
    let changes = [WIDE.as_slice(), &[PID], changes].concat();
    let parameters = changed(&changes);
    let mut model = PidModel { parameters: &parameters, positions: Vec::new(), integral: 0.0 };
    let mut bench = ControllerBench::running(&changes, &[(0, setpoint)]);
    for (k, position) in positions.enumerate() {
        let expected = model.demand(f64::from(setpoint), f64::from(position));
        let counts = bench.take(Sample { position, ..Sample::default() });
        assert_eq!(f64::from(counts), expected, "{changes:?}, setpoint {setpoint}, sample {k}");
        assert_eq!(integral(&bench) as f64, model.integral, "{changes:?}, setpoint {setpoint}, sample {k}");
    }
}

/// Errors around every edge, and far beyond it.
#[test]
fn the_law_is_its_equation_over_the_ranges_of_error_and_gains() {
    for error in [0, 1, -1, 7, -8, 59, 2048, -65_536, 8_388_607, -500_000_000] {
        for (gain, integral_gain) in [(0, 0), (0, 1), (300, 0), (300, 90), (65_535, 65_535)] {
            for (scale, null) in [(1, 0), (256, 7), (65_536, -2048)] {
                let gains = [(id::PROPORTIONAL_GAIN, gain), (id::INTEGRAL_GAIN, integral_gain)];
                let rest = [(id::SCALE, scale), (id::NULL_OFFSET_COUNTS, null)];
                agree(&[gains, rest].concat(), error, std::iter::repeat_n(0, 30));
            }
        }
    }
}

#[test]
fn the_law_is_its_equation_on_a_path_through_its_dead_band_and_its_limits() {
    let path = |swing: f64| (0..400).map(move |k| ((f64::from(k) / 20.0).sin() * swing) as i32);
    for (dead_band, integral_band, acceleration_gain) in [(0, 0, 0), (5, 0, 0), (40, 0, 250), (0, 25, 0)] {
        for swing in [3.0, 30.0, 3000.0] {
            let changes = [
                (id::PROPORTIONAL_GAIN, 900),
                (id::INTEGRAL_GAIN, 665),
                (id::VELOCITY_GAIN, 1000),
                (id::ACCELERATION_GAIN, acceleration_gain),
                (id::DEAD_BAND_COUNTS, dead_band),
                (id::INTEGRAL_BAND_COUNTS, integral_band),
            ];
            agree(&changes, 11, path(swing));
        }
    }
}

/// What a proportional law leaves: a command that only an integrator finds. Here the axis moves by a part of the command beyond
/// that one.
#[test]
fn an_axis_that_needs_a_standing_command_comes_to_its_setpoint() {
    let left = |integral_gain| {
        let gains = [(id::PROPORTIONAL_GAIN, 500), (id::VELOCITY_GAIN, 0), (id::ACCELERATION_GAIN, 0)];
        let changes = [WIDE.as_slice(), &[PID, (id::INTEGRAL_GAIN, integral_gain)], &gains].concat();
        let mut bench = ControllerBench::running(&changes, &[(0, 1000)]);
        let mut position = 0.0_f64;
        for _ in 0..4000 {
            let counts = bench.take(Sample { position: position as i32, ..Sample::default() });
            position += 0.02 * (f64::from(counts) - 150.0);
        }
        1000 - position as i32
    };
    assert!((70..=80).contains(&left(0)), "150 counts are 77 of error at this gain: {}", left(0));
    assert!(left(400).abs() <= 1, "{}", left(400));
}

/// A long move holds the demand at its limit for long. Without clamping, the sum of its errors would carry the axis far beyond.
#[test]
fn an_integrator_does_not_wind_up_while_the_command_is_at_its_limit() {
    let changes = [
        WIDE.as_slice(),
        &[PID, (id::PROPORTIONAL_GAIN, 1000), (id::INTEGRAL_GAIN, 665), (id::VELOCITY_GAIN, 0)],
    ]
    .concat();
    let mut bench = ControllerBench::running(&changes, &[(0, 20_000)]);
    for k in 0..500 {
        let counts = bench.take(Sample { position: 10 * k, ..Sample::default() });
        assert_eq!((counts, integral(&bench)), (2048, 0), "sample {k}");
    }
}
