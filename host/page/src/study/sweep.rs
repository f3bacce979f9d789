//! A sweep of the rig of the page.

use std::collections::BTreeMap;
use std::fmt::Write;

use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_optimise::sweep::execution::each_point;
use pneudrive_optimise::sweep::metric::FIGURES;
use pneudrive_optimise::sweep::{Row, Source, Sweep, numbers, report};
use pneudrive_sim::keys;
use pneudrive_sim::rig::{Kind, find_key};
use serde::Deserialize;
use serde_json::{Value, json};

use super::meter::Meter;
use super::{Audience, exhibit};
use crate::page_rig::PageRig;
use crate::refusal::HttpRefusal;
use crate::rigs::in_key_units;
use crate::simulation::{MAX_SAMPLES, rig_of};

/// Most points while a page waits.
const MAX_POINTS: usize = 10_000;

/// The name of the sweep file that a page offers.
const FILE: &str = "sweep.toml";

/// The keys that vary, and the figures to collect.
#[derive(Debug, Deserialize)]
pub struct SweepRequest {
    #[serde(flatten)]
    asked: PageRig,
    vary: Vec<Varied>,
    /// Names of figures.
    metrics: Vec<String>,
    /// What makes a point better than another.
    objective: Option<Objective>,
    /// Runs per point: the rig itself and its perturbed runs.
    runs: usize,
}

/// A key and its values.
#[derive(Debug, Deserialize)]
struct Varied {
    key: String,
    #[serde(flatten)]
    over: AxisValues,
}

#[derive(Debug, Deserialize)]
#[serde(untagged, expecting = "words, or a range with steps")]
enum AxisValues {
    Words {
        words: Vec<String>,
    },
    Range {
        from: Option<f64>,
        to: Option<f64>,
        steps: Option<u32>,
        #[serde(default)]
        logarithmic: bool,
    },
}

#[derive(Debug, Deserialize)]
struct Objective {
    aim: Aim,
    metric: String,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Aim {
    Minimise,
    Maximise,
}

impl SweepRequest {
    pub fn plan(&self) -> Result<Value, HttpRefusal> {
        let sweep = self.sweep()?;
        let size = match sweep.ensemble {
            1 => format!("{} points", sweep.points()),
            runs => format!("{} points x {runs} runs", sweep.points()),
        };
        Ok(json!({
            "command": format!("pneudrive sweep {FILE}"),
            "file": { "name": FILE, "text": sweep.source.text },
            "size": size,
        }))
    }

    pub fn work(&self, audience: Audience<'_>) -> Result<Value, HttpRefusal> {
        let sweep = self.sweep()?;
        let all: Vec<usize> = (0..sweep.points()).collect();
        let mut meter = Meter::new(audience.hears);
        let mut rows = BTreeMap::new();
        meter.at("points", 0, all.len());
        let done = each_point(&sweep, &all, |row: Row| {
            CancelToken::cancelled_unless(audience.waits).check()?;
            rows.insert(row.point, row);
            meter.at("points", rows.len(), all.len());
            Ok(())
        });
        done.map_err(|error| HttpRefusal::gone_or(&error, HttpRefusal::of))?;
        let rows: Vec<Row> = rows.into_values().collect();
        Ok(json!({
            "result": numbers::to_json(&sweep, &rows),
            "page": exhibit::to_json(&report::page(&sweep, &rows)),
            "settings": sweep.best(&rows).map_or_else(Vec::new, |best| self.settings_of(best)),
        }))
    }

    /// The changes of the best point, as `key=value`.
    fn settings_of(&self, row: &Row) -> Vec<String> {
        self.vary.iter().zip(&row.levels).map(|(varied, level)| format!("{}={level}", varied.key)).collect()
    }

    fn sweep(&self) -> Result<Sweep, HttpRefusal> {
        rig_of(&self.asked)?;
        let source = Source { name: FILE.to_owned(), text: self.text()? };
        let rig = || Source { name: self.asked.name.clone(), text: self.asked.text.clone() };
        let sweep = Sweep::read(source, |_| Ok(rig()))?;
        if sweep.points() > MAX_POINTS {
            let message = format!(
                "{} points: the studio sweeps over {MAX_POINTS} at most; `pneudrive sweep` takes more",
                sweep.points()
            );
            return Err(HttpRefusal::wrong(message));
        }
        refuse_long(&sweep)?;
        Ok(sweep)
    }

    /// Whether the key of a setting varies: then the sweep gives its values.
    fn varies(&self, setting: &str) -> bool {
        let key = setting.split('=').next();
        self.vary.iter().any(|varied| key == Some(varied.key.as_str()))
    }

    /// The sweep file.
    fn text(&self) -> Result<String, HttpRefusal> {
        let mut text = format!("rig = {:?}\n", self.asked.name);
        if self.runs > 1 {
            let _ = writeln!(text, "ensemble = {}", self.runs);
        }
        let set = in_key_units(&self.asked, &self.asked.rig()?);
        let set = set.iter().filter(|setting| !self.varies(setting));
        section(&mut text, "set", set.map(|setting| setting.replacen('=', " = ", 1)));
        let vary = self.vary.iter().map(Varied::line).collect::<Result<Vec<_>, _>>()?;
        section(&mut text, "vary", vary.into_iter());
        let metrics = self.metrics.iter().map(|name| known(name)).collect::<Result<Vec<_>, _>>()?;
        section(&mut text, "metrics", metrics.into_iter().map(|name| format!("{name} = {name:?}")));
        if let Some(Objective { aim, metric }) = &self.objective {
            let aim = match aim {
                Aim::Minimise => "minimise",
                Aim::Maximise => "maximise",
            };
            section(&mut text, "objective", [format!("{aim} = {:?}", known(metric)?)].into_iter());
        }
        Ok(text)
    }
}

/// Refuses a sweep if the test of a point has more samples than a page waits for.
fn refuse_long(sweep: &Sweep) -> Result<(), HttpRefusal> {
    // A level that is not a plain number counts as too long a test.
    let levels = |key: &str, unknown: f64| -> Vec<f64> {
        match sweep.axes.iter().find(|axis| axis.name == key) {
            Some(axis) => axis.levels.iter().map(|level| level.parse().unwrap_or(unknown)).collect(),
            None => sweep.rig.number_at(key).into_iter().collect(),
        }
    };
    let longest_s = levels(keys::test::DURATION_S.path, f64::INFINITY).into_iter().fold(0.0, f64::max);
    let shortest_s = levels(keys::controller::PERIOD_S.path, 0.0).into_iter().fold(f64::INFINITY, f64::min);
    let samples = (longest_s / shortest_s).floor();
    if samples > f64::from(MAX_SAMPLES) {
        return Err(HttpRefusal::wrong(format!(
            "test.duration_s, controller.period_s: a point would have {samples} samples, and the studio simulates {MAX_SAMPLES} at most; `pneudrive sweep` takes longer ones"
        )));
    }
    Ok(())
}

fn section(text: &mut String, name: &str, mut lines: impl Iterator<Item = String>) {
    let Some(first) = lines.next() else { return };
    let rest: String = lines.map(|line| line + "\n").collect();
    let _ = write!(text, "\n[{name}]\n{first}\n{rest}");
}

fn known(name: &str) -> Result<&'static str, HttpRefusal> {
    let figure = FIGURES.iter().find(|figure| figure.name == name);
    figure
        .map(|figure| figure.name)
        .ok_or_else(|| HttpRefusal::wrong(format!("metrics: there is no figure {name:?}")))
}

impl Varied {
    /// The text in the sweep file.
    fn line(&self) -> Result<String, HttpRefusal> {
        let key = find_key(&self.key)
            .ok_or_else(|| HttpRefusal::wrong(format!("there is no key {:?}", self.key)))?;
        match &self.over {
            AxisValues::Words { words } => {
                let is_switch = matches!(key.kind, Kind::Switch);
                let word = |word: &String| match word.as_str() {
                    "true" | "false" if is_switch => word.clone(),
                    _ => format!("{word:?}"),
                };
                Ok(format!("{} = [{}]", key.path, words.iter().map(word).collect::<Vec<_>>().join(", ")))
            }
            AxisValues::Range { from: Some(from), to: Some(to), steps: Some(steps), logarithmic } => {
                let spacing = if *logarithmic { ", spacing = \"log\"" } else { "" };
                Ok(format!("{} = {{ from = {from:?}, to = {to:?}, steps = {steps}{spacing} }}", key.path))
            }
            AxisValues::Range { .. } => Err(HttpRefusal::wrong(format!(
                "{}: give from, to and the number of values as numbers",
                key.path
            ))),
        }
    }
}

#[cfg(test)]
mod tests {
    use pneudrive_sim::rigfile::builtin;

    use super::*;

    /// A sweep of one key of a rig with these settings.
    fn asks(settings: &[&str], key: &str, [from, to]: [f64; 2]) -> SweepRequest {
        let asks = json!({
            "name": "servo-b-tuned", "text": builtin("servo-b-tuned").expect("a built-in rig"),
            "settings": settings, "vary": [{ "key": key, "from": from, "to": to, "steps": 3 }],
            "metrics": ["top_speed_mm_s"], "objective": null, "runs": 1,
        });
        serde_json::from_value(asks).expect("asks")
    }

    #[test]
    fn a_key_that_was_changed_on_the_page_varies_all_the_same() {
        let sweep = asks(&["load.mass=2.5 kg", "test.duration_s=0.3"], "load.mass_kg", [1.0, 4.0]).sweep();
        let settings = sweep.expect("a sweep").settings;
        assert!(matches!(&settings[..], [one] if one.starts_with("test.duration_s=")), "{settings:?}");
    }

    /// With 1.3 ms, 260 s have 200 000 samples.
    #[test]
    fn a_sweep_whose_points_have_too_many_samples_is_refused() {
        let of = |key, ends| asks(&["test.duration_s=0.3"], key, ends).sweep();
        assert!(of("test.duration_s", [0.3, 259.0]).is_ok());
        for ends in [[0.3, 261.0], [261.0, 0.3]] {
            let refusal = of("test.duration_s", ends).expect_err("too long");
            assert!(refusal.message.contains("200000 at most"), "{}", refusal.message);
        }
    }
}
