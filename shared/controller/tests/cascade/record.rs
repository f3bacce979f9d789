//! Drives under the law, recorded on the twin (`cargo run --release -p pneudrive-sim --example law_records`): parameters, then what the
//! controller got and commanded at each sample.

use pneudrive_controller::parameters::TABLE;
use pneudrive_controller::{Config, Move, Parameters, Sample, Sequence, State};

use crate::bench::{self, ControllerBench};

/// Each record by its name.
pub const RECORDS: [(&str, &str); 7] = [
    ("level", include_str!("records/level.csv")),
    ("upright", include_str!("records/upright.csv")),
    ("often", include_str!("records/often.csv")),
    ("slow", include_str!("records/slow.csv")),
    ("bristles", include_str!("records/bristles.csv")),
    ("spring", include_str!("records/spring.csv")),
    ("stepper", include_str!("records/stepper.csv")),
];

/// What the controller got at a sample, and what it commanded.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    pub position: i32,
    pub pressures: [i16; 2],
    /// 0 where the law does not look at it.
    pub spool: i16,
    pub setpoint: i32,
    pub command: i16,
}

#[derive(Clone)]
pub struct Record {
    pub parameters: Parameters,
    pub rows: Vec<Row>,
}

impl Record {
    pub fn read(text: &str) -> Record {
        let (header, rows): (Vec<&str>, Vec<&str>) = text.lines().partition(|line| line.starts_with('#'));
        let mut parameters = Parameters::default();
        for line in header {
            let (name, value) = line.trim_start_matches("# param.").split_once(" = ").expect("a parameter");
            let parameter = TABLE.iter().find(|parameter| parameter.name == name).expect("a known name");
            parameters.set(parameter.id, value.parse().expect("a number")).expect("in range");
        }
        Record { parameters, rows: rows.into_iter().skip(1).map(row).collect() }
    }

    /// The controller at the start of the run, with the steps that its setpoint makes.
    pub fn bench(&self) -> ControllerBench {
        let config = Config::new(&self.parameters).expect("parameters of a checked rig");
        let mut sequence = Sequence::new(self.rows.len() as u32 - 1);
        let mut last = None;
        for (k, row) in (0..).zip(&self.rows) {
            if last.replace(row.setpoint) != Some(row.setpoint) {
                sequence.push(Move::step(k, row.setpoint)).expect("room");
            }
        }
        let state: State = bench::running(&config, &sequence);
        ControllerBench { config, sequence, state }
    }
}

impl Row {
    pub fn sample(&self) -> Sample {
        let [pressure_1, pressure_2] = self.pressures;
        Sample { position: self.position, pressure_1, pressure_2, spool: self.spool, ..Sample::default() }
    }
}

fn row(line: &str) -> Row {
    let numbers: Vec<i32> = line.split(',').map(|number| number.parse().expect("a number")).collect();
    let (position, one, two, setpoint, command, spool) = match numbers[..] {
        [position, one, two, setpoint, command] => (position, one, two, setpoint, command, 0),
        [position, one, two, setpoint, command, spool] => (position, one, two, setpoint, command, spool),
        _ => panic!("five numbers, or six: {line}"),
    };
    Row {
        position,
        pressures: [one as i16, two as i16],
        spool: spool as i16,
        setpoint,
        command: command as i16,
    }
}
