//! `Units`: the integers of a rig in SI, and back.

use pneudrive_controller::parameters::id;
use pneudrive_records::units::lacks_pressures;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::rig::RigOrSource;

/// Conversions between a rig's integers and SI units, for numbers and arrays.
#[pyclass(frozen, module = "pneudrive")]
pub struct Units {
    position: Scale,
    pressure: Option<Scale>,
    spool: Option<Scale>,
    period_s: f64,
}

/// SI per count, and at 0.
#[derive(Clone, Copy)]
struct Scale {
    per_count: f64,
    at_0: f64,
}

impl Scale {
    /// Counts in SI.
    fn of<'py>(self, counts: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        counts.mul(self.per_count)?.add(self.at_0)
    }

    /// The nearest counts to a value in SI.
    fn counts<'py>(self, value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let numpy = value.py().import("numpy")?;
        let exact = numpy.call_method1("subtract", (value, self.at_0))?.div(self.per_count)?;
        let counts = numpy.call_method1("rint", (exact,))?.call_method1("astype", ("int64",))?;
        // A number gives a number.
        if counts.hasattr("__len__")? { Ok(counts) } else { counts.call_method0("item") }
    }
}

fn known(scale: Option<Scale>, lacks: &'static str) -> PyResult<Scale> {
    scale.ok_or_else(|| PyValueError::new_err(lacks))
}

const NO_PRESSURES: &str = "the rig measures no pressures";
const STEPS: &str = "the spool of a stepper is counted in steps";

#[pymethods]
impl Units {
    /// Makes the units of a rig.
    #[new]
    #[pyo3(signature = (rig, /))]
    fn new(rig: RigOrSource) -> Units {
        let values = rig.0.rig.parameters();
        let of = |id: u16| f64::from(values.get(id).unwrap_or(0));
        let full_scale = of(id::SENSOR_BITS).exp2() - 1.0;
        let between = |min: f64, max: f64| Scale { per_count: (max - min) / full_scale, at_0: min };
        let is_stepper = values.get(id::STEPPER) == Some(1);
        Units {
            position: Scale { per_count: 1e-12 * of(id::ENCODER_PM_PER_COUNT), at_0: 0.0 },
            pressure: (!lacks_pressures(&values))
                .then(|| between(of(id::PRESSURE_MIN_PA), of(id::PRESSURE_MAX_PA))),
            spool: (!is_stepper).then(|| between(1e-9 * of(id::SPOOL_MIN_NM), 1e-9 * of(id::SPOOL_MAX_NM))),
            period_s: 1e-6 * of(id::PERIOD_US),
        }
    }

    /// Converts positions or distances of the encoder from counts to m.
    fn position_m<'py>(&self, counts: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.position.of(counts)
    }

    /// Converts positions or distances from m to the nearest counts.
    fn position_counts<'py>(&self, m: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.position.counts(m)
    }

    /// Converts raw pressures to absolute ones, Pa.
    fn pressure_pa<'py>(&self, raw: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        known(self.pressure, NO_PRESSURES)?.of(raw)
    }

    /// Converts absolute pressures from Pa to the nearest raw ones.
    fn pressure_raw<'py>(&self, pa: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        known(self.pressure, NO_PRESSURES)?.counts(pa)
    }

    /// Converts raw spool displacements to m.
    fn spool_m<'py>(&self, raw: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        known(self.spool, STEPS)?.of(raw)
    }

    /// Converts spool displacements from m to the nearest raw ones.
    fn spool_raw<'py>(&self, m: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        known(self.spool, STEPS)?.counts(m)
    }

    /// Converts numbers of samples to times, s.
    fn time_s<'py>(&self, samples: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        samples.mul(self.period_s)
    }

    fn __repr__(&self) -> String {
        format!("<Units: {} m a count, {} s a sample>", self.position.per_count, self.period_s)
    }
}
