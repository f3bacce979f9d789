//! The Python package `pneudrive`: its compiled part, `pneudrive._pneudrive`.

mod channels;
mod controller;
mod errors;
mod identify;
mod moves;
mod notes;
mod progress;
mod rig;
mod run;
mod sweep;
mod target;
mod transient;
mod tune;
mod values;
mod work;

use pyo3::prelude::*;

#[pymodule]
mod _pneudrive {
    #[pymodule_export]
    use super::channels::Channels;
    #[pymodule_export]
    use super::controller::{Command, Controller, Plant, Sample};
    #[pymodule_export]
    use super::identify::{Estimate, Identification, identify};
    #[pymodule_export]
    use super::moves::{Evaluation, Figure, Move, evaluate};
    #[pymodule_export]
    use super::rig::{Rig, builtin_rigs, explain, keys};
    #[pymodule_export]
    use super::run::{Decided, Run, Trip};
    #[pymodule_export]
    use super::sweep::{SweepResult, sweep};
    #[pymodule_export]
    use super::target::Target;
    #[pymodule_export]
    use super::transient::{Deviation, Overlay, Transient, overlay};
    #[pymodule_export]
    use super::tune::{Share, Tuned, tune};

    #[pymodule_init]
    fn init() {
        super::notes::begin();
    }
}
