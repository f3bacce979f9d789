//! The net air mass that entered a chamber, from its pressures and volumes.
//!
//! The chamber is adiabatic as in the thesis (6.15 to 6.18); air that enters has the supply temperature T_s, or leaks past
//! the piston:
//!
//! ```text
//! mdot = (V P' + n P V') / (n R T_s) - mdot_leak
//! ```
//!
//! Compression of a closed chamber keeps P V^n and does not count. For air that leaves, which has the chamber's
//! temperature, the value is not a mass, but its sign is right: the rises of the integral are the air that entered.

/// A chamber at the samples of a record.
pub(super) struct Readings {
    /// Times, s.
    pub time: Vec<f64>,
    /// Pressures, Pa.
    pub pressure: Vec<f64>,
    /// Volumes, m^3.
    pub volume: Vec<f64>,
    /// The leakage into it past the piston, kg/s.
    pub leak: Vec<f64>,
    /// Standard deviation of a pressure, Pa.
    pub pressure_noise: f64,
    /// Standard deviation of a volume, m^3.
    pub volume_noise: f64,
}

/// The integral, kg, and its noise at each sample.
pub(super) struct Filling {
    /// The integral, kg.
    pub mass: Vec<f64>,
    /// Standard deviation, kg.
    pub noise: Vec<f64>,
}

/// Weights of the parabola through five samples at the one in the middle (Savitzky and Golay).
const PARABOLA: [f64; 5] = [-3.0 / 35.0, 12.0 / 35.0, 17.0 / 35.0, 12.0 / 35.0, -3.0 / 35.0];

impl Filling {
    /// Of air with heat capacity ratio `n` that comes in with `gas` = R T_s, J/kg.
    pub fn of(readings: &Readings, n: f64, gas: f64) -> Filling {
        let Readings { time, pressure, volume, leak, .. } = readings;
        let mean = |values: &[f64], k: usize| (values[k - 1] + values[k]) / 2.0;
        let mut mass = vec![0.0; time.len()];
        for k in 1..time.len() {
            let by_pressure = mean(volume, k) * (pressure[k] - pressure[k - 1]);
            let by_volume = n * mean(pressure, k) * (volume[k] - volume[k - 1]);
            let leaked = mean(leak, k) * (time[k] - time[k - 1]);
            mass[k] = mass[k - 1] + (by_pressure + by_volume) / (n * gas) - leaked;
        }
        let noise = |(volume, pressure): (&f64, &f64)| {
            (volume * readings.pressure_noise).hypot(n * pressure * readings.volume_noise) / (n * gas)
        };
        Filling { mass, noise: volume.iter().zip(pressure).map(noise).collect() }
    }

    /// With each value on the parabola through five: noise loses three tenths, and a fast ripple some of its height.
    pub fn smoothed(&self) -> Filling {
        let weighted = |five: &[f64]| five.iter().zip(PARABOLA).map(|(value, weight)| value * weight).sum();
        let inner = self.mass.windows(PARABOLA.len()).map(weighted);
        let left = self
            .noise
            .iter()
            .map(|noise| noise * PARABOLA.map(|weight| weight * weight).iter().sum::<f64>().sqrt());
        let mut mass = self.mass.clone();
        mass.iter_mut().skip(PARABOLA.len() / 2).zip(inner).for_each(|(value, smooth)| *value = smooth);
        Filling { mass, noise: left.collect() }
    }

    /// Every other of its samples, from the first or the second on.
    pub fn every_other(&self, from: usize) -> Filling {
        let half = |values: &[f64]| values.iter().skip(from).step_by(2).copied().collect();
        Filling { mass: half(&self.mass), noise: half(&self.noise) }
    }
}
