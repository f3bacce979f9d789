//! The Python package `pneudrive`: its compiled part, `pneudrive._pneudrive`.

#![deny(clippy::print_stdout, clippy::print_stderr)]

mod bench;
mod channels;
mod characteristics;
mod controller;
mod design;
mod drive;
mod errors;
mod evaluate;
mod fmu;
mod identify;
mod linear;
mod moves;
mod notes;
mod order;
mod overlay;
mod parameters;
mod plant;
mod points;
mod progress;
mod rig;
mod run;
mod source;
mod stream;
mod sweep;
mod swept;
mod target;
mod transient;
mod tune;
mod units;
mod values;
mod virtual_rig;
mod work;

use pyo3::prelude::*;

#[pymodule]
mod _pneudrive {
    #[pymodule_export]
    use super::channels::Channels;
    #[pymodule_export]
    use super::characteristics::{Characteristic, Curve, CurveFigure};
    #[pymodule_export]
    use super::controller::{Command, Controller, Sample};
    #[pymodule_export]
    use super::design::questions;
    #[pymodule_export]
    use super::drive::Drive;
    #[pymodule_export]
    use super::evaluate::evaluate;
    #[pymodule_export]
    use super::identify::{Estimate, Identification, identify};
    #[pymodule_export]
    use super::linear::LinearModel;
    #[pymodule_export]
    use super::moves::{Evaluation, Figure, Move};
    #[pymodule_export]
    use super::overlay::{Deviation, Overlay, overlay};
    #[pymodule_export]
    use super::plant::{Plant, advance};
    #[pymodule_export]
    use super::points::SentPoints;
    #[pymodule_export]
    use super::rig::{Rig, builtin_rigs, explain, keys};
    #[pymodule_export]
    use super::run::{Converged, Run, Trip};
    #[pymodule_export]
    use super::stream::Stream;
    #[pymodule_export]
    use super::sweep::sweep;
    #[pymodule_export]
    use super::swept::SweepResult;
    #[pymodule_export]
    use super::target::Target;
    #[pymodule_export]
    use super::transient::Transient;
    #[pymodule_export]
    use super::tune::{Share, Tuned, tune};
    #[pymodule_export]
    use super::units::Units;

    #[pymodule_export]
    use super::virtual_rig::VirtualRig;

    #[pymodule_export]
    use super::work::_panic;

    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "Python's name of it")]
    const __version__: &str = env!("CARGO_PKG_VERSION");

    #[pymodule_init]
    fn init() {
        super::notes::begin();
    }
}
