//! Gains to begin with, from the data sheets: feedback of position, velocity and acceleration that places the poles of the drive,
//! and a profile that takes the spool across its dead zone.
//!
//! ```text
//! w^2 = n P (A_1 + A_2)/(l M)            the load on its two air springs at mid-stroke, l half the stroke, P the mean pressure
//! K   = C p_s rho_0 R T_0/(P A_1)        speed with the valve fully open: the choked flow fills the chamber at its pressure
//! x'' = v',  v'' + 2 D w v' + w^2 v = w^2 K u           u the part of the valve that is open
//! u   = k_p e - k_v v - k_a a + u_0 sign(e)             u_0 the dead zone
//! (s + p)(s^2 + 2 d q s + q^2) = s^3 + (2 D w + w^2 K k_a) s^2 + (w^2 + w^2 K k_v) s + w^2 K k_p
//! p = 0.2 w,  q = 2 w,  d = 0.35,  D = 0.05
//! ```
//!
//! u_0 is the overlap, half of the hysteresis, and as much again as the shut lands leak. Nearer to the setpoint than [`NEAR_MM`]
//! the step across it is a gain, so that it does not change sign with the error. On seven drives of the catalogue from 2 to 40 kg
//! with overlaps from 0 to 5 % a step over half of the stroke ends within 2.4 mm, with a valve of 2000 l/min on 2 kg within
//! 3.4 mm; `pneudrive tune` finds better gains.

use pneudrive_sim::keys;

use super::air::supply;
use super::{Cylinder, valve};
use crate::question::{AnswerProblem, Answers};
use crate::rig_file::RigFile;

/// Share of the supply pressure that stands in the chambers of a drive that rests.
const MEAN_PRESSURE: f64 = 0.6;
/// n, and rho_0 R T_0 of air at the reference atmosphere, Pa.
const HEAT_CAPACITY_RATIO: f64 = 1.4;
const REFERENCE: f64 = 1e5;
/// p/w, q/w, d and D.
const REAL_POLE: f64 = 0.2;
const PAIR: f64 = 2.0;
const PAIR_DAMPING: f64 = 0.35;
const OWN_DAMPING: f64 = 0.05;
/// Commands of the full valve.
const FULL: f64 = 2048.0;
/// Windows of velocity and acceleration, s: short against the pair of poles, long against a count.
const WINDOWS_S: [f64; 2] = [6e-3, 5e-3];
/// Error below which the step across the dead zone fades, mm; that which one entry of the profile covers; and the dead band.
const NEAR_MM: f64 = 2.0;
const SPAN_MM: f64 = 0.4;
const DEAD_BAND_MM: f64 = 0.1;
/// Entries of the profile.
const ENTRIES: u32 = 64;
/// The largest gain of the controller.
const MAX_GAIN: f64 = 65_535.0;

/// k_p, k_v and k_a, as parts of the valve per m, m/s and m/s^2, and w, rad/s.
struct Feedback {
    gains: [f64; 3],
    natural: f64,
}

impl Feedback {
    fn of(answers: &Answers, cylinder: &Cylinder, sonic_conductance: f64) -> Result<Feedback, AnswerProblem> {
        let piston = cylinder.moving_mass().map_or(0.0, |[low, high]| (low + high) / 2.0);
        let mass = answers.required("mass")? + piston;
        let supply = supply(answers)?.value;
        let pressure = MEAN_PRESSURE * supply;
        let [first, second] = cylinder.areas();
        let half = cylinder.stroke / 2.0;
        let w = (HEAT_CAPACITY_RATIO * pressure * (first + second) / half / mass).sqrt();
        let speed = sonic_conductance * supply * REFERENCE / (pressure * first);
        let [p, q] = [REAL_POLE * w, PAIR * w];
        let coupled = 2.0 * PAIR_DAMPING * q;
        let over_valve = 1.0 / (w * w * speed);
        let gains = [
            p * q * q * over_valve,
            (q * q + coupled * p - w * w) * over_valve,
            (p + coupled - 2.0 * OWN_DAMPING * w) * over_valve,
        ];
        Ok(Feedback { gains, natural: w })
    }
}

/// The controller that the gains are for.
struct Sampling {
    count_mm: f64,
    /// Samples of the windows of velocity and acceleration, and how long these are, s.
    samples: [f64; 2],
    windows: [f64; 2],
}

impl Sampling {
    fn of(answers: &Answers, cylinder: &Cylinder) -> Result<Sampling, AnswerProblem> {
        let count_mm = super::Encoder::of(answers, cylinder)?.mm_per_count;
        let period = answers.number("period")?.unwrap_or(super::PERIOD_S);
        let samples = WINDOWS_S.map(|window| (window / period).round().clamp(2.0, 15.0));
        Ok(Sampling { count_mm, samples, windows: samples.map(|samples| samples * period) })
    }

    /// Commands that a count of the error, of a velocity window and of both windows asks for.
    fn commands(&self, [position, velocity, acceleration]: [f64; 3]) -> [f64; 3] {
        let per_count = FULL * 1e-3 * self.count_mm;
        let [v_window, a_window] = self.windows;
        [position, velocity / v_window, acceleration / (v_window * a_window)].map(|gain| per_count * gain)
    }

    /// Commands per count of an error (mm) that take the spool across a dead zone.
    fn across(&self, dead_zone: f64, error_mm: f64) -> f64 {
        FULL * dead_zone * self.count_mm / error_mm.max(NEAR_MM)
    }

    fn counts(&self, mm: f64) -> i64 {
        (mm / self.count_mm).round().max(1.0) as i64
    }
}

/// The largest power of two at which all gains fit.
fn scale_for(largest: f64) -> f64 {
    let mut powers = (4..=12).rev().map(|power| f64::from(1_u32 << power));
    powers.find(|scale| scale * largest <= MAX_GAIN).unwrap_or(16.0)
}

/// Writes the gains of the gain profile.
pub(super) fn write(file: &mut RigFile, answers: &Answers, cylinder: &Cylinder) -> Result<(), AnswerProblem> {
    let feedback = Feedback::of(answers, cylinder, valve::sonic_conductance(answers)?)?;
    let (sampling, dead_zone) = (Sampling::of(answers, cylinder)?, valve::dead_zone(answers)?);
    let [kp, kv, ka] = sampling.commands(feedback.gains);
    let scale = scale_for(kv.max(ka).max(kp + sampling.across(dead_zone, 0.0)));
    let gain = |gain: f64| (scale * gain).round().clamp(0.0, MAX_GAIN);
    let entry = |i: u32| gain(kp + sampling.across(dead_zone, (f64::from(i) + 0.5) * SPAN_MM)).max(1.0);
    let profile: Vec<String> = (0..ENTRIES).map(|i| entry(i).to_string()).collect();
    let why = format!(
        "poles at {REAL_POLE} and {PAIR} times the load on its air springs, {:.1} Hz, and across {:.1} % of dead zone; `pneudrive tune` finds better ones",
        feedback.natural / std::f64::consts::TAU,
        1e2 * dead_zone
    );
    file.text(&keys::controller::GAIN_PROFILE, format!("[{}]", profile.join(", ")), &why);
    let [v_samples, a_samples] = sampling.samples.map(|samples| samples as i64);
    let windows = "short against the drive, long against a count";
    for (key, value, why) in [
        (&keys::controller::PROFILE_SPAN_COUNTS, sampling.counts(SPAN_MM), "0.4 mm"),
        (&keys::controller::VELOCITY_GAIN, gain(kv) as i64, "by the same poles"),
        (&keys::controller::ACCELERATION_GAIN, gain(ka) as i64, "by the same poles"),
        (&keys::controller::VELOCITY_WINDOW_SAMPLES, v_samples, windows),
        (&keys::controller::ACCELERATION_WINDOW_SAMPLES, a_samples, windows),
        (&keys::controller::SCALE, scale as i64, "the largest power of two at which all gains fit"),
        (&keys::controller::DEAD_BAND_COUNTS, sampling.counts(DEAD_BAND_MM), "0.1 mm"),
    ] {
        file.integer(key, value, why);
    }
    Ok(())
}
