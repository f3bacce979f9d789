//! The parameters of a controller, by the names that keys of a rig file have.

use anyhow::{Context, Result};
use pneudrive_controller::Parameters;
use pneudrive_link::client::Client;
use pneudrive_records::parameter_names::{Written, names_of};
use pneudrive_records::words::few;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyMapping};

use crate::rig::{RigOrSource, settings_of};

/// What is to be changed.
pub enum Change {
    /// All of them, to those of a rig.
    Rig(Box<Parameters>),
    /// Some of them, as `name=value`.
    Some(Vec<String>),
}

impl Change {
    /// A rig, or names and values.
    pub fn of(values: &Bound<'_, PyAny>) -> PyResult<Change> {
        match values.cast::<PyMapping>() {
            Ok(values) => settings_of(values).map(Change::Some),
            Err(_) => Ok(Change::Rig(Box::new(values.extract::<RigOrSource>()?.0.rig.parameters()))),
        }
    }

    /// Changes them: all or none.
    pub fn carry_out(&self, client: &mut Client) -> Result<()> {
        let settings = match self {
            Change::Rig(parameters) => {
                let lacking = client.import_parameters(parameters)?;
                if !lacking.is_empty() {
                    let names = few(&names_of(&lacking));
                    log::warn!("its firmware has no {names}; their defaults apply");
                }
                return Ok(());
            }
            Change::Some(settings) => settings,
        };
        let mut parameters = client.parameters()?.values;
        let mut changed = Vec::new();
        for setting in settings {
            let (name, value) = setting.split_once('=').unwrap_or((setting, ""));
            let written = Written::named(name)
                .with_context(|| format!("there is no parameter {name}; config() lists them"))?;
            written.put(value, &mut parameters)?;
            let ids = written.parameter.id..written.parameter.id + written.parameter.len;
            changed.extend(ids.filter_map(|id| Some((id, parameters.get(id)?))));
        }
        client.change_parameters(&changed)
    }
}

/// Each by its name, as in a rig file: a number, a word, or a list of them.
pub fn to_python<'py>(py: Python<'py>, parameters: &Parameters) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for written in Written::all() {
        let first = written.parameter.id;
        let value = |id: u16| one(py, &written.text(parameters.get(id).unwrap_or(0)));
        match written.parameter.len {
            1 => dict.set_item(written.name, value(first)?)?,
            len => {
                let values = (first..first + len).map(value).collect::<PyResult<Vec<_>>>()?;
                dict.set_item(written.name, PyList::new(py, values)?)?;
            }
        }
    }
    Ok(dict)
}

fn one<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyAny>> {
    if let Ok(whole) = text.parse::<i64>() {
        return Ok(whole.into_pyobject(py)?.into_any());
    }
    match text.parse::<f64>() {
        Ok(number) => Ok(number.into_pyobject(py)?.into_any()),
        Err(_) => Ok(text.into_pyobject(py)?.into_any()),
    }
}
