//! `VirtualRig`: the firmware's application on the simulated plant, at a port: a drive without hardware.

use std::sync::Mutex;
use std::sync::PoisonError;

use pneudrive_rigs::virtual_rig::{self, Background, Listener, Pace};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::rig::RigOrSource;
use crate::work;

/// A virtual rig, which serves a port until it is closed.
#[pyclass(frozen, module = "pneudrive")]
pub struct VirtualRig {
    port: String,
    background: Mutex<Option<Background>>,
}

#[pymethods]
impl VirtualRig {
    /// Starts a virtual rig with the parameters of `rig`, or with true ones drawn within the fraction `spread` of them. It
    /// listens at "pty" or "tcp:HOST:PORT"; port 0 is any free one. `fast`: as fast as possible, instead of in real time.
    /// `live`: the plant continues between runs. `seed` is that of the drawn parameters and the sensor noise.
    #[new]
    #[pyo3(signature = (rig, /, *, listen="tcp:127.0.0.1:0", fast=true, live=false, spread=None, seed=1))]
    fn new(
        rig: RigOrSource,
        listen: &str,
        fast: bool,
        live: bool,
        spread: Option<f64>,
        seed: u64,
    ) -> PyResult<VirtualRig> {
        let background = work::at_once(|| {
            let nominal = rig.0.rig;
            let rig = match spread {
                Some(fraction) => nominal.spread(fraction, seed)?,
                None => nominal,
            };
            let rig = virtual_rig::VirtualRig::new(rig, seed, Pace { fast, live })?;
            Ok(Background::start(rig, Listener::open(listen)?))
        })?;
        Ok(VirtualRig { port: background.port().to_owned(), background: Mutex::new(Some(background)) })
    }

    /// The port, for `Drive`.
    #[getter]
    fn port(&self) -> &str {
        &self.port
    }

    fn __enter__(slf: Py<VirtualRig>) -> Py<VirtualRig> {
        slf
    }

    #[pyo3(signature = (kind, *_rest))]
    fn __exit__(
        &self,
        py: Python<'_>,
        kind: &Bound<'_, PyAny>,
        _rest: &Bound<'_, PyTuple>,
    ) -> PyResult<bool> {
        let closed = self.close(py);
        if kind.is_none() { closed.map(|()| false) } else { Ok(false) }
    }

    /// Stops serving and closes the port.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        let background = self.background.lock().unwrap_or_else(PoisonError::into_inner).take();
        match background {
            Some(background) => work::run(py, None, |_| background.stop()),
            None => Ok(()),
        }
    }

    fn __repr__(&self) -> String {
        format!("<VirtualRig at {}>", self.port)
    }
}
