//! `pneudrive device io`.

use anyhow::{Context, Result, anyhow, bail};
use pneudrive_link::client::{Client, Io};
use pneudrive_protocol::RequestRefusal;
use pneudrive_protocol::io::{input, output, refused};
use pneudrive_records::words;
use serde_json::{Map, Value, json};

use crate::json;

/// The inputs of one bit.
const INPUTS: [(&str, u8); 4] = [
    ("start", input::START),
    ("acknowledge", input::ACKNOWLEDGE),
    ("run", input::RUN),
    ("enable", input::ENABLE),
];

const OUTPUTS: [(&str, u8); 4] = [
    ("ready", output::READY),
    ("in position", output::IN_POSITION),
    ("fault", output::FAULT),
    ("lamp", output::LAMP),
];

pub(super) fn execute(client: &mut Client, settings: &[String]) -> Result<()> {
    if !settings.is_empty() {
        let changed =
            settings.iter().try_fold(client.io()?.inputs, |inputs, setting| with(inputs, setting))?;
        client.set_inputs(changed)?;
    }
    let io = client.io()?;
    show(&io);
    json::figures(|| figures(&io));
    Ok(())
}

/// The inputs with one of them set.
fn with(inputs: u8, setting: &str) -> Result<u8> {
    let (name, value) = setting
        .split_once('=')
        .ok_or_else(|| anyhow!("{setting} is no INPUT=VALUE, such as enable=on or number=3"))?;
    if name == "number" {
        let number: u8 = value.parse().ok().filter(|number| *number <= input::NUMBER).with_context(|| {
            format!(
                "number={value} is out of range: 0 (none), the number of a record, 1 to 14, or 15 (homing)"
            )
        })?;
        return Ok(inputs & !input::NUMBER | number);
    }
    let names = INPUTS.map(|(name, _)| name).join(", ");
    let (_, bit) = INPUTS
        .into_iter()
        .find(|(known, _)| *known == name)
        .with_context(|| format!("there is no input {name}; there are number, {names}"))?;
    match value {
        "on" => Ok(inputs | bit),
        "off" => Ok(inputs & !bit),
        other => bail!("{name}={other}: an input is on or off"),
    }
}

fn show(io: &Io) {
    let words = |names: &[(&str, u8)], bits: u8| {
        let all =
            names.iter().map(|(name, bit)| format!("{name} {}", if bits & bit == 0 { "off" } else { "on" }));
        all.collect::<Vec<_>>().join(", ")
    };
    say!("inputs   number {}, {}", io.inputs & input::NUMBER, words(&INPUTS, io.inputs));
    say!("outputs  {}", words(&OUTPUTS, io.outputs));
    if io.refused != 0 {
        say!("refused  number {}: {}", io.number, reason(io.refused));
    }
}

fn figures(io: &Io) -> Value {
    let bits = |names: &[(&str, u8)], bits: u8| -> Map<String, Value> {
        let named = names.iter().map(|(name, bit)| (name.replace(' ', "_"), Value::from(bits & bit != 0)));
        named.collect()
    };
    let mut inputs = bits(&INPUTS, io.inputs);
    inputs.insert("number".to_owned(), Value::from(io.inputs & input::NUMBER));
    let refused = (io.refused != 0).then(|| reason(io.refused));
    json!({ "inputs": inputs, "outputs": bits(&OUTPUTS, io.outputs), "begun": io.number, "refused": refused })
}

/// Why a start was not carried out.
fn reason(code: u8) -> String {
    match code {
        refused::NO_RECORD => {
            "there is no record of this number; `pneudrive device records set` makes one".to_owned()
        }
        refused::OPEN_LOOP => "records are positions: set controller.loop to closed".to_owned(),
        refused::FAULT => {
            "a fault or a stop was not acknowledged: switch the input acknowledge on".to_owned()
        }
        refused::UNSETTLED => {
            "start or number changed before they had settled: keep both for at least safety.input_debounce_s and safety.input_settling_s".to_owned()
        }
        code => words::refusal(&RequestRefusal::NotNow(code)),
    }
}
