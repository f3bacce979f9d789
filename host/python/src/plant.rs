//! The plant alone, for a loop of one's own: one, or many side by side.
//!
//! A plant is a value: a copy goes on as its original would, in every bit. A pickled plant is its rig and its commands,
//! which are repeated: a plant has no other past, as looking at it changes nothing.

use std::sync::Arc;

use anyhow::{Context, Result};
use pneudrive_controller as controller;
use pneudrive_sim::Accuracy;
use pneudrive_sim::plant::{QUANTITIES, Snapshot};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use rayon::prelude::*;

use crate::channels::{Channels, Column, Columns};
use crate::controller::{Command, Sample};
use crate::errors::SimulationError;
use crate::linear::LinearModel;
use crate::rig::{Rig, RigOrSource};
use crate::work;

/// The plant of a rig as a controller sees it: a command in, a sample out.
#[pyclass(module = "pneudrive")]
#[derive(Clone)]
pub struct Plant {
    made: Arc<Made>,
    seed: u64,
    now: Now,
}

/// What a plant is made from, but for the seed of its noise.
struct Made {
    rig: Rig,
    tolerance: Option<f64>,
    method: Option<String>,
    accuracy: Accuracy,
    period_us: u64,
}

/// Where it is.
#[derive(Clone)]
struct Now {
    plant: pneudrive_sim::Plant,
    /// The present one.
    sample: controller::Sample,
    /// All that it was given.
    commands: Vec<controller::Command>,
    /// What ended it.
    failure: Option<String>,
}

/// What is seen of a plant at a sample.
struct Row {
    time_s: f64,
    seen: Snapshot,
    sample: controller::Sample,
}

/// A reading of a sensor, by name.
type Reading = (&'static str, fn(&Row) -> i32);

/// The readings of the sensors.
const READINGS: [Reading; 5] = [
    ("position_counts", |row| row.sample.position),
    ("pressure_1_raw", |row| row.sample.pressure_1.into()),
    ("pressure_2_raw", |row| row.sample.pressure_2.into()),
    ("spool_raw", |row| row.sample.spool.into()),
    ("home_switch", |row| row.sample.home_switch.into()),
];

fn columns(rows: &[Row]) -> Columns {
    let column = |name: &str, of: &dyn Fn(&Row) -> f64| {
        (name.to_owned(), Column::Float(rows.iter().map(of).collect()))
    };
    let time = column("time_s", &|row| row.time_s);
    let seen = QUANTITIES.iter().map(|quantity| column(quantity.name, &|row| (quantity.of)(&row.seen)));
    let read =
        READINGS.iter().map(|(name, of)| ((*name).to_owned(), Column::Int(rows.iter().map(of).collect())));
    std::iter::once(time).chain(seen).chain(read).collect()
}

impl Made {
    /// The plant in the initial state of the rig's test.
    fn at_start(&self, seed: u64) -> PyResult<Now> {
        work::at_once(|| {
            let mut plant = pneudrive_sim::Plant::new(&self.rig.rig, self.accuracy, seed);
            let sample = plant.sample()?;
            Ok(Now { plant, sample, commands: Vec::new(), failure: None })
        })
    }

    fn is_like(&self, other: &Made) -> bool {
        self.accuracy == other.accuracy && self.rig.is_like(&other.rig)
    }
}

impl Now {
    /// To the next sample.
    fn advance(&mut self, command: controller::Command) -> Result<()> {
        self.commands.push(command);
        match self.plant.advance(command) {
            Ok(sample) => self.sample = sample,
            Err(error) => {
                self.failure = Some(error.to_string());
                return Err(error.into());
            }
        }
        Ok(())
    }

    /// What is seen at the present sample.
    fn row(&mut self, period_us: u64) -> Result<Row> {
        let time_s = (self.commands.len() as u64 * period_us) as f64 / 1e6;
        Ok(Row { time_s, seen: self.plant.look(time_s)?, sample: self.sample })
    }

    /// Goes through samples: a row each.
    fn rows(
        &mut self,
        commands: impl Iterator<Item = controller::Command>,
        period_us: u64,
    ) -> impl Iterator<Item = Result<Row>> {
        commands.map(move |command| {
            self.advance(command)?;
            self.row(period_us)
        })
    }

    /// # Errors
    /// `SimulationError` if it has ended.
    fn check(&self) -> PyResult<()> {
        self.failure.as_ref().map_or(Ok(()), |failure| Err(SimulationError::new_err(failure.clone())))
    }
}

#[pymethods]
impl Plant {
    /// Makes the plant in the initial state of the rig's test. `seed` is that of the sensor noise.
    #[new]
    #[pyo3(signature = (rig, /, *, seed=0, tolerance=None, method=None))]
    fn new(rig: RigOrSource, seed: u64, tolerance: Option<f64>, method: Option<String>) -> PyResult<Plant> {
        let rig: Rig = rig.0;
        let accuracy = rig.accuracy(tolerance, method.as_deref())?;
        let period_us = rig.rig.period_us().get().into();
        let made = Made { rig, tolerance, method, accuracy, period_us };
        Ok(Plant { now: made.at_start(seed)?, seed, made: Arc::new(made) })
    }

    /// The rig of the plant.
    #[getter]
    fn rig(&self) -> Rig {
        self.made.rig.clone()
    }

    /// Returns the readings of the sensors at the present sample, in raw units.
    fn sample(&self) -> PyResult<Sample> {
        self.now.check()?;
        Ok(self.now.sample.into())
    }

    /// Advances to the next sample, with this command in force from the output in between, and returns that sample. With
    /// `n`, advances n samples with the command held, and returns one row per sample with the keys of `state` and the
    /// readings of the sensors as integers.
    #[pyo3(signature = (command, n=None))]
    fn advance<'py>(
        &mut self,
        py: Python<'py>,
        command: Command,
        n: Option<usize>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.now.check()?;
        let (now, period_us) = (&mut self.now, self.made.period_us);
        let Some(n) = n else {
            py.detach(|| work::at_once(|| now.advance(command.into())))?;
            return Ok(Bound::new(py, Sample::from(now.sample))?.into_any());
        };
        let rows: Vec<Row> = work::run_here(py, None, |tell| {
            let rows = now.rows(std::iter::repeat_n(command.into(), n), period_us);
            rows.enumerate().inspect(|(i, _)| tell(*i as u64, n as u64)).map(|(_, row)| row).collect()
        })?;
        Ok(Bound::new(py, Channels::new(move || columns(&rows)))?.into_any())
    }

    /// Returns to the initial state of the rig's test and restarts the sensor noise, with another seed if one is given.
    /// Returns the sample there.
    #[pyo3(signature = (*, seed=None))]
    fn reset(&mut self, seed: Option<u64>) -> PyResult<Sample> {
        self.seed = seed.unwrap_or(self.seed);
        self.now = self.made.at_start(self.seed)?;
        self.sample()
    }

    /// Returns a copy, which continues bit for bit as this plant would.
    fn copy(&self) -> Plant {
        self.clone()
    }

    fn __copy__(&self) -> Plant {
        self.clone()
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Plant {
        self.clone()
    }

    /// Takes the state of another plant of the same rig: from there both continue alike, bit for bit.
    fn restore(&mut self, kept: PyRef<'_, Plant>) -> PyResult<()> {
        if !Arc::ptr_eq(&self.made, &kept.made) && !self.made.is_like(&kept.made) {
            return Err(PyValueError::new_err(
                "a plant takes the state of one of the same rig, tolerance and method alone",
            ));
        }
        (self.seed, self.now) = (kept.seed, kept.now.clone());
        Ok(())
    }

    /// The time and the quantities of the plant at the present sample, in SI units unless the name says otherwise.
    #[getter]
    fn state<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.now.check()?;
        let (now, period_us) = (&mut self.now, self.made.period_us);
        let row = py.detach(|| work::at_once(|| now.row(period_us)))?;
        let dict = PyDict::new(py);
        dict.set_item("time_s", row.time_s)?;
        for quantity in &QUANTITIES {
            dict.set_item(quantity.name, (quantity.of)(&row.seen))?;
        }
        Ok(dict)
    }

    /// Linearises the plant about its present state, with the command as input.
    fn linearise(&mut self) -> PyResult<LinearModel> {
        self.now.check()?;
        let plant = &mut self.now.plant;
        let model = work::at_once(|| Ok(plant.linearise()))?;
        model.map(LinearModel).map_err(|why| PyValueError::new_err(why.to_string()))
    }

    fn __repr__(&self) -> String {
        format!("<Plant at sample {}>", self.now.commands.len())
    }

    /// For pickle, and so for other processes: the commands are sent, and repeated there.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let Made { rig, tolerance, method, .. } = &*self.made;
        let commands: Vec<(i16, i8)> =
            self.now.commands.iter().map(|command| (command.counts, command.step)).collect();
        let make = py.get_type::<Plant>().getattr("_repeated")?;
        let from = (rig.clone(), self.seed, *tolerance, method, commands, Sample::from(self.now.sample));
        Ok((make, from.into_pyobject(py)?))
    }

    #[staticmethod]
    fn _repeated(
        py: Python<'_>,
        rig: RigOrSource,
        seed: u64,
        tolerance: Option<f64>,
        method: Option<String>,
        commands: Vec<(i16, i8)>,
        sample: Sample,
    ) -> PyResult<Plant> {
        let mut plant = Plant::new(rig, seed, tolerance, method)?;
        let now = &mut plant.now;
        work::run_here(py, None, |tell| {
            for (k, (counts, step)) in (0..).zip(&commands) {
                tell(k, commands.len() as u64);
                // One that has failed fails again, at its last command.
                let command = controller::Command { counts: *counts, step: *step, drive_enable: true };
                if now.advance(command).is_err() {
                    break;
                }
            }
            Ok(())
        })?;
        if Sample::from(plant.now.sample) != sample {
            return Err(PyValueError::new_err(
                "the plant was pickled by another version of pneudrive, in which it moves otherwise",
            ));
        }
        Ok(plant)
    }
}

/// Advances plants through samples in parallel, on all processors.
///
/// `commands` is a table of counts with one row per plant and one column per sample; for a stepper `steps` is one of its pulses.
/// Returns the columns of `Plant.advance(command, n)` as arrays of the same shape.
#[pyfunction]
#[pyo3(signature = (plants, commands, *, steps=None))]
pub fn advance<'py>(
    py: Python<'py>,
    plants: Vec<Bound<'py, Plant>>,
    commands: Vec<Vec<i16>>,
    steps: Option<Vec<Vec<i8>>>,
) -> PyResult<Bound<'py, PyDict>> {
    let n = commands.first().map_or(0, Vec::len);
    let lengths = commands.iter().map(Vec::len).chain(steps.iter().flatten().map(Vec::len));
    let mut heights = [Some(commands.len()), steps.as_ref().map(Vec::len)].into_iter().flatten();
    if !heights.all(|height| height == plants.len()) || lengths.into_iter().any(|length| length != n) {
        return Err(PyValueError::new_err(format!(
            "a table of commands has a row for each of {} plants, all of one length",
            plants.len()
        )));
    }
    let steps = steps.unwrap_or_else(|| vec![vec![0; n]; plants.len()]);
    let pairs = commands.into_iter().zip(steps).map(|(counts, steps)| {
        counts
            .into_iter()
            .zip(steps)
            .map(|(counts, step)| Command::new(counts, step, true).map(Into::into))
            .collect()
    });
    let commands: Vec<Vec<controller::Command>> = pairs.collect::<PyResult<_>>()?;
    let mut held = Vec::new();
    for (i, plant) in plants.iter().enumerate() {
        let plant = plant.try_borrow_mut().map_err(|_| {
            PyValueError::new_err(format!("plant {i} is there twice, or at work on another thread"))
        })?;
        plant.now.check()?;
        held.push(plant);
    }
    let mut todo: Vec<_> = held
        .iter_mut()
        .zip(commands)
        .map(|(plant, row)| (plant.made.period_us, &mut plant.now, row))
        .collect();
    let rows: Vec<Vec<Row>> = work::run(py, None, |meter| {
        work::pool(None)?.install(|| {
            todo.par_iter_mut()
                .enumerate()
                .map(|(i, (period_us, now, row))| {
                    let rows = now.rows(row.iter().copied(), *period_us);
                    let seen: Result<Vec<Row>> = rows.inspect(|_| meter.at(0, 0)).collect();
                    seen.with_context(|| format!("plant {i}"))
                })
                .collect()
        })
    })?;
    let shape = (rows.len(), n);
    let rows: Vec<Row> = rows.into_iter().flatten().collect();
    let dict = PyDict::new(py);
    for (name, column) in columns(&rows) {
        dict.set_item(name, column.into_python(py)?.call_method1("reshape", (shape,))?)?;
    }
    Ok(dict)
}
