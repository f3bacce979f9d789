//! All integration tests of this crate, as one program.

mod commanding;
mod commission;
mod commission_motion;
mod commission_tasks;
mod design;
mod refusals;
mod simulated;
mod stop;
mod study;
mod visitor;
mod wire;
