//! Rig files as text: new values replace old ones, and all comments stay.

use anyhow::{Context, Result, anyhow};
use pneudrive_sim::schedule::MOVE_FORMS;
use toml_edit::{DocumentMut, Item, Table, TableLike, Value};

/// The text with these settings, `key=value`, each with a comment on its source.
///
/// # Errors
/// When the text is not TOML, or a setting is malformed.
pub fn with_settings(text: &str, settings: &[String], source: &str) -> Result<String> {
    let mut document: DocumentMut = text.parse().context("the rig file")?;
    for setting in settings {
        let (path, given) = setting.split_once('=').ok_or_else(|| anyhow!("{setting}: write KEY=VALUE"))?;
        let given = given.trim();
        let mut value: Value = given.parse().unwrap_or_else(|_| given.into());
        let before =
            comment(&document, path.trim()).map_or_else(String::new, |before| format!("{BEFORE}{before}"));
        value.decor_mut().set_suffix(format!("  # {source}{before}"));
        put(&mut document, path.trim(), Item::Value(value));
    }
    Ok(like(text, &document.to_string()))
}

/// Stands between the comment on a new value and that on the old one.
const BEFORE: &str = "; before: ";

/// The comments that this program writes on values.
const OWN: [&str; 8] = [
    "given: set in the studio",
    "set for pneudrive tune",
    "found by pneudrive tune",
    "as without this line",
    "set in Python",
    "set by hand",
    "set for the fit",
    "set when the FMU was made",
];

/// The user's comment after the value at a path, or after the same key without its unit.
fn comment(document: &DocumentMut, path: &str) -> Option<String> {
    let (table, name) = match path.split_once('.') {
        Some((table, name)) => (document.get(table)?.as_table_like()?, name),
        None => (document.as_table() as &dyn TableLike, path),
    };
    let other = other_spellings(table, name).into_iter().next();
    let item = table.get(name).or_else(|| table.get(&other?))?;
    let behind = item.as_value()?.decor().suffix()?.as_str()?.trim();
    let comment = behind.strip_prefix('#')?.trim();
    let users = comment.split_once(BEFORE).map_or(comment, |(_, before)| before);
    (!users.is_empty() && !OWN.contains(&users)).then(|| users.to_owned())
}

/// A text with the byte order mark and the line breaks of the file that it was made from.
fn like(file: &str, text: &str) -> String {
    let breaks = file.matches('\n').count();
    let text = text.replace("\r\n", "\n");
    let text = match breaks > 0 && file.matches("\r\n").count() == breaks {
        true => text.replace('\n', "\r\n"),
        false => text,
    };
    let mark = if file.starts_with(MARK) { MARK } else { "" };
    format!("{mark}{}", text.trim_start_matches(MARK))
}

/// The byte order mark.
const MARK: &str = "\u{feff}";

/// The text without some keys of a table.
///
/// # Errors
/// When the text is not TOML.
pub fn without(text: &str, table: &str, keys: &[&str]) -> Result<String> {
    let mut document: DocumentMut = text.parse().context("the rig file")?;
    if let Some(table) = document.get_mut(table).and_then(Item::as_table_like_mut) {
        for key in keys {
            remove_other_spelling(table, key);
            table.remove(key);
        }
    }
    Ok(like(text, &document.to_string()))
}

/// Puts an item at a path such as `load.mass_kg`.
pub fn put(document: &mut DocumentMut, path: &str, item: Item) {
    let Some((table, name)) = path.split_once('.') else {
        document[path] = item;
        return;
    };
    let table = document.entry(table).or_insert(Item::Table(Table::new()));
    if let Some(inline) = table.as_inline_table() {
        // A comment inside the braces would comment out the rest of the line.
        *table = Item::Table(inline.clone().into_table());
    }
    if let Some(table) = table.as_table_like_mut() {
        remove_other_spelling(table, name);
        remove_other_moves(table, path);
    }
    table[name] = item;
}

/// A file may spell a key without its unit, `mass = "8 kg"`: both at once would give it twice.
fn remove_other_spelling(table: &mut dyn TableLike, name: &str) {
    for other in other_spellings(table, name) {
        table.remove(&other);
    }
}

/// Moves in one form replace those in another, as a setting does on the command line.
fn remove_other_moves(table: &mut dyn TableLike, path: &str) {
    if MOVE_FORMS.iter().any(|form| form.path == path) {
        MOVE_FORMS.iter().filter(|form| form.path != path).for_each(|form| drop(table.remove(form.name())));
    }
}

fn other_spellings(table: &dyn TableLike, name: &str) -> Vec<String> {
    let (stem, unit) = pneudrive_sim::rig::unit(name);
    let spelled = |other: &str| !unit.is_empty() && other.eq_ignore_ascii_case(stem);
    table.iter().map(|(other, _)| other.to_owned()).filter(|other| spelled(other)).collect()
}

/// The text of a rig file with these values, by path, as stored in run.json.
///
/// # Errors
/// When a rig file cannot have such a value.
pub(crate) fn of_keys(keys: &serde_json::Map<String, serde_json::Value>) -> Result<String> {
    let mut document = DocumentMut::new();
    // Top-level keys stand before all tables.
    let (of_tables, of_top): (Vec<_>, Vec<_>) = keys.iter().partition(|(path, _)| path.contains('.'));
    for (path, value) in of_top.into_iter().chain(of_tables) {
        let value =
            toml_of(value).with_context(|| format!("{path} is {value}, which a rig file cannot have"))?;
        put(&mut document, path, Item::Value(value));
    }
    Ok(document.to_string())
}

fn toml_of(value: &serde_json::Value) -> Option<Value> {
    Some(match value {
        serde_json::Value::Bool(on) => (*on).into(),
        serde_json::Value::Number(number) => match number.as_i64() {
            Some(whole) => whole.into(),
            None => number.as_f64()?.into(),
        },
        serde_json::Value::String(text) => text.as_str().into(),
        serde_json::Value::Array(list) => Value::Array(list.iter().map(toml_of).collect::<Option<_>>()?),
        serde_json::Value::Object(fields) => {
            let fields = fields.iter().map(|(name, value)| Some((name.clone(), toml_of(value)?)));
            Value::InlineTable(fields.collect::<Option<_>>()?)
        }
        serde_json::Value::Null => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_takes_its_place_and_all_other_comments_stay() {
        let text =
            "# A rig.\nname = \"x\"\n\n[load]\nmass_kg = 1.6   # C(17)\nviscous_n_s_per_m = 30.0 # C(18)\n";
        let settings = ["load.mass_kg=2.5", "valve.model=flow-node"].map(str::to_owned);
        let with = with_settings(text, &settings, "measured").expect("TOML");
        assert_eq!(
            with,
            "# A rig.\nname = \"x\"\n\n[load]\nmass_kg = 2.5  # measured; before: C(17)\nviscous_n_s_per_m = 30.0 # C(18)\n\n[valve]\nmodel = \"flow-node\"  # measured\n"
        );
        let less = without(text, "load", &["mass_kg", "incline_deg"]).expect("TOML");
        assert_eq!(less, "# A rig.\nname = \"x\"\n\n[load]\nviscous_n_s_per_m = 30.0 # C(18)\n");
        assert_eq!(without(text, "test", &["moves"]).expect("TOML"), text);
        assert!(with_settings("[load", &settings, "measured").is_err());
        assert!(with_settings(text, &["load.mass_kg".to_owned()], "measured").is_err());
    }

    #[test]
    fn a_value_in_an_inline_table_can_be_set_and_the_text_is_read_again() {
        let text = "name = \"x\"\nload = { mass_kg = 1.6, incline_deg = 5.0 }\n";
        let with = with_settings(text, &["load.mass_kg=2.5".to_owned()], "set by hand").expect("TOML");
        let again: DocumentMut = with.parse().unwrap_or_else(|error| panic!("{with}: {error}"));
        assert_eq!(again["load"]["mass_kg"].as_float(), Some(2.5));
        assert_eq!(again["load"]["incline_deg"].as_float(), Some(5.0));
    }

    #[test]
    fn line_breaks_the_mark_and_what_a_user_wrote_behind_a_value_stay() {
        let text = "# A rig.\r\n[load]\r\nmass = \"8 kg\" # weighed in May\r\nincline_deg = 5.0\r\n";
        let settings = ["load.mass_kg=2.5".to_owned()];
        let once = with_settings(text, &settings, "given: set in the studio").expect("TOML");
        let line = "mass_kg = 2.5  # given: set in the studio; before: weighed in May\r\n";
        assert_eq!(once, format!("# A rig.\r\n[load]\r\nincline_deg = 5.0\r\n{line}"));
        let twice = with_settings(&once, &settings, "found by pneudrive tune").expect("TOML");
        assert!(
            twice.ends_with("mass_kg = 2.5  # found by pneudrive tune; before: weighed in May\r\n"),
            "{twice}"
        );
        let new = with_settings("[load]\n", &settings, "set in Python").expect("TOML");
        let again = with_settings(&new, &settings, "given: set in the studio").expect("TOML");
        assert_eq!(again, "[load]\nmass_kg = 2.5  # given: set in the studio\n");
        let marked = with_settings(&format!("{MARK}[load]\nmass_kg = 1.0\n"), &settings, "x").expect("TOML");
        assert_eq!(marked, format!("{MARK}[load]\nmass_kg = 2.5  # x\n"));
    }

    #[test]
    fn a_key_that_the_file_spells_without_its_unit_is_not_given_twice() {
        let text = "[load]\nmass = \"8 kg\"\nincline = \"5 deg\"\n";
        let with = with_settings(text, &["load.mass_kg=2.5".to_owned()], "measured").expect("TOML");
        let rig =
            pneudrive_sim::Rig::read("fitted.toml", &with).unwrap_or_else(|problems| panic!("{problems}"));
        assert_eq!(rig.number_at("load.mass_kg"), Some(2.5));
        assert_eq!(rig.number_at("load.incline_deg"), Some(5.0));
        assert_eq!(without(text, "load", &["mass_kg"]).expect("TOML"), "[load]\nincline = \"5 deg\"\n");
    }

    #[test]
    fn moves_in_one_form_replace_those_in_another() {
        let text =
            "[test]\nmoves = [[0.0, 8192]]\nduration_s = 1\n\n[[test.move]]\nprofile = \"step\"\nto_mm = 9\n";
        let set =
            with_settings(text, &["test.moves_mm=[[0.0, 90.0]]".to_owned()], "set by hand").expect("TOML");
        assert_eq!(set, "[test]\nduration_s = 1\nmoves_mm = [[0.0, 90.0]]  # set by hand\n");
    }
}
