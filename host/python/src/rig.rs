//! `Rig`: one drive and one test.

use std::path::PathBuf;

use pneudrive_records::rig_source::rig_text;
use pneudrive_records::rig_text::with_settings;
use pneudrive_records::whole_file::put;
use pneudrive_sim::rig::{Kind, Preset, Problems, all_keys, find_key, key_of};
use pneudrive_sim::rigfile::value_of_setting;
use pneudrive_sim::{Accuracy, Method};
use pyo3::exceptions::{PyKeyError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping, PyString, PyTuple};

use crate::errors::{OrRaise, PneudriveError, of_problems};
use crate::{values, work};

/// What messages call values that were given in Python.
pub const VALUES: &str = "values";

/// What the reader of rig files calls settings.
const SETTINGS: &str = "--set";

/// A valid rig: one drive and one test.
#[pyclass(frozen, module = "pneudrive", from_py_object)]
#[derive(Clone, Debug)]
pub struct Rig {
    /// Name for messages, and text of the file.
    pub source: (String, String),
    /// What was set beside it, as `key=value`.
    pub settings: Vec<String>,
    /// What its plant has otherwise, as `key=value`: its controller does not know it.
    plant: Vec<String>,
    /// Their values.
    pub rig: pneudrive_sim::Rig,
}

impl Rig {
    /// Reads a file with settings.
    ///
    /// # Errors
    /// `RigError` with every problem.
    pub fn read(source: (String, String), settings: Vec<String>) -> PyResult<Rig> {
        Rig::made(source, settings, Vec::new())
    }

    /// The same, with another plant than its controller knows.
    fn made(source: (String, String), settings: Vec<String>, plant: Vec<String>) -> PyResult<Rig> {
        let read = work::at_once(|| {
            let known = pneudrive_sim::Rig::read_with(&source.0, &source.1, &settings);
            Ok(known.and_then(|rig| if plant.is_empty() { Ok(rig) } else { rig.with_plant(&plant) }))
        })?;
        let rig = read.map_err(|problems| of_problems(&renamed(problems)))?;
        Ok(Rig { source, settings, plant, rig })
    }

    /// Whether all keys have the values of another rig, and its controller knows as much of them.
    pub fn is_like(&self, other: &Rig) -> bool {
        let of = |rig| pneudrive_sim::Rig::entries(rig).map(|(key, value)| (key.path, value));
        self.plant == other.plant && of(&self.rig).eq(of(&other.rig))
    }

    /// The text of its file, and what was set beside it.
    ///
    /// # Errors
    /// `ValueError` when the plant differs from what its controller knows: a file says both at once.
    pub fn file(&self) -> PyResult<(&str, &[String])> {
        if self.plant.is_empty() {
            return Ok((&self.source.1, &self.settings));
        }
        Err(PyValueError::new_err(
            "the plant of this rig differs from what its controller knows, which no rig file can say; \
             rig.nominal is the rig that the controller knows, rig.to_dict() has the values of the plant",
        ))
    }

    /// How exactly its run is integrated: as it needs, or as is asked for.
    ///
    /// # Errors
    /// `ValueError` of a tolerance or method that there is not.
    pub fn accuracy(&self, tolerance: Option<f64>, method: Option<&str>) -> PyResult<Accuracy> {
        let usual = Accuracy::of(&self.rig);
        let tolerance = match tolerance {
            None => usual.tolerance,
            Some(tolerance) if (1e-13..=1e-2).contains(&tolerance) => tolerance,
            Some(other) => {
                return Err(PyValueError::new_err(format!(
                    "tolerance must be between 1e-13 and 1e-2, is {other}"
                )));
            }
        };
        let method = match method {
            None => usual.method,
            Some("dormand-prince") => Method::DormandPrince,
            Some("merson") => Method::Merson,
            Some(other) => {
                let known = "\"dormand-prince\" or \"merson\"";
                return Err(PyValueError::new_err(format!("method must be {known}, is \"{other}\"")));
            }
        };
        Ok(Accuracy { method, tolerance })
    }

    /// The rig file, with what was set in it.
    ///
    /// # Errors
    /// When the text is no TOML, or [`Rig::file`] has none.
    pub fn text(&self) -> PyResult<String> {
        let (text, settings) = self.file()?;
        with_settings(text, settings, "set in Python").or_raise()
    }
}

/// Kind of source of a value, the ends between which it lies, and what the file says of it.
type Origin = (&'static str, Option<(f64, f64)>, String);

/// What to say of a key that there is not.
fn unknown(path: &str) -> String {
    format!("{path}: {}", value_of_setting(path, "0").err().unwrap_or_default())
}

/// Settings are called what they are here.
fn renamed(mut problems: Problems) -> Problems {
    for problem in &mut problems.0 {
        if problem.source == SETTINGS {
            VALUES.clone_into(&mut problem.source);
        }
    }
    problems
}

/// Makes a rig from a built-in name, a file or values.
fn source_of(what: &Bound<'_, PyAny>) -> PyResult<((String, String), Vec<String>)> {
    if let Ok(values) = what.cast::<PyMapping>() {
        return Ok(((VALUES.to_owned(), String::new()), settings_of(values)?));
    }
    let path = what.extract::<PathBuf>().map_err(|_| {
        let kind = what.get_type().name().map_or_else(|_| "?".to_owned(), |name| name.to_string());
        PyTypeError::new_err(format!(
            "a rig is the name of a built-in one, a file, or a dict of its keys, not {kind}"
        ))
    })?;
    Ok((rig_text(&path.to_string_lossy()).or_raise()?, Vec::new()))
}

/// `{"load": {"mass_kg": 2}}` and `{"load.mass_kg": 2}` alike, as `key=value`.
pub fn settings_of(values: &Bound<'_, PyMapping>) -> PyResult<Vec<String>> {
    let mut settings = Vec::new();
    for item in values.items()?.iter() {
        let (name, value): (String, Bound<'_, PyAny>) = item.extract()?;
        let is_table = !name.contains('.') && all_keys().any(|key| key.table() == name);
        match value.cast::<PyMapping>() {
            Ok(table) if is_table => {
                for item in table.items()?.iter() {
                    let (key, value): (String, Bound<'_, PyAny>) = item.extract()?;
                    settings.push(values::setting(&format!("{name}.{key}"), &value)?);
                }
            }
            _ => settings.push(values::setting(&name, &value)?),
        }
    }
    Ok(settings)
}

/// Values of a mapping and of keywords, as `key=value`.
fn given(values: Option<&Bound<'_, PyMapping>>, keys: Option<&Bound<'_, PyDict>>) -> PyResult<Vec<String>> {
    let mut settings = values.map_or(Ok(Vec::new()), settings_of)?;
    for (name, value) in keys.into_iter().flatten() {
        let path = name.extract::<String>()?.replacen("__", ".", 1);
        settings.push(values::setting(&path, &value)?);
    }
    Ok(settings)
}

/// The settings whose keys others do not set anew.
fn without(settings: &[String], others: &[String]) -> Vec<String> {
    let key = |setting: &String| key_of(setting.split('=').next().unwrap_or_default()).map(|key| key.path);
    let anew: Vec<_> = others.iter().map(key).collect();
    settings.iter().filter(|setting| !anew.contains(&key(setting))).cloned().collect()
}

#[pymethods]
impl Rig {
    #[new]
    #[pyo3(signature = (what, /, **keys))]
    fn new(what: &Bound<'_, PyAny>, keys: Option<&Bound<'_, PyDict>>) -> PyResult<Rig> {
        let rig = match what.extract::<Rig>() {
            Ok(rig) => rig,
            Err(_) => {
                let (source, settings) = source_of(what)?;
                Rig::read(source, settings)?
            }
        };
        rig.with_(None, keys)
    }

    /// Returns this rig with other values: `rig.with_(load__mass_kg=2)` or `rig.with_({"load.mass_kg": 2})`.
    #[pyo3(signature = (values=None, /, **keys))]
    fn with_(
        &self,
        values: Option<&Bound<'_, PyMapping>>,
        keys: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Rig> {
        let set = given(values, keys)?;
        // The controller knows the settings.
        let plant = without(&self.plant, &set);
        Rig::made(self.source.clone(), [self.settings.clone(), set].concat(), plant)
    }

    /// Returns this rig with other values of its plant, unknown to its controller, which keeps those of this rig.
    #[pyo3(signature = (values=None, /, **keys))]
    fn with_plant(
        &self,
        values: Option<&Bound<'_, PyMapping>>,
        keys: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Rig> {
        let set = given(values, keys)?;
        let plant = [without(&self.plant, &set), set].concat();
        Rig::made(self.source.clone(), self.settings.clone(), plant)
    }

    /// The rig as its controller knows it.
    #[getter]
    fn nominal(&self) -> PyResult<Rig> {
        Rig::read(self.source.clone(), self.settings.clone())
    }

    /// The name of the rig.
    #[getter]
    fn name(&self) -> &str {
        self.rig.name()
    }

    /// Returns the value of a key, such as "load.mass_kg", in the unit that its name states; None for a key that is left out.
    fn __getitem__<'py>(&self, py: Python<'py>, path: &str) -> PyResult<Bound<'py, PyAny>> {
        match self.rig.value(path) {
            Some(value) => values::to_python(py, value),
            None if find_key(path).is_some() => Ok(py.None().into_bound(py)),
            None => Err(PyKeyError::new_err(unknown(path))),
        }
    }

    fn __contains__(&self, path: &str) -> bool {
        self.rig.value(path).is_some()
    }

    /// The values of all keys that have one, by key.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (key, value) in self.rig.entries() {
            dict.set_item(key.path, values::to_python(py, value)?)?;
        }
        Ok(dict)
    }

    /// The keys that are given but have no effect.
    #[getter]
    fn unused(&self) -> Vec<&'static str> {
        self.rig.unused()
    }

    /// The origin of a value: the kind of source, the range of the value in the unit of the key (None if the file states none),
    /// and the comment of the file.
    fn origin(&self, path: &str) -> PyResult<Origin> {
        let key = find_key(path).ok_or_else(|| PyKeyError::new_err(unknown(path)))?;
        let origin = self.rig.origin(key);
        Ok((origin.source.word(), origin.range.map(|[low, high]| (low, high)), origin.from))
    }

    /// Returns a rig whose physical values are drawn within a fraction of this one's, as those of a real drive are. Its
    /// controller knows those of this rig.
    #[pyo3(signature = (fraction, /, *, seed))]
    fn spread(&self, fraction: f64, seed: u64) -> PyResult<Rig> {
        let drawn =
            self.rig.spread(fraction, seed).map_err(|error| PneudriveError::new_err(error.to_string()))?;
        let differ = drawn.entries().filter(|(key, value)| self.rig.value(key.path) != Some(*value));
        let drawn: Vec<String> = differ.map(|(key, value)| key.setting(value)).collect();
        let plant = [without(&self.plant, &drawn), drawn].concat();
        Rig::made(self.source.clone(), self.settings.clone(), plant)
    }

    /// Returns the text of the rig file.
    fn to_toml(&self) -> PyResult<String> {
        self.text()
    }

    /// Writes the rig file.
    fn save(&self, path: PathBuf) -> PyResult<()> {
        put(&path, &self.text()?).or_raise()
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.extract::<Rig>().is_ok_and(|other| self.is_like(&other))
    }

    fn __repr__(&self) -> String {
        let plant = match self.plant.len() {
            0 => None,
            values => Some(format!("{values} values of its own plant")),
        };
        let said = self.settings.iter().cloned().chain(plant).collect::<Vec<_>>().join(", ");
        format!("<Rig {}{}{said}>", self.rig.name(), if said.is_empty() { "" } else { ": " })
    }

    /// For pickle, and so for other processes.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let make = py.get_type::<Rig>().getattr("_read")?;
        let (name, text) = &self.source;
        Ok((make, (name, text, &self.settings, &self.plant).into_pyobject(py)?))
    }

    #[staticmethod]
    fn _read(name: String, text: String, settings: Vec<String>, plant: Vec<String>) -> PyResult<Rig> {
        Rig::made((name, text), settings, plant)
    }
}

/// The keys of a rig file, each with its path, type, unit, default, and the help text of `pneudrive rig explain`.
#[pyfunction]
pub fn keys(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let one = |key: &'static pneudrive_sim::rig::Key| {
        let dict = PyDict::new(py);
        dict.set_item("path", key.path)?;
        dict.set_item("type", type_of(&key.kind, &key.preset))?;
        dict.set_item("unit", key.unit())?;
        dict.set_item("meaning", key.meaning)?;
        dict.set_item("help", explained(key.path)?)?;
        Ok(dict)
    };
    all_keys().map(one).collect()
}

/// The type of a key's value in Python.
fn type_of(kind: &Kind, preset: &Preset) -> String {
    let plain = match kind {
        Kind::Number { .. } => "float",
        Kind::Integer { .. } => "int",
        Kind::Switch => "bool",
        Kind::Choice(_) | Kind::Text => "str",
        Kind::Integers { .. } => "list[int]",
        Kind::Numbers { .. } => "list[float]",
        Kind::Rows { .. } => "list[list[float]]",
        Kind::Moves => "list[tuple[float, int]]",
        Kind::Tables(_) => "list[dict[str, Any]]",
        Kind::DefaultOnly => match preset {
            Preset::Switch(_) => "bool",
            _ => "float",
        },
    };
    if matches!(preset, Preset::Absent(_)) { format!("{plain} | None") } else { plain.to_owned() }
}

/// Returns the help text of a key, of all keys of a table or of a number of the thesis, or a list of all keys (for "").
#[pyfunction]
#[pyo3(signature = (name="", /))]
pub fn explain(name: &str) -> PyResult<String> {
    explained(name)
}

fn explained(name: &str) -> PyResult<String> {
    pneudrive_sim::rig::explain(name).map_err(|problem| of_problems(&Problems(vec![problem])))
}

/// The names of the built-in rigs.
#[pyfunction]
pub fn builtin_rigs() -> Vec<&'static str> {
    pneudrive_sim::rigfile::BUILTIN.iter().map(|(name, _)| *name).collect()
}

/// A rig, or what makes one: a name, a file or a dict.
pub struct RigOrSource(pub Rig);

impl<'a, 'py> FromPyObject<'a, 'py> for RigOrSource {
    type Error = PyErr;

    fn extract(what: Borrowed<'a, 'py, PyAny>) -> PyResult<RigOrSource> {
        if what.is_instance_of::<PyString>() || !what.is_instance_of::<Rig>() {
            return Rig::new(&what, None).map(RigOrSource);
        }
        Ok(RigOrSource(what.extract::<Rig>()?))
    }
}
