use super::filling::{Filling, Readings};
use super::rises::rises;
use super::*;

const SUPPLY: f64 = 286.76 * 294.0;

/// A chamber whose pressure (Pa) and volume (m^3) are known exactly over a second.
fn filling(pressure: impl Fn(f64) -> f64, volume: impl Fn(f64) -> f64, leak: f64) -> Filling {
    let time: Vec<f64> = (0..=1000).map(|k| f64::from(k) * 1e-3).collect();
    let readings = Readings {
        pressure: time.iter().map(|&t| pressure(t)).collect(),
        volume: time.iter().map(|&t| volume(t)).collect(),
        leak: vec![leak; time.len()],
        pressure_noise: 100.0,
        volume_noise: 1e-9,
        time,
    };
    Filling::of(&readings, 1.4, SUPPLY)
}

fn let_in(filling: &Filling) -> f64 {
    *rises(&filling.mass, &vec![0.0; filling.mass.len()]).sum.last().expect("samples")
}

/// A chamber that is shut keeps P V^n.
#[test]
fn air_that_is_compressed_is_no_air_from_the_supply() {
    let volume = |t: f64| 3e-4 - 1e-4 * t;
    let shut = filling(|t| 4e5 * (3e-4 / volume(t)).powf(1.4), volume, 0.0);
    let whole = 4e5 * 3e-4 / SUPPLY;
    assert!(let_in(&shut) < 1e-5 * whole, "{} of {whole}", let_in(&shut));
}

/// Of a rigid chamber the energy balance is V dP = n R T_s dm, of one that fills at a pressure P dV = R T_s dm.
#[test]
fn a_chamber_is_filled_by_what_its_energy_balance_says() {
    let rigid = filling(|t| 1e5 + 4e5 * t, |_| 3e-4, 0.0);
    assert!((let_in(&rigid) / (3e-4 * 4e5 / (1.4 * SUPPLY)) - 1.0).abs() < 1e-9);
    let growing = filling(|_| 5e5, |t| 1e-4 + 2e-4 * t, 0.0);
    assert!((let_in(&growing) / (5e5 * 2e-4 / SUPPLY) - 1.0).abs() < 1e-9);
    let emptied = filling(|t| 5e5 - 4e5 * t, |_| 3e-4, 0.0);
    assert_eq!(let_in(&emptied), 0.0);
    let by_leakage = filling(|t| 1e5 + 4e5 * t, |_| 3e-4, 3e-4 * 4e5 / (1.4 * SUPPLY));
    assert!(let_in(&by_leakage) < 1e-9, "it comes from the other chamber");
}

#[test]
fn the_noise_of_a_filling_is_that_of_pressure_and_volume() {
    let still = filling(|_| 5e5, |_| 3e-4, 0.0);
    let expected = (3e-4_f64 * 100.0).hypot(1.4 * 5e5 * 1e-9) / (1.4 * SUPPLY);
    assert!((still.noise[0] / expected - 1.0).abs() < 1e-12);
    assert!((still.smoothed().noise[0] / still.noise[0] - (17.0_f64 / 35.0).sqrt()).abs() < 1e-12);
}

#[test]
fn smoothing_keeps_parabolas() {
    let parabola = filling(|t| 1e5 + 4e5 * t * t, |_| 3e-4, 0.0);
    let smooth = parabola.smoothed();
    let off = parabola.mass.iter().zip(&smooth.mass).map(|(one, other)| (one - other).abs());
    assert!(off.fold(0.0, f64::max) < 1e-12 * let_in(&parabola));
}

#[test]
fn a_constant_inflow_is_time_by_flow_whichever_rows_are_taken() {
    let (time, flow, filled) = ([0.0, 1.0, 3.0, 4.0], [2.0; 4], [0.0, 2.0, 6.0, 8.0]);
    assert_eq!([integral::<1>(&time, &flow), integral::<2>(&time, &flow)], [filled, filled]);
    assert_eq!(integral::<1>(&[], &[]), [0.0; 0]);
    let run = Inflow::of_flows(&[0.0, 1.0, 3.0], &[KG_PER_LITRE; 3]);
    let air = run.between(0, 3).expect("flows");
    let near = |litres: f64| (litres - 3.0).abs() < 1e-12;
    assert!(near(air.litres) && near(air.least) && near(air.most), "{air:?}");
}

#[test]
fn a_flow_that_changes_from_row_to_row_is_known_the_less() {
    let time: Vec<f64> = (0..=20).map(f64::from).collect();
    let jagged: Vec<f64> = (0..=20).map(|k| KG_PER_LITRE * f64::from(k % 2)).collect();
    let air = Inflow::of_flows(&time, &jagged).between(0, 20).expect("flows");
    assert_eq!([air.least, air.litres, air.most].map(f64::round), [0.0, 10.0, 20.0]);
}
