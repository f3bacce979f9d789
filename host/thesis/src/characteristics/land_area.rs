//! Areas of the lands over the spool (6.38, Appendix IV).

use super::points::{evenly, over};
use super::{Characteristic, Figure, Graph, Unfit};
use pneudrive_sim::Rig;
use pneudrive_sim::component::valve::Valve;
use pneudrive_sim::keys;

pub(super) const ABOUT: &str = "areas of the lands over the spool (6.38)";

/// mm^2 in a m^2.
const MM2: f64 = 1e6;

pub(super) fn measure(rig: &Rig) -> Result<Characteristic, Unfit> {
    if !rig.get(&keys::valve::MODEL).facts().has_areas() {
        return Err(Unfit::NoPart("its valve is known by its flows; the curve nominal-flow has them"));
    }
    let valve = Valve::of(rig);
    let [travel, null] =
        [&keys::valve::SPOOL_TRAVEL_MM, &keys::valve::NULL_OFFSET_MM].map(|key| rig.get(key));
    let area = |land: usize, spool_mm: f64| MM2 * valve.land_areas(spool_mm * 1e-3)[land];
    let places = evenly(-travel, travel, 400);
    let series = [0, 1].map(|land| over(&format!("land {}", land + 1), &places, |spool| area(land, spool)));
    let port = over("port", &places, |_| MM2 * valve.port_area());
    Ok(Characteristic {
        notes: vec![
            "Land 1 lets the supply to port 1 and port 2 to the exhaust, land 2 the other way about. What is left of a shut land is the clearance between spool and sleeve.".to_owned(),
        ],
        across: "spool, mm",
        graphs: vec![Graph { title: "area, mm^2", series: series.into_iter().chain([port]).collect() }],
        figures: vec![
            Figure::computed("land 1 wide open".to_owned(), area(0, travel), "mm^2"),
            Figure::computed("both lands at the null".to_owned(), area(0, null), "mm^2"),
            Figure::computed("a port".to_owned(), MM2 * valve.port_area(), "mm^2"),
        ],
        ..Characteristic::default()
    })
}

#[cfg(test)]
mod tests {
    use super::super::servo_b as rig;
    use super::*;

    /// 6.38 with D = 10 mm, d = 9.98 mm: pi (D+d)/2 sqrt(x^2 + c^2) open, pi/4 (D^2-d^2) shut.
    #[test]
    fn lands_are_cylinders_when_open_and_rings_when_shut() {
        let found = measure(&rig(&[])).expect("a valve");
        let by_hand = std::f64::consts::PI * 9.99 * 1.0_f64.hypot(0.01);
        assert!((found.figures[0].value().expect("a figure") - by_hand).abs() < 1e-9);
        let land_1 = &found.graphs[0].series[0];
        let shut = std::f64::consts::PI / 4.0 * (100.0 - 9.98 * 9.98);
        assert!((land_1.y[0] - shut).abs() < 1e-9, "{}", land_1.y[0]);
    }

    #[test]
    fn the_lands_are_mirror_images_about_the_null() {
        let found = measure(&rig(&["valve.underlap_mm=0.05"])).expect("a valve");
        let [one, two] = [0, 1].map(|land| &found.graphs[0].series[land].y);
        assert!(one.iter().zip(two.iter().rev()).all(|(one, two)| (one - two).abs() < 1e-9));
    }
}
