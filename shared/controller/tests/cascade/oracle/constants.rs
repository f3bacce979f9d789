//! What the law knows of its drive, as the parameters have it, in real numbers.

use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::id;

/// A land before a port: p and d, counts, and its conductance with the spool at its end.
pub struct Land {
    pub port: f64,
    pub clearance: f64,
    pub end: f64,
}

/// A spool that is measured.
pub struct Spring {
    pub offset: f64,
    pub gain: f64,
    pub first: [f64; 2],
    pub second: [f64; 2],
    pub stiction: f64,
    pub friction: f64,
    pub still: f64,
}

/// A stepper: counts of a step, and the farthest step.
pub struct Stepper {
    pub step: f64,
    pub farthest: f64,
}

/// The constants, as the rig's parameters have them.
pub struct Constants {
    pub stroke: f64,
    pub dead: [f64; 2],
    pub offset: f64,
    pub gain: f64,
    pub exhaust: f64,
    pub ratio: f64,
    pub n: f64,
    pub flow: [f64; 2],
    pub steep: [f64; 2],
    pub leak: f64,
    pub acceleration: f64,
    pub coulomb: [f64; 2],
    pub stiction: f64,
    pub viscous: f64,
    pub weight: f64,
    pub constant: f64,
    pub tau: f64,
    pub force_pole: f64,
    pub position_pole: f64,
    pub motion_decay: f64,
    pub flow_decay: f64,
    pub to_output: [f64; 4],
    pub to_sample: [f64; 4],
    pub lag: f64,
    pub share: f64,
    /// Largest command, counts.
    pub largest: f64,
    pub lap: f64,
    pub span: f64,
    pub play: f64,
    pub trajectory: [f64; 3],
    pub sensors: [f64; 2],
    pub noise: f64,
    pub land: Option<Land>,
    /// a and b of the tubes from the supply and to the exhaust.
    pub tubes: [[f64; 2]; 2],
    pub spring: Option<Spring>,
    pub stepper: Option<Stepper>,
    /// s, m.
    pub period: f64,
    pub count: f64,
}

fn value(parameters: &Parameters, id: u16, bits: i32) -> f64 {
    f64::from(parameters.get(id).expect("known id")) / 2.0_f64.powi(bits)
}

fn land(parameters: &Parameters) -> Option<Land> {
    let get = |id| value(parameters, id, 16);
    let (port, clearance) = (get(id::CASCADE_PORT), get(id::CASCADE_CLEARANCE));
    let t = get(id::CASCADE_SPAN).hypot(clearance) / port;
    (port > 0.0).then(|| Land { port, clearance, end: t / t.hypot(1.0) })
}

fn spring(parameters: &Parameters) -> Option<Spring> {
    let get = |id, bits| value(parameters, id, bits);
    let by_spring = get(id::CASCADE_SPOOL_OUTPUT_PULL, 28) + get(id::CASCADE_SPOOL_SAMPLE_PULL, 28);
    let friction = get(id::CASCADE_SPOOL_FRICTION, 16);
    let gain = get(id::CASCADE_SPOOL_GAIN, 24);
    (gain != 0.0).then(|| Spring {
        offset: get(id::CASCADE_SPOOL_OFFSET, 16),
        gain,
        first: [get(id::CASCADE_SPOOL_FIRST_WAY, 24), get(id::CASCADE_SPOOL_FIRST_SPEED, 24)],
        second: [get(id::CASCADE_SPOOL_SECOND_WAY, 24), get(id::CASCADE_SPOOL_SECOND_SPEED, 24)],
        stiction: get(id::CASCADE_SPOOL_STICTION, 16),
        friction,
        still: (0.25 * friction * by_spring.abs()).max(0.25),
    })
}

fn stepper(parameters: &Parameters) -> Option<Stepper> {
    let farthest = value(parameters, id::MAX_STEPS, 0);
    (value(parameters, id::STEPPER, 0) != 0.0).then(|| Stepper { step: 2048.0 / farthest, farthest })
}

impl Constants {
    pub fn of(parameters: &Parameters) -> Constants {
        let get = |id, bits: i32| value(parameters, id, bits);
        let spool = |first: u16| [get(first, 30), get(first + 1, 30), get(first + 2, 28), get(first + 3, 30)];
        Constants {
            stroke: get(id::CASCADE_STROKE, 0),
            dead: [get(id::CASCADE_DEAD_LENGTH_1, 0), get(id::CASCADE_DEAD_LENGTH_2, 0)],
            offset: get(id::CASCADE_PRESSURE_OFFSET, 24),
            gain: get(id::CASCADE_PRESSURE_GAIN, 30),
            exhaust: get(id::CASCADE_EXHAUST_PRESSURE, 24),
            ratio: get(id::CASCADE_AREA_RATIO, 24),
            n: get(id::CASCADE_EXPONENT, 16),
            flow: [get(id::CASCADE_FLOW_SUPPLY, 16), get(id::CASCADE_FLOW_EXHAUST, 16)],
            steep: [get(id::CASCADE_STEEPNESS_SUPPLY, 16), get(id::CASCADE_STEEPNESS_EXHAUST, 16)],
            leak: get(id::CASCADE_LEAKAGE, 16),
            acceleration: get(id::CASCADE_ACCELERATION, 16),
            coulomb: [get(id::CASCADE_COULOMB_EXTEND, 24), get(id::CASCADE_COULOMB_RETRACT, 24)],
            stiction: get(id::CASCADE_STICTION, 24),
            viscous: get(id::CASCADE_VISCOUS, 30),
            weight: get(id::CASCADE_WEIGHT, 24),
            constant: get(id::CASCADE_STANDING_FORCE, 24),
            tau: get(id::CASCADE_DEAD_TIME, 16),
            force_pole: get(id::CASCADE_FORCE_POLE, 16),
            position_pole: get(id::CASCADE_POSITION_POLE, 16),
            motion_decay: get(id::CASCADE_MOTION_DECAY, 30),
            flow_decay: get(id::CASCADE_FLOW_DECAY, 30),
            to_output: spool(id::CASCADE_SPOOL_OUTPUT_PLACE),
            to_sample: spool(id::CASCADE_SPOOL_SAMPLE_PLACE),
            lag: get(id::CASCADE_SPOOL_LAG, 16),
            share: get(id::CASCADE_OUTPUT_SHARE, 16),
            largest: get(id::MAX_COMMAND_COUNTS, 0),
            lap: get(id::CASCADE_OVERLAP, 16),
            span: get(id::CASCADE_SPAN, 16),
            play: get(id::CASCADE_PLAY, 16),
            trajectory: [
                get(id::CASCADE_WAY_SPEED, 16),
                get(id::CASCADE_WAY_ACCELERATION, 16),
                get(id::CASCADE_WAY_FLOW, 16),
            ],
            sensors: [get(id::CASCADE_SENSOR_DECAY, 30), get(id::CASCADE_SENSOR_GAIN, 30)],
            noise: get(id::CASCADE_LEARNING_NOISE, 24),
            land: land(parameters),
            tubes: [
                [get(id::CASCADE_TUBE_SUPPLY_CHOKED, 16), get(id::CASCADE_TUBE_SUPPLY_SLIGHT, 16)],
                [get(id::CASCADE_TUBE_EXHAUST_CHOKED, 16), get(id::CASCADE_TUBE_EXHAUST_SLIGHT, 16)],
            ],
            spring: spring(parameters),
            stepper: stepper(parameters),
            period: get(id::PERIOD_US, 0) * 1e-6,
            count: get(id::ENCODER_PM_PER_COUNT, 0) * 1e-12,
        }
    }

    pub fn samples(&self, seconds: f64) -> f64 {
        seconds / self.period
    }

    pub fn counts(&self, metres: f64) -> f64 {
        metres / self.count
    }

    pub fn speed(&self, metres_per_second: f64) -> f64 {
        metres_per_second * self.period / self.count
    }

    pub fn coulomb(&self, sign: f64) -> f64 {
        sign * self.coulomb[usize::from(sign < 0.0)]
    }
}
