//! The two calls of a sample on this machine: `cargo bench -p pneudrive-controller`. What they cost on a Cortex-M4
//! is in docs/reference/firmware-figures.md.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use pneudrive_controller::{Config, Move, Parameters, Sample, Sequence, State, output, sample};

fn step(criterion: &mut Criterion) {
    let config = Config::new(&Parameters::default()).expect("consistent defaults");
    let mut sequence = Sequence::new(u32::MAX);
    sequence.push(Move::step(0, 8192)).expect("room for a move");
    let mut state = State::default();
    state.supervisor.set_referenced();
    state.supervisor.arm().expect("a new drive does not run");
    state.start(&config, &sequence).expect("moves that may be run");
    let mut steps = 0;
    criterion.bench_function("controller step", |bencher| {
        bencher.iter(|| {
            steps = (steps + 1) % 200;
            let position = 8000 + i32::min(steps, 200 - steps);
            sample(&config, &sequence, &mut state, black_box(&Sample { position, ..Sample::default() }));
            black_box(output(&config, &mut state))
        });
    });
}

criterion_group!(benches, step);
criterion_main!(benches);
