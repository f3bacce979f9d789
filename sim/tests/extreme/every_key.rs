//! Rigs of which any key may lie anywhere in its range. Keys are drawn one after another, in any order; a key whose draw
//! `rig check` refuses beside the earlier ones keeps its value.

use pneudrive_sim::Rig;
use pneudrive_sim::keys;
use pneudrive_sim::rig::{Key, Kind, all_keys, chooser};
use pneudrive_sim::rigfile::BUILTIN;

use super::draw::Draw;

/// Of a range that has no lower end above 0, as much is drawn below its upper end.
const DECADES: f64 = 1e-6;

/// Keys of the run rather than of the rig.
const OF_THE_RUN: [&str; 4] =
    ["test.duration_s", "test.trace_period_s", "controller.start_s", "controller.period_s"];

/// Measured flows of a valve.
const FLOW_MAP: &str = "valve.flow_map=[[0, 700, 140, 4, 1], [0, 700, 560, 3, 1], [100, 700, 140, 800, 9], [100, 700, 560, 500, 9]]";

/// The rig of a seed, the settings that make it of a built-in one, and the refusals on the way.
pub struct Drawn {
    pub name: &'static str,
    text: &'static str,
    pub settings: Vec<String>,
    pub rig: Rig,
    pub refused: Vec<String>,
}

/// The rig of a seed.
pub fn rig(seed: u64) -> Drawn {
    let mut draw = Draw::of(seed);
    let (name, text) = draw.one_of(BUILTIN);
    let rig = Rig::builtin(name).expect("a built-in rig");
    let mut drawn = Drawn { name, text, settings: Vec::new(), rig, refused: Vec::new() };
    drawn.draw_words(&mut draw);
    drawn.draw_test(&mut draw);
    drawn.draw_numbers(&mut draw);
    drawn
}

impl Drawn {
    /// Adds settings, if they go together with the earlier ones.
    fn add(&mut self, settings: Vec<String>) -> bool {
        let together = [self.settings.clone(), settings].concat();
        match Rig::read_with(self.name, self.text, &together) {
            Ok(rig) => (self.rig, self.settings) = (rig, together),
            Err(problems) => {
                self.refused.push(problems.to_string());
                return false;
            }
        }
        true
    }

    /// Models and switches.
    fn draw_words(&mut self, draw: &mut Draw) {
        for key in all_keys() {
            match key.kind {
                Kind::Choice(words) if draw.unit() < 0.6 => {
                    let built: Vec<&str> = words.iter().filter(|word| word.1).map(|word| word.0).collect();
                    let word = draw.one_of(&built);
                    let chosen = key.setting(word);
                    let _ = self.add([vec![chosen.clone()], needs(draw, key, word)].concat())
                        || self.add(vec![chosen]);
                }
                Kind::Switch if draw.unit() < 0.3 => {
                    let on = draw.unit() < 0.5;
                    self.add(vec![key.setting(on)]);
                }
                _ => {}
            }
        }
    }

    /// A test of the closed loop, or one that opens the valve either way.
    fn draw_test(&mut self, draw: &mut Draw) {
        let stroke_mm = 1e3 * self.rig.get(&keys::actuator::STROKE_M);
        let counts = stroke_mm / self.rig.get(&keys::encoder::MM_PER_COUNT);
        let [there, back] = [(); 2].map(|()| (counts * draw.between(0.1, 0.9)) as i64);
        let end = (1e6 * draw.decades(0.02, 1.0)).round() / 1e6;
        let half = 0.5 * end;
        self.add(vec![format!("test.duration_s={end:?}")]);
        let [closed, open] = [[there, back], [2047, -2047]].map(|[one, other]| {
            vec![
                format!("test.moves=[[0.0, {one}], [{half:.3}, {other}]]"),
                format!("test.duration_s={end:?}"),
            ]
        });
        let _ = self.add([closed, vec!["controller.loop=closed".to_owned()]].concat())
            || self.add([open, vec!["controller.loop=open".to_owned()]].concat());
    }

    /// Each number of a share of the keys, as far from the rig's value as the seed reaches.
    fn draw_numbers(&mut self, draw: &mut Draw) {
        let (share, reach) = (draw.one_of(&[0.1, 0.3, 1.0]), draw.between(0.2, 1.0));
        let mut keys: Vec<&Key> = all_keys().filter(|key| !OF_THE_RUN.contains(&key.path)).collect();
        while !keys.is_empty() {
            let key = keys.swap_remove((draw.unit() * keys.len() as f64) as usize);
            if draw.unit() < share && self.rig.uses(key) {
                let now = self.rig.number_at(key.path);
                if let Some(value) = value(draw, key, now, reach) {
                    self.add(vec![value]);
                }
            }
        }
    }
}

/// What a model needs besides its word.
fn needs(draw: &mut Draw, key: &Key, word: &str) -> Vec<String> {
    let map = (word == "flow-map").then(|| FLOW_MAP.to_owned());
    let given = |other: &&Key| {
        ["conductance_m3_per_s_pa", "critical_ratio"].iter().any(|end| other.path.ends_with(end))
            && other.models.contains(&word)
            && chooser(other).is_some_and(|chooser| chooser.path == key.path)
    };
    let numbers: Vec<String> =
        all_keys().filter(given).filter_map(|key| value(draw, key, None, 1.0)).collect();
    map.into_iter().chain(numbers).collect()
}

/// A number of a key's range, evenly in the logarithm, as part of the way from the present value.
fn value(draw: &mut Draw, key: &Key, now: Option<f64>, reach: f64) -> Option<String> {
    match key.kind {
        Kind::Number { min, max } => {
            let number = within(draw, [min, max], now, reach);
            let whole = |us: f64| (number * us).round() / us;
            // Most times must be whole microseconds.
            let number = if key.unit() == "s" { whole(1e6).clamp(min, max) } else { number };
            Some(key.setting(format!("{number:?}")))
        }
        Kind::Integer { min, max } => {
            Some(key.setting(within(draw, [min as f64, max as f64], now, reach).round() as i64))
        }
        _ => None,
    }
}

fn within(draw: &mut Draw, [min, max]: [f64; 2], now: Option<f64>, reach: f64) -> f64 {
    let largest = max.abs().max(min.abs());
    let smallest = if min > 0.0 { min } else { DECADES * largest };
    let sign = if min < 0.0 && draw.unit() < 0.5 { -1.0 } else { 1.0 };
    if min <= 0.0 && draw.unit() < 0.1 {
        return 0.0;
    }
    let drawn = draw.decades(smallest, largest);
    let from = now.map_or(drawn, f64::abs).clamp(smallest, largest);
    (sign * from * (drawn / from).powf(reach)).clamp(min, max)
}
