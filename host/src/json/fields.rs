//! The commands that print figures, and the fields of their results: `pneudrive man --markdown` writes them for the book
//! (docs/reference/json.md), and `host/tests/json.rs` compares them with what the commands print.

/// `fields! { "places": "type", "meaning"; }`
macro_rules! fields {
    ($($places:literal: $kind:literal, $meaning:literal;)*) => {
        &[$(Field { places: $places, kind: $kind, meaning: $meaning }),*]
    };
}

mod analyses;
mod drives;
mod rigs;
mod runs;

/// Fields of a result that have one type and one meaning.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Their places, with commas between: `moves[].from_mm, moves[].to_mm`. `[]` is each entry of a list, `*` each field of
    /// an object.
    pub places: &'static str,
    /// Their type, such as `number or null, optional`. An optional field is absent where it does not apply.
    pub kind: &'static str,
    /// What they say, in Markdown.
    pub meaning: &'static str,
}

/// Commands whose results have the same fields.
#[derive(Clone, Copy, Debug)]
pub struct Figures {
    /// As they are typed, such as "device status".
    pub commands: &'static [&'static str],
    /// It is raised when a field goes or changes its meaning, not when one is added.
    pub version: u32,
    /// What the page says above the fields; may be empty.
    pub about: &'static str,
    /// Other results have some of these fields, too.
    pub fields: &'static [&'static [Field]],
}

const fn figures(commands: &'static [&'static str], fields: &'static [&'static [Field]]) -> Figures {
    Figures { commands, version: 1, about: "", fields }
}

impl Figures {
    const fn about(self, about: &'static str) -> Figures {
        Figures { about, ..self }
    }
}

/// What each command prints, in the order of the page.
pub const FIGURES: &[Figures] = &[
    figures(&["eval"], &[runs::EVAL]),
    figures(&["simulate"], &[runs::SIMULATED, runs::IN_FOLDER]),
    figures(&["demo"], &[runs::SIMULATED, runs::OVERLAY, runs::RECORDED]),
    figures(&["overlay"], &[runs::OVERLAY]),
    figures(&["spectrum"], &[runs::SPECTRUM]),
    figures(&["replay"], &[runs::REPLAY]),
    figures(&["identify"], &[analyses::IDENTIFY, analyses::SIMPLE]).about(
        "With `--tubing`, `--conductance` or `--timer`, those from `drop_slope` on instead of the others.",
    ),
    figures(&["commission"], &[analyses::IDENTIFY, analyses::COMMISSION]),
    figures(&["sweep", "merge"], &[analyses::SWEEP]),
    figures(&["ladder"], &[analyses::LADDER]),
    figures(&["tune"], &[analyses::TUNE]),
    figures(&["characterise"], &[analyses::CHARACTERISE]),
    figures(&["study"], &[analyses::STUDIES]).about("Of `study list`, without findings."),
    figures(&["thesis"], &[analyses::ENTRIES]),
    figures(&["run"], &[drives::RUN]),
    figures(&["record"], &[drives::RECORD]),
    figures(&["monitor"], &[drives::STATE, drives::MONITOR]).about("A document a line, until the last one."),
    figures(&["device status"], &[drives::STATE, drives::STATUS]),
    figures(&["device info"], &[drives::INFO]),
    figures(&["device reference"], &[drives::PLACE, drives::ENCODER_ZERO]),
    figures(&["device home"], &[drives::PLACE]),
    figures(&["device go", "device jog"], &[drives::MOVED, drives::PLACE]),
    figures(&["device faults"], &[drives::FAULTS]),
    figures(&["device learned"], &[drives::LEARNED]),
    figures(&["device config get", "device config set"], &[drives::PARAMETERS]),
    figures(&["device records show", "device records set"], &[drives::RECORDS]),
    figures(&["device bring-up"], &[drives::CHECKS]),
    figures(&["device io"], &[drives::CONTACTS]),
    figures(&["export"], &[drives::EXPORT]),
    figures(&["import"], &[drives::IMPORT]),
    figures(&["fmu"], &[drives::FMU]),
    figures(&["rig new"], &[rigs::RIG_NEW]).about("With `--tune`, also the fields of `tune`."),
    figures(&["rig parts"], &[rigs::RIG_PARTS]),
    figures(&["rig list"], &[rigs::RIG_LIST]),
    figures(&["rig show"], &[rigs::RIG_SHOW]),
    figures(&["rig diff"], &[rigs::RIG_DIFF]),
    figures(&["rig check"], &[rigs::RIG_CHECK]),
];

/// What a command prints; None if it prints no figures.
#[must_use]
pub fn of(command: &str) -> Option<&'static Figures> {
    FIGURES.iter().find(|one| one.commands.contains(&command))
}

/// The fields as Markdown, a section for each command.
#[must_use]
pub fn page() -> String {
    let row = |field: &Field| {
        let places: Vec<String> = field.places.split(", ").map(|place| format!("`{place}`")).collect();
        format!("| {} | {} | {} |\n", places.join(", "), field.kind, field.meaning)
    };
    let section = |one: &Figures| {
        let about = if one.about.is_empty() { String::new() } else { format!("{}\n\n", one.about) };
        let rows: String = one.fields.iter().copied().flatten().map(row).collect();
        format!("## {}\n\n{about}| field | type | meaning |\n|---|---|---|\n{rows}", one.commands.join(", "))
    };
    FIGURES.iter().map(section).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_is_listed_once_and_has_a_section_with_its_fields() {
        let page = page();
        for one in FIGURES {
            for command in one.commands {
                let listed = FIGURES.iter().filter(|other| other.commands.contains(command));
                assert_eq!(listed.count(), 1, "{command}");
            }
            let heading = format!("## {}\n", one.commands.join(", "));
            let rows = page.split(&heading).nth(1).expect("a section").split("\n## ").next().expect("rows");
            let fields = one.fields.iter().copied().flatten().count();
            assert_eq!(rows.lines().filter(|line| line.starts_with("| `")).count(), fields, "{heading}");
        }
    }
}
