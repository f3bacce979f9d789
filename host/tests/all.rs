//! All integration tests of this crate, as one program.

mod air;
mod bring_up;
mod calibration;
mod characterise;
mod cli;
mod commission;
mod crowd;
mod device;
#[cfg(unix)]
mod documents;
mod encoders;
mod every_command;
mod exit_codes;
mod files_of_others;
mod fixtures;
mod fmu;
mod from_transient;
mod help;
mod hidden_rigs;
mod hostile;
mod hostile_rig;
mod identify;
mod identify_valve;
mod json;
mod kills;
mod known;
mod logs;
mod models;
mod noise;
mod output;
mod plan_killed;
mod points;
mod ports;
mod pressure_sensors;
mod program;
mod readme;
mod recovery;
mod rig_files;
mod run_folders;
mod run_numbers;
mod shell;
#[allow(dead_code)] // It belongs to the tests of the link, which use the rest.
#[path = "../link/tests/simulated_link/mod.rs"]
mod simulated_link;
mod stream;
mod studies;
mod studio;
mod study;
mod sweep;
mod thesis;
mod tokens;
mod tolerance;
mod transients;
mod tune;
mod two_hosts;
