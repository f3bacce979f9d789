//! The controller alone, as in a control loop of one's own: a sample of the sensors in, the demand on the valve out.
//! Run it: cargo run -p pneudrive-controller --example step_controller

use pneudrive_controller::parameters::id;
use pneudrive_controller::{Config, Move, Parameters, Sample, Sequence, State, output, sample};

fn main() {
    let mut parameters = Parameters::default();
    parameters.set(id::VELOCITY_GAIN, 1000).expect("in its range");
    let config = Config::new(&parameters).expect("they go together");
    let mut sequence = Sequence::new(2000);
    sequence.push(Move::step(0, 1000)).expect("room for a move");

    let mut state = State::default();
    state.reference(0);
    state.arm(&config).expect("no run is on");
    state.start(&config, &sequence).expect("armed and referenced");
    for position in [0, 0, 4, 20, 60, 140, 270, 450] {
        let input = Sample { position, pressure_1: 2400, pressure_2: 1900, ..Sample::default() };
        sample(&config, &sequence, &mut state, &input);
        let (demand, seen) = (output(&config, &mut state).counts, state.observation());
        println!("error {:4} counts, velocity {:3}: demand {demand:5} counts", seen.error, seen.velocity);
    }
}
