//! `Rig.export_fmu`: a model that other simulators load, as `pneudrive fmu` makes it.

use std::path::PathBuf;

use pneudrive_fmu::archive::{self, library_name};
use pneudrive_fmu::{Library, Part, Standard};
use pneudrive_records::whole_file::put;
use pyo3::exceptions::{PyFileExistsError, PyValueError};
use pyo3::prelude::*;

use crate::errors::NotThere;
use crate::rig::Rig;
use crate::work;

/// The library of FMUs that the package came with.
fn of_package(py: Python<'_>) -> PyResult<PathBuf> {
    let package: PathBuf = py.import("pneudrive")?.getattr("__path__")?.get_item(0)?.extract()?;
    let place = package.join("library").join(library_name());
    if place.is_file() {
        return Ok(place);
    }
    Err(NotThere::new_err(format!(
        "this package was built without {}; in the sources, `cargo build --release -p pneudrive-fmu-library` makes it: \
         library=\"target/release/{0}\"",
        library_name()
    )))
}

#[pymethods]
impl Rig {
    /// Writes an FMU of a `part` ("plant", "controller", or "drive", which is both) for FMI "3.0" or "2.0". `library` is the
    /// path of the FMU library, for a package that came without it.
    #[pyo3(signature = (path, /, *, part="drive", fmi="3.0", library=None, overwrite=false))]
    fn export_fmu(
        &self,
        py: Python<'_>,
        path: PathBuf,
        part: &str,
        fmi: &str,
        library: Option<PathBuf>,
        overwrite: bool,
    ) -> PyResult<()> {
        let parts = [Part::Drive, Part::Plant, Part::Controller];
        let part = parts.into_iter().find(|one| one.word() == part).ok_or_else(|| {
            PyValueError::new_err(format!(
                "part must be \"drive\", \"plant\" or \"controller\", is \"{part}\""
            ))
        })?;
        let standard = Standard::ALL.into_iter().find(|one| one.version() == fmi);
        let standard = standard
            .ok_or_else(|| PyValueError::new_err(format!("fmi must be \"3.0\" or \"2.0\", is \"{fmi}\"")))?;
        if path.exists() && !overwrite {
            let text = format!("{} exists; overwrite=True replaces it", path.display());
            return Err(PyFileExistsError::new_err(text));
        }
        let library = library.map_or_else(|| of_package(py), Ok)?;
        let (text, settings) = self.file()?;
        work::at_once(|| {
            let (rig, text) = archive::rig_file(&self.source.0, text, settings)?;
            let library = Library::read(&library)?;
            put(&path, &archive::fmu(standard, part, &rig, &text, &[library])?)
        })
    }
}
