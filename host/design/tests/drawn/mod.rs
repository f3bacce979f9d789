//! Answers drawn at random from catalogues and beyond them: bores, strokes, loads, inclines, forces, pressures and valves that a
//! builder may combine, well or badly.

use pneudrive_design::parts::{Family, parts};
use pneudrive_design::question::{Answers, question_of};
use pneudrive_sim::rig::unit_interval;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// Bores and rods that are sold, mm; 0 is rodless.
const BORES: [(f64, f64); 12] = [
    (12.0, 6.0),
    (16.0, 6.0),
    (25.0, 0.0),
    (32.0, 12.0),
    (40.0, 0.0),
    (50.0, 20.0),
    (63.0, 20.0),
    (80.0, 25.0),
    (100.0, 25.0),
    (125.0, 32.0),
    (160.0, 40.0),
    (200.0, 40.0),
];

struct Draw(ChaCha8Rng);

impl Draw {
    /// Whether something of this share happens.
    fn happens(&mut self, share: f64) -> bool {
        unit_interval(&mut self.0) < share
    }

    /// As often in one tenfold as in the next.
    fn by_ratio(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(unit_interval(&mut self.0))
    }

    fn one_of<T: Clone>(&mut self, all: &[T]) -> T {
        all[(unit_interval(&mut self.0) * all.len() as f64) as usize].clone()
    }

    fn part(&mut self, family: Family) -> String {
        self.one_of(&parts(family)).name
    }
}

/// The answers of a seed.
pub fn answers(seed: u64) -> Answers {
    let mut draw = Draw(ChaCha8Rng::seed_from_u64(seed));
    let mut answers = Answers::default();
    let mut answer = |name: &str, text: String| answers.answer(question_of(name).expect("a question"), &text);
    if draw.happens(0.6) {
        answer("cylinder", draw.part(Family::Cylinder));
    } else {
        let (bore, rod) = draw.one_of(&BORES);
        answer("bore", format!("{bore} mm"));
        answer("rod", format!("{rod} mm"));
    }
    answer("stroke", format!("{:.0} mm", draw.by_ratio(10.0, 2000.0)));
    answer("mass", format!("{:.2} kg", draw.by_ratio(0.1, 400.0)));
    answer("valve", draw.part(Family::Valve));
    if draw.happens(0.5) {
        answer("incline", format!("{} deg", draw.one_of(&[-90, -30, 30, 60, 90])));
    }
    if draw.happens(0.3) {
        let sign = draw.one_of(&[-1.0, 1.0]);
        answer("force", format!("{:.0} N", sign * draw.by_ratio(5.0, 2000.0)));
    }
    if draw.happens(0.7) {
        answer("supply", format!("{:.1} bar(g)", draw.by_ratio(2.0, 10.0)));
    }
    if draw.happens(0.3) {
        answer("tube", draw.part(Family::Tube));
        answer("tube-length", format!("{:.2} m", draw.by_ratio(0.1, 10.0)));
    }
    if draw.happens(0.3) {
        answer("resolution", format!("{:.1} um", draw.by_ratio(1.0, 100.0)));
    }
    if draw.happens(0.3) {
        answer("period", format!("{} us", draw.one_of(&[250, 500, 1000, 2000, 5000])));
    }
    answers
}
