//! The catalogue: cylinders, valves, tubes and sensors, each figure with its source.
//!
//! The parts stand in `host/design/parts/*.toml`. A figure there has one of these forms:
//!
//! ```text
//! { value = "32 mm", source = "id" }           the source states it
//! { low = "..", high = "..", source = "id" }   the source states the range
//! { .., computed = "formula" }                 it follows from other figures
//! { low, high, judgement = "why" }             a range that no source states
//! { unknown = "what finds it" }                nothing is known
//! ```
//!
//! A part has the figures of its class besides its own.

use pneudrive_sim::rig::nearest;
use pneudrive_sim::rigfile::read_quantity;
use toml_edit::{Document, Table, TableLike};

/// The kind of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// A cylinder.
    Cylinder,
    /// A proportional valve.
    Valve,
    /// A tube.
    Tube,
    /// A sensor of position or pressure.
    Sensor,
}

impl Family {
    /// All of them, in the order of the list.
    pub const ALL: [Family; 4] = [Family::Cylinder, Family::Valve, Family::Tube, Family::Sensor];

    /// The word for it.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Family::Cylinder => "cylinder",
            Family::Valve => "valve",
            Family::Tube => "tube",
            Family::Sensor => "sensor",
        }
    }

    fn text(self) -> &'static str {
        match self {
            Family::Cylinder => include_str!("../parts/cylinders.toml"),
            Family::Valve => include_str!("../parts/valves.toml"),
            Family::Tube => include_str!("../parts/tubes.toml"),
            Family::Sensor => include_str!("../parts/sensors.toml"),
        }
    }
}

/// Typical values for gaps of catalogues, from `host/design/parts/typical.toml`.
const TYPICAL: &str = include_str!("../parts/typical.toml");

/// A figure of a part.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Its name, such as `rod`.
    pub name: String,
    /// Its value as it is written; None where only a range is known, or nothing.
    pub value: Option<String>,
    /// Between which values it lies.
    pub range: Option<[String; 2]>,
    /// Its source, in words.
    pub basis: String,
}

impl Figure {
    /// Its value in a unit.
    ///
    /// # Errors
    /// When the catalogue has no value, or one of another unit.
    pub(crate) fn value_in(&self, unit: &str) -> Result<f64, String> {
        let value = self.value.as_ref().ok_or_else(|| format!("{} has no value", self.name))?;
        number(value, unit)
    }

    /// Its range in a unit, if it has one.
    ///
    /// # Errors
    /// When the catalogue has another unit.
    pub(crate) fn range_in(&self, unit: &str) -> Result<Option<[f64; 2]>, String> {
        let Some([low, high]) = &self.range else { return Ok(None) };
        Ok(Some([number(low, unit)?, number(high, unit)?]))
    }
}

/// A number as the catalogue writes it.
fn number(text: &str, unit: &str) -> Result<f64, String> {
    read_quantity(text, unit).map(|reading| reading.value)
}

/// A part of the catalogue.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Its description.
    pub family: Family,
    /// Its name, such as `iso-15552-32`.
    pub name: String,
    /// Facts in words, such as its standard.
    pub facts: Vec<(String, String)>,
    /// Its figures, its own ones first.
    pub figures: Vec<Figure>,
}

impl Part {
    /// A figure, if the catalogue has it.
    #[must_use]
    pub fn figure(&self, name: &str) -> Option<&Figure> {
        self.figures.iter().find(|figure| figure.name == name)
    }

    /// A fact in words.
    #[must_use]
    pub fn fact(&self, name: &str) -> Option<&str> {
        self.facts.iter().find(|(fact, _)| fact == name).map(|(_, text)| text.as_str())
    }
}

/// All parts of a family, in the order of the catalogue.
#[must_use]
pub fn parts(family: Family) -> Vec<Part> {
    let document = document(family.text());
    let sources = document.get("sources").and_then(|item| item.as_table());
    let list = document.get(family.word()).and_then(|item| item.as_array_of_tables());
    let classes = document.get("class").and_then(|item| item.as_table());
    let part = |table: &Table| part(family, table, classes, sources);
    list.into_iter().flatten().map(part).collect()
}

/// The part with a name.
///
/// # Errors
/// When the catalogue has none: with the name that is most like it.
pub fn find(family: Family, name: &str) -> Result<Part, String> {
    let all = parts(family);
    let found = all.iter().find(|part| part.name == name).cloned();
    found.ok_or_else(|| {
        let guess = nearest(name, all.iter().map(|part| part.name.as_str()))
            .map_or(String::new(), |near| format!("; did you mean {near}?"));
        format!("the catalogue has no {} {name}{guess} (`pneudrive rig parts` lists them)", family.word())
    })
}

/// A typical value for a gap of catalogues.
#[must_use]
pub fn typical(name: &str) -> Option<Figure> {
    let document = document(TYPICAL);
    let sources = document.get("sources").and_then(|item| item.as_table());
    figure(name, document.get(name)?.as_table_like()?, sources)
}

fn document(text: &'static str) -> Document<&'static str> {
    Document::parse(text).unwrap_or_else(|error| panic!("the catalogue: {error}"))
}

fn part(family: Family, table: &Table, classes: Option<&Table>, sources: Option<&Table>) -> Part {
    let word = |name: &str| table.get(name).and_then(|item| item.as_str());
    let mut figures = figures(table, sources);
    let class = word("class").and_then(|class| classes?.get(class)?.as_table());
    for shared in class.into_iter().flat_map(|class| self::figures(class, sources)) {
        if figures.iter().all(|own| own.name != shared.name) {
            figures.push(shared);
        }
    }
    let facts = table
        .iter()
        .filter(|(name, _)| *name != "name")
        .filter_map(|(name, item)| Some((name.to_owned(), item.as_str()?.to_owned())));
    Part { family, name: word("name").unwrap_or_default().to_owned(), facts: facts.collect(), figures }
}

fn figures(table: &Table, sources: Option<&Table>) -> Vec<Figure> {
    table.iter().filter_map(|(name, item)| figure(name, item.as_table_like()?, sources)).collect()
}

fn figure(name: &str, table: &dyn TableLike, sources: Option<&Table>) -> Option<Figure> {
    let text = |key: &str| table.get(key).and_then(|item| item.as_str()).map(str::to_owned);
    let range = text("low").zip(text("high")).map(|(low, high)| [low, high]);
    let value = text("value");
    if value.is_none() && range.is_none() && text("unknown").is_none() {
        return None;
    }
    let cited = |id: &String| title(sources?, id);
    let source = text("source").as_ref().and_then(cited);
    let basis =
        [text("computed"), source, text("judgement").map(|why| format!("judgement: {why}")), text("unknown")];
    let basis = basis.into_iter().flatten().collect::<Vec<_>>().join("; ");
    Some(Figure { name: name.to_owned(), value, range, basis })
}

/// The title of a source, and where it is.
fn title(sources: &Table, id: &str) -> Option<String> {
    let source = sources.get(id)?.as_table()?;
    let text = |key: &str| source.get(key).and_then(|item| item.as_str());
    Some(format!("{} ({})", text("title")?, text("kind")?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_has_the_figures_that_a_rig_needs() {
        for cylinder in parts(Family::Cylinder) {
            for name in ["bore", "rod"] {
                let figure =
                    cylinder.figure(name).unwrap_or_else(|| panic!("{} has no {name}", cylinder.name));
                assert!(figure.value_in("m").is_ok(), "{} {name}", cylinder.name);
            }
            let [bore, rod] = ["bore", "rod"]
                .map(|name| cylinder.figure(name).expect("a figure").value_in("m").expect("m"));
            assert!(rod < bore, "{}", cylinder.name);
        }
        for valve in parts(Family::Valve) {
            let flow = valve.figure("nominal_flow").unwrap_or_else(|| panic!("{} has no flow", valve.name));
            assert!(flow.value_in("m3/s").is_ok(), "{}", valve.name);
        }
        for tube in parts(Family::Tube) {
            assert!(tube.figure("inner_diameter").expect("a figure").value_in("mm").is_ok(), "{}", tube.name);
        }
    }

    #[test]
    fn every_figure_says_what_it_rests_on() {
        for part in Family::ALL.into_iter().flat_map(parts) {
            for figure in &part.figures {
                assert!(!figure.basis.is_empty(), "{} {}", part.name, figure.name);
            }
        }
    }

    /// The minimum contents of the catalogue.
    #[test]
    fn there_are_enough_parts() {
        let count = |family| parts(family).len();
        assert!(count(Family::Cylinder) >= 6 && count(Family::Valve) >= 5, "cylinders, valves");
        assert!(count(Family::Tube) >= 3 && count(Family::Sensor) >= 5, "tubes, sensors");
    }

    #[test]
    fn a_part_has_the_figures_of_its_class() {
        let valve = find(Family::Valve, "proportional-5-3-350").expect("a valve");
        let ratio = valve.figure("critical_ratio").expect("a figure of its class");
        assert_eq!(ratio.range_in("").expect("numbers"), Some([0.18, 0.44]));
        assert!(ratio.basis.contains("CKD"), "{}", ratio.basis);
    }

    #[test]
    fn an_unknown_part_has_a_near_miss() {
        let message = find(Family::Cylinder, "iso15552-32").expect_err("no such name");
        assert!(message.contains("did you mean iso-15552-32?"), "{message}");
    }

    #[test]
    fn what_is_typical_has_a_range() {
        let friction = typical("running_friction_fraction").expect("typical");
        assert_eq!(friction.range_in("%").expect("percent"), Some([1.0, 25.0]));
    }
}
