//! The parameters of a drive beside those of the designed rig, as in `device config`.

use anyhow::Result;
use axum::http::StatusCode;
use pneudrive_controller::Parameters;
use pneudrive_link::client::Client;
use pneudrive_link::failure::Failure;
use pneudrive_page::refusal::HttpRefusal;
use pneudrive_records::parameter_names::Written;
use pneudrive_records::rig_info::RigParameters;
use pneudrive_sim::Rig;
use pneudrive_sim::rig::{find_key, unit};
use serde_json::{Value, json};

/// Every parameter with its value on the drive and in a rig, and whether the drive's values are stored.
///
/// # Errors
/// When the drive does not answer.
pub fn table(client: &mut Client, rig: &Rig) -> Result<Value> {
    let on_drive = client.parameters()?;
    let saved = client.config_state()?.saved;
    let designed = rig.parameters();
    let rows: Vec<Value> = Written::all().map(|written| row(&written, &on_drive, &designed)).collect();
    Ok(json!({ "rig": rig.name(), "saved": saved, "parameters": rows }))
}

fn row(written: &Written, on_drive: &RigParameters, designed: &Parameters) -> Value {
    let is_there = !on_drive.lacking.contains(&written.parameter.id);
    let (stem, _) = unit(written.name);
    let [value, of_rig] = [&on_drive.values, designed].map(|parameters| written.all_text(parameters));
    let table = written.name.split_once('.').map_or("the device's own", |(table, _)| table);
    json!({
        "path": written.name,
        "table": table,
        "name": stem.rsplit('.').next().unwrap_or(stem).replace('_', " "),
        "unit": written.unit(),
        "range": written.range(),
        "words": written.words(),
        "meaning": find_key(written.name).map_or(written.parameter.meaning, |key| key.meaning),
        "differs": is_there && value != of_rig,
        "value": is_there.then_some(value),
        "designed": of_rig,
    })
}

/// Sets parameters by name from texts: all of them or none, in one change of the drive.
///
/// # Errors
/// Each problem at its parameter.
pub fn change(client: &mut Client, changes: &[(String, String)]) -> Result<(), HttpRefusal> {
    let before = client.parameters().map_err(|error| HttpRefusal::of(&error))?.values;
    let after = changed(&before, changes)?;
    let pairs = before.iter().zip(after.iter());
    let values: Vec<(u16, i32)> = pairs.filter(|(was, is)| was != is).map(|(_, is)| is).collect();
    match client.change_parameters(&values) {
        Ok(()) => Ok(()),
        Err(error) => Err(refused_by_drive(&error, changes)),
    }
}

/// The parameters with some of them set from texts.
fn changed(before: &Parameters, changes: &[(String, String)]) -> Result<Parameters, HttpRefusal> {
    let mut after = before.clone();
    let mut problems = Vec::new();
    for (name, text) in changes {
        let put = match Written::named(name) {
            Some(written) => written.put(text, &mut after).map_err(|error| format!("{error:#}")),
            None => Err(format!("there is no parameter {name}")),
        };
        problems.extend(put.err().map(|message| problem(name, &message)));
    }
    if problems.is_empty() { Ok(after) } else { Err(refusal("nothing was changed", problems)) }
}

/// The drive's answer at each changed parameter that it names, by key or by the device's own name. If it names none,
/// at all of them.
fn refused_by_drive(error: &anyhow::Error, changes: &[(String, String)]) -> HttpRefusal {
    if !error.chain().any(|cause| Failure::of_cause(cause) == Some(Failure::Refused)) {
        return HttpRefusal::of(error);
    }
    let message = format!("{error:#}");
    let words: Vec<&str> =
        message.split(|letter: char| !(letter.is_alphanumeric() || "_.".contains(letter))).collect();
    let is_named = |name: &str| {
        let own = Written::named(name).map_or("", |written| written.parameter.name);
        words.iter().any(|word| [name, own].contains(&word.trim_end_matches('.')))
    };
    let named: Vec<&String> = changes.iter().map(|(name, _)| name).filter(|name| is_named(name)).collect();
    let problems = named.into_iter().map(|name| problem(name, &message)).collect();
    refusal(&message, problems)
}

fn problem(name: &str, message: &str) -> Value {
    json!({ "key": name, "line": null, "message": message })
}

fn refusal(message: &str, problems: Vec<Value>) -> HttpRefusal {
    HttpRefusal { status: StatusCode::UNPROCESSABLE_ENTITY, message: message.to_owned(), problems }
}

#[cfg(test)]
mod tests {
    use pneudrive_controller::parameters::id;

    use super::*;

    fn texts(changes: &[(&str, &str)]) -> Vec<(String, String)> {
        changes.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect()
    }

    fn keys(refusal: &HttpRefusal) -> Vec<&str> {
        refusal.problems.iter().filter_map(|problem| problem["key"].as_str()).collect()
    }

    #[test]
    fn every_text_that_is_no_value_is_a_problem_at_its_own_parameter() {
        let changes = texts(&[
            ("controller.velocity_gain", "70"),
            ("controller.loop", "ajar"),
            ("safety.hold_s", "1e9"),
            ("speed", "1"),
        ]);
        let refusal = changed(&Parameters::default(), &changes).expect_err("three are wrong");
        assert_eq!(keys(&refusal), ["controller.loop", "safety.hold_s", "speed"]);
        assert!(refusal.problems[0]["message"].as_str().is_some_and(|why| why.contains("closed, open")));
        let after = changed(&Parameters::default(), &changes[..1]).expect("right");
        assert_eq!(after.get(id::VELOCITY_GAIN), Some(70));
    }

    #[test]
    fn a_refusal_of_the_drive_stands_at_the_parameters_that_it_names() {
        let changes = texts(&[("controller.delay_s", "0.002"), ("controller.scale", "9")]);
        let of = |message: &str| refused_by_drive(&Failure::Refused.error(message), &changes);
        assert_eq!(keys(&of("rig: delay_us must be less than period_us.")), ["controller.delay_s"]);
        assert_eq!(keys(&of("rig: controller.scale = 9 is out of range")), ["controller.scale"]);
        assert_eq!(keys(&of("rig: the drive is enabled")), [""; 0], "it stands below the table");
    }

    #[test]
    fn a_row_tells_what_differs_from_the_rig_in_words_and_units_of_the_command() {
        let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
        let mut on_drive = RigParameters { values: rig.parameters(), lacking: vec![id::HOLD_MS] };
        on_drive.values.set(id::PERIOD_US, 2000).expect("in range");
        let row_of = |id| row(&Written::of(id).expect("there is"), &on_drive, &rig.parameters());
        let period = row_of(id::PERIOD_US);
        assert_eq!([&period["path"], &period["name"]], ["controller.period_s", "period"]);
        assert_eq!([&period["value"], &period["designed"], &period["unit"]], ["0.002", "0.0013", "s"]);
        assert_eq!((&period["differs"], &row_of(id::SCALE)["differs"]), (&json!(true), &json!(false)));
        assert_eq!(row_of(id::LAW)["words"][0], "gain-profile");
        assert_eq!(row_of(id::HOLD_MS)["value"], Value::Null, "an older firmware does not have it");
        assert_eq!(row_of(id::NULL_CODE)["table"], "the device's own");
    }
}
