//! A real board as an execution level, named by environment variables.
//!
//! | variable | names |
//! |---|---|
//! | `PNEUDRIVE_BOARD` | the port of the protocol, such as `/dev/ttyACM0` |
//! | `PNEUDRIVE_BOARD_PLANT` | the second port, of a board whose image speaks the plant bus there: the plant is simulated here, and every test body of a simulated execution level runs |
//! | `PNEUDRIVE_BOARD_RIG` | without the second port: the rig file, or built-in rig, whose test may be run on the cylinder that is there; its record is replayed |
//!
//! Any name that `pneudrive --port` takes will do. Without the first one there is nothing to test, and that is
//! an error.

use std::sync::OnceLock;

use anyhow::{Context, Result, bail};
use pneudrive_link::client::Client;
use pneudrive_sim::Rig;

use crate::board_plant::BoardPlant;
use crate::service::commission;
use crate::{PATIENCE, Target, body};

/// What is at the bench.
pub struct BoardBench {
    port: String,
    plant: Plant,
}

/// What the board drives.
enum Plant {
    /// A simulation in lock step, over the second port.
    Simulated(BoardPlant),
    /// A cylinder, for which a test was named.
    Real(Box<Rig>),
}

/// A test body that panics, as tests do.
type Run = Box<dyn Fn()>;

/// A test body and its name.
pub type Body = (&'static str, Run);

/// A test body of every simulated execution level.
type OnLevel = fn(body::Start);

static BENCH: OnceLock<BoardBench> = OnceLock::new();

impl BoardBench {
    /// The bench that the variables name; once in a process.
    ///
    /// # Errors
    /// When they name none, or nobody answers.
    pub fn from_environment() -> Result<&'static BoardBench> {
        let variable = |name: &str| std::env::var(name).ok().filter(|value| !value.is_empty());
        let port = variable("PNEUDRIVE_BOARD").context(
            "PNEUDRIVE_BOARD is not set: set it to the board's port, such as /dev/ttyACM0; there is nothing to test without a board",
        )?;
        let plant = match (variable("PNEUDRIVE_BOARD_PLANT"), variable("PNEUDRIVE_BOARD_RIG")) {
            (Some(plant), _) => Plant::Simulated(BoardPlant::open(
                &plant,
                &Rig::builtin("servo-b").context("a built-in rig")?,
            )?),
            (None, Some(rig)) => Plant::Real(Box::new(read_rig(&rig)?)),
            (None, None) => bail!(
                "set PNEUDRIVE_BOARD_PLANT to the board's second port, for a simulated plant, or PNEUDRIVE_BOARD_RIG to the rig file whose test may be run on the cylinder that is there"
            ),
        };
        Ok(BENCH.get_or_init(|| BoardBench { port, plant }))
    }

    /// The test bodies for what the board drives.
    #[must_use]
    pub fn bodies(&self) -> Vec<Body> {
        match &self.plant {
            Plant::Simulated(_) => simulated(),
            Plant::Real(rig) => {
                let rig = rig.clone();
                let replays = move || body::the_record_of_a_real_cylinder_replays(&start_as_it_is, &rig);
                vec![("the record of the cylinder replays", Box::new(replays))]
            }
        }
    }
}

/// A rig by its built-in name or file, its recorder at every sample: without that a record is no proof.
fn read_rig(name: &str) -> Result<Rig> {
    let text = match pneudrive_sim::rigfile::builtin(name) {
        Some(text) => text.to_owned(),
        None => std::fs::read_to_string(name).with_context(|| format!("PNEUDRIVE_BOARD_RIG {name}"))?,
    };
    let every_sample = ["test.decimation=1".to_owned(), "test.pre_trigger=0".to_owned()];
    Rig::read_with(name, &text, &every_sample).map_err(|problems| anyhow::anyhow!("{problems}"))
}

fn simulated() -> Vec<Body> {
    let bodies: [(&str, OnLevel); 15] = [
        ("closed loops are the simulation", body::closed_loop),
        ("open loops are the simulation", body::open_loop),
        ("profiles are those of the simulation and replay", body::profiles),
        ("a drive whose first move comes late stays where it is", body::a_late_first_move),
        ("a fault after the moves of a run trips the drive that holds", body::a_fault_after_the_moves),
        ("the other built-in rigs are the simulation", body::other_built_in_rigs),
        ("a stepper drive is the simulation", body::stepper),
        ("records replay on the PC", body::records_replay),
        ("a stopped run replays up to there", body::the_record_of_a_stopped_run_replays),
        ("each start begins from the same state", body::each_start_begins_from_the_same_state),
        ("another period is kept", body::another_period),
        ("a stop ends a run in a named fault", body::a_stop_ends_a_run_in_a_named_fault_and_arming_leaves_it),
        ("faults of the plant trip by name", body::axis::faults_of_the_plant_trip_by_name),
        ("moves wait for the arrival", body::axis::moves_on_arrival),
        ("a step meets its requirements", body::axis::a_step_meets_its_requirements),
    ];
    bodies.into_iter().map(|(name, body)| (name, Box::new(move || body(start)) as Run)).collect()
}

/// The board, for one test body.
struct BoardTarget {
    bench: &'static BoardBench,
}

/// Puts the board into service with a simulated plant, as on the other execution levels.
fn start(rig: &Rig) -> Box<dyn Target> {
    let bench = BENCH.get().expect("a body runs at a bench");
    if let Plant::Simulated(plant) = &bench.plant {
        plant.set_rig(rig);
    }
    let target = BoardTarget { bench };
    let mut client = target.connect().expect("a board that answers");
    // Whatever the body before has left: a run, a fault, other parameters.
    client.disarm().expect("an answer");
    if client.status().expect("an answer").mode == pneudrive_protocol::Mode::Fault {
        client.arm().expect("arming leaves the fault");
        client.disarm().expect("an answer");
    }
    // A serial port is one program's, and one connection's.
    drop(client);
    commission(&target, rig).expect("disarmed");
    Box::new(target)
}

/// The board with its own parameters and reference: those of its cylinder.
fn start_as_it_is(_: &Rig) -> Box<dyn Target> {
    Box::new(BoardTarget { bench: BENCH.get().expect("a body runs at a bench") })
}

impl Target for BoardTarget {
    fn name(&self) -> &str {
        &self.bench.port
    }

    fn port(&self) -> &str {
        &self.bench.port
    }

    fn connect(&self) -> Result<Client> {
        match self.bench.plant {
            Plant::Simulated(_) => Client::connect_patiently(self.port(), PATIENCE),
            Plant::Real(_) => Client::connect(self.port()),
        }
    }
}
