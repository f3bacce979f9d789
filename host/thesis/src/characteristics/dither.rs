//! Effect of dither (7.1.2.2, Fig. 7.8). No gauge can follow the shaking spool, so the test reads the pressure of
//! blocked port 1 over a command that goes up and down, for dithers of 20 to 60 Hz and of the rig's own frequency.
//!
//! A gauge reads the mean over a period of the dither. The hysteresis is the distance in command between the branches
//! where the pressure passes the middle of its range. The spool's own vibration is shown beside it.

use super::bench::{SpoolBench, ValveBench};
use super::hysteresis::{branches, reading_m, sweep};
use super::points::evenly;
use super::{Characteristic, Figure, Graph, Unfit};
use pneudrive_sim::Rig;
use pneudrive_sim::component::dither::Dither;
use pneudrive_sim::keys;

pub(super) const ABOUT: &str = "a blocked port over command, by frequency of the dither (7.1.2.2, Fig. 7.8)";

/// Frequencies of Fig. 7.8, Hz.
pub const FREQUENCIES_HZ: [f64; 5] = [20.0, 30.0, 40.0, 50.0, 60.0];

/// Pressure of blocked port 1 over the spool, Pa: a table fine enough for a mean over a dither.
struct BlockedPort {
    from: f64,
    step: f64,
    pressures: Vec<f64>,
}

impl BlockedPort {
    fn new(rig: &Rig) -> BlockedPort {
        let mut bench = ValveBench::new(rig, rig.get(&keys::supply::PRESSURE_PA));
        let travel = 1.25 * bench.valve.travel;
        let places = evenly(-travel, travel, 1000);
        let pressures = places.iter().map(|&x| bench.blocked(x)[0]).collect();
        BlockedPort { from: -travel, step: 2.0 * travel / 1000.0, pressures }
    }

    fn at(&self, spool: f64) -> f64 {
        let place = ((spool - self.from) / self.step).clamp(0.0, 999.999);
        let (i, part) = (place as usize, place.fract());
        self.pressures[i] * (1.0 - part) + self.pressures[i + 1] * part
    }

    fn mean(&self, spool: &[f64]) -> f64 {
        spool.iter().map(|&x| self.at(x)).sum::<f64>() / spool.len() as f64
    }
}

/// Half of the distance from the lowest to the highest place of the spool under a null command, m.
///
/// # Errors
/// When the spool cannot be followed.
pub(crate) fn vibration(rig: &Rig, dither: Dither) -> Result<f64, Unfit> {
    let mut bench = SpoolBench::new(rig, Some(dither));
    let period = 1.0 / dither.frequency_hz;
    bench.watch(20.0 * period, 1)?;
    let seen = bench.watch(period, 500)?;
    let [low, high] = [f64::min as fn(f64, f64) -> f64, f64::max].map(|of| seen.iter().copied().reduce(of));
    Ok((high.unwrap_or(0.0) - low.unwrap_or(0.0)) / 2.0)
}

pub(super) fn measure(rig: &Rig) -> Result<Characteristic, Unfit> {
    if !rig.get(&keys::operator::MODEL).is_solenoid() {
        return Err(Unfit::NoPart("only a solenoid has a dither"));
    }
    let port = BlockedPort::new(rig);
    if port.pressures.iter().any(|pressure| pressure.is_nan()) {
        return Err(Unfit::NoPart(
            "nothing leaks from its lands, so a blocked port has no pressure of its own",
        ));
    }
    let middle = (rig.get(&keys::supply::PRESSURE_PA) + rig.get(&keys::exhaust::PRESSURE_PA)) / 2.0;
    let (mut series, mut figures) = (Vec::new(), Vec::new());
    for frequency_hz in frequencies(rig) {
        let dither = Dither { frequency_hz, ..Dither::of(rig) };
        let found = sweep(rig, dither, |spool| port.mean(spool))?;
        let name = format!("{frequency_hz} Hz");
        if let Some(width) = found.width(middle) {
            let within = 1e3 * reading_m(rig);
            figures.push(Figure::read(format!("hysteresis at {name}"), 1e3 * width, within, "mm"));
        }
        let shaking = 1e3 * vibration(rig, dither)?;
        figures.push(Figure::computed(format!("amplitude of the spool at {name}"), shaking, "mm"));
        series.extend(branches(&found, &name, 1e-3));
    }
    Ok(Characteristic {
        notes: vec![format!(
            "The amplitude of the dither is {} mm at every frequency. The pressure is the mean over a period of the dither.",
            rig.get(&keys::dither::DITHER_MM)
        )],
        across: "command, mm",
        graphs: vec![Graph { title: "blocked port 1, kPa", series }],
        figures,
        ..Characteristic::default()
    })
}

/// The frequencies of Fig. 7.8, and the rig's own.
fn frequencies(rig: &Rig) -> Vec<f64> {
    let own = Dither::of(rig).frequency_hz;
    let other = Some(own).filter(|own| *own > 0.0 && !FREQUENCIES_HZ.contains(own));
    FREQUENCIES_HZ.into_iter().chain(other).collect()
}

#[cfg(test)]
mod tests {
    use super::super::servo_b as rig;
    use super::*;

    const DITHER: Dither = Dither { amplitude: 0.2e-3, frequency_hz: 50.0, phase_cycles: 0.0 };

    #[test]
    fn the_empirical_spool_shakes_by_the_dither_less_the_slack() {
        let shaking = vibration(&rig(&["operator.model=\"solenoid-empirical\""]), DITHER).expect("it shakes");
        assert!((shaking - 0.15e-3).abs() < 1e-8, "{shaking}");
    }

    /// A linear spool answers by G_s / |K - M w^2 + j D w|.
    #[test]
    fn without_friction_and_slack_the_analytical_spool_shakes_by_its_transfer_function() {
        let linear = rig(&[
            "operator.static_friction_n=0",
            "operator.coulomb_friction_n=0",
            "operator.hysteresis_percent=0",
            "operator.damping_n_s_per_m=24",
        ]);
        for frequency_hz in FREQUENCIES_HZ {
            let w = 2.0 * std::f64::consts::PI * frequency_hz;
            let expected = 0.2e-3 * 25e3 / (25e3 - 0.023 * w * w).hypot(24.0 * w);
            let shaking = vibration(&linear, Dither { frequency_hz, ..DITHER }).expect("it shakes");
            assert!((shaking / expected - 1.0).abs() < 1e-3, "{frequency_hz} Hz: {shaking} for {expected}");
        }
    }

    #[test]
    fn the_dither_of_the_rig_is_among_those_that_are_tried() {
        assert_eq!(frequencies(&rig(&[])), FREQUENCIES_HZ);
        assert_eq!(frequencies(&rig(&["operator.dither_hz=87.5"]))[5..], [87.5]);
    }

    #[test]
    fn a_spool_that_its_dither_cannot_move_stands() {
        let weak = Dither { amplitude: 0.1e-3, ..DITHER };
        assert_eq!(
            vibration(&rig(&[]), weak).expect("it stands"),
            0.0,
            "0.05 mm of it, 1.25 N, is below 3 N"
        );
    }
}
