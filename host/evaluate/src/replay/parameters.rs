//! The controller's parameters, from the `# param.NAME = ...` lines of a TARGET file.

use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::{Parameter, SetError, TABLE, by_name};
use pneudrive_records::target::TargetFile;

use super::ReplayError;

/// The controller's parameters in the header.
#[derive(Clone, Debug)]
pub struct Header {
    /// The parameters; where the file has none, their defaults.
    pub parameters: Parameters,
    /// Parameters that only one side knows.
    pub notes: Vec<String>,
}

impl Header {
    /// Reads the parameters of a file. A firmware may have had fewer of them: their defaults hold. One that this program does
    /// not know is told, not refused: where all commands are equal it has made no difference.
    ///
    /// # Errors
    /// With the name of a value that is none, or out of range.
    pub fn of(file: &TargetFile) -> Result<Header, ReplayError> {
        let mut parameters = Parameters::default();
        for parameter in &TABLE {
            if let Some(text) = file.get(&key(parameter.name)) {
                set(&mut parameters, parameter, text)?;
            }
        }
        let missing = TABLE.iter().map(|parameter| parameter.name);
        let missing = missing.filter(|name| file.get(&key(name)).is_none());
        let names = file.header.iter().filter_map(|(key, _)| key.strip_prefix("param."));
        let unknown = names.filter(|name| by_name(name).is_none());
        let notes = [
            note(missing, "not in the file, so the default applies"),
            note(unknown, "in the file, but this version does not know it and ignores it"),
        ];
        Ok(Header { parameters, notes: notes.into_iter().flatten().collect() })
    }
}

fn key(name: &str) -> String {
    format!("param.{name}")
}

fn note<'a>(names: impl Iterator<Item = &'a str>, what: &str) -> Option<String> {
    let names: Vec<&str> = names.collect();
    (!names.is_empty()).then(|| format!("{}: {what}", names.join(", ")))
}

/// Takes over a value or, for an array, its entries; the last one holds to the end.
fn set(parameters: &mut Parameters, parameter: &Parameter, text: &str) -> Result<(), ReplayError> {
    let unreadable = || ReplayError::Header { key: key(parameter.name), found: format!("{text:?}") };
    let values: Result<Vec<i32>, _> = text.split(',').map(str::parse).collect();
    let values = values.ok().filter(|values| values.len() <= usize::from(parameter.len));
    let values = values.ok_or_else(unreadable)?;
    let last = values.last().copied().ok_or_else(unreadable)?;
    let entries = values.into_iter().chain(std::iter::repeat(last));
    for (id, value) in (parameter.id..parameter.id + parameter.len).zip(entries) {
        parameters.set(id, value).map_err(|error| match error {
            SetError::UnknownId => unreadable(),
            SetError::OutOfRange => out_of_range(parameter, value),
        })?;
    }
    Ok(())
}

fn out_of_range(parameter: &Parameter, value: i32) -> ReplayError {
    let Parameter { min, max, .. } = *parameter;
    ReplayError::OutOfRange { name: parameter.name.to_owned(), value, min, max }
}
