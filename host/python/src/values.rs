//! Values of keys between Python and rig files.

use pneudrive_sim::rig::{Fields, Kind, Value, find_key};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyMapping, PyString, PyTuple};
use serde_json::Value as Json;
use toml_edit::{Array, InlineTable, Value as Toml};

/// A value of a key as Python has it: float, int, bool, str, a list of numbers, of (time in s, counts), or of dicts.
pub fn to_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::Number(number) => PyFloat::new(py, *number).into_any(),
        Value::Integer(number) => number.into_pyobject(py)?.into_any(),
        Value::Switch(on) => PyBool::new(py, *on).to_owned().into_any(),
        Value::Word(word) => PyString::new(py, word).into_any(),
        Value::Integers(numbers) => PyList::new(py, numbers)?.into_any(),
        Value::Numbers(numbers) => PyList::new(py, numbers)?.into_any(),
        Value::Rows(rows) => PyList::new(py, rows)?.into_any(),
        Value::Moves(moves) => PyList::new(py, moves)?.into_any(),
        Value::Events(events) => {
            let events = events.iter().map(|fields| fields_to_python(py, fields));
            PyList::new(py, events.collect::<PyResult<Vec<_>>>()?)?.into_any()
        }
    })
}

fn fields_to_python<'py>(py: Python<'py>, fields: &Fields) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, value) in fields {
        dict.set_item(name, to_python(py, value)?)?;
    }
    Ok(dict)
}

/// `key=value` in TOML, as the command line takes it.
///
/// # Errors
/// `TypeError` of a value that no rig file can have, with its key.
pub fn setting(path: &str, value: &Bound<'_, PyAny>) -> PyResult<String> {
    let toml = to_toml(value).map_err(|error| {
        let py = value.py();
        let text = format!("{path}: {}", error.value(py));
        if error.is_instance_of::<PyValueError>(py) {
            PyValueError::new_err(text)
        } else {
            PyTypeError::new_err(text)
        }
    })?;
    let is_moves = find_key(path).is_some_and(|key| key.kind == Kind::Moves);
    Ok(format!("{path}={}", if is_moves { whole_counts(toml) } else { toml }))
}

/// A table of NumPy holds times and counts in one type: counts that are whole become integers.
fn whole_counts(mut moves: Toml) -> Toml {
    let all = moves.as_array_mut().into_iter().flat_map(Array::iter_mut);
    for count in all.filter_map(|pair| pair.as_array_mut()?.get_mut(1)) {
        if let Some(whole) = count.as_float().filter(|number| number.fract() == 0.0 && number.abs() < 2e9) {
            *count = (whole as i64).into();
        }
    }
    moves
}

/// A value of Python or NumPy in TOML.
pub fn to_toml(value: &Bound<'_, PyAny>) -> PyResult<Toml> {
    if let Ok(on) = value.cast::<PyBool>() {
        Ok(on.is_true().into())
    } else if value.is_instance_of::<PyInt>() {
        Ok(value.extract::<i64>().map_err(|_| PyValueError::new_err(format!("{value} is too large")))?.into())
    } else if value.is_instance_of::<PyFloat>() {
        Ok(value.extract::<f64>()?.into())
    } else if let Ok(text) = value.cast::<PyString>() {
        Ok(text.to_str()?.into())
    } else if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        Ok(Toml::Array(value.try_iter()?.map(|entry| to_toml(&entry?)).collect::<PyResult<Array>>()?))
    } else if let Ok(mapping) = value.cast::<PyMapping>() {
        inline_table(mapping)
    } else if value.hasattr("tolist")? {
        to_toml(&value.call_method0("tolist")?)
    } else {
        let kind = value.get_type().name()?;
        Err(PyTypeError::new_err(format!("a rig file has numbers, texts, switches and lists, not {kind}")))
    }
}

fn inline_table(mapping: &Bound<'_, PyMapping>) -> PyResult<Toml> {
    let mut table = InlineTable::new();
    for item in mapping.items()?.iter() {
        let (name, value): (String, Bound<'_, PyAny>) = item.extract()?;
        table.insert(name, to_toml(&value)?);
    }
    Ok(Toml::InlineTable(table))
}

/// Numbers, texts, lists and dicts; null is None.
pub fn json_to_python<'py>(py: Python<'py>, json: &Json) -> PyResult<Bound<'py, PyAny>> {
    Ok(match json {
        Json::Null => py.None().into_bound(py),
        Json::Bool(on) => PyBool::new(py, *on).to_owned().into_any(),
        Json::Number(number) => match number.as_i64() {
            Some(whole) => whole.into_pyobject(py)?.into_any(),
            None => PyFloat::new(py, number.as_f64().unwrap_or(f64::NAN)).into_any(),
        },
        Json::String(text) => PyString::new(py, text).into_any(),
        Json::Array(list) => {
            let list = list.iter().map(|entry| json_to_python(py, entry));
            PyList::new(py, list.collect::<PyResult<Vec<_>>>()?)?.into_any()
        }
        Json::Object(fields) => {
            let dict = PyDict::new(py);
            for (name, value) in fields {
                dict.set_item(name, json_to_python(py, value)?)?;
            }
            dict.into_any()
        }
    })
}
