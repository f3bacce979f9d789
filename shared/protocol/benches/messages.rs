//! A message to the wire and back: `cargo bench -p pneudrive-protocol`.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use pneudrive_protocol::MAX_FRAME;
use pneudrive_protocol::frame::Accumulator;
use pneudrive_protocol::message::{Request, RequestBody, decode_request, encode};

fn messages(criterion: &mut Criterion) {
    let body = RequestBody::Reference { position_counts: 8192 };
    let request = Request { sequence: 7, session: 0xfeed_beef, boot: 3, body };
    let mut out = [0; MAX_FRAME];
    criterion.bench_function("encode a request", |bencher| {
        bencher.iter(|| encode(black_box(&request), &mut out).expect("fits").len());
    });
    let frame = encode(&request, &mut out).expect("fits").to_vec();
    let mut accumulator: Accumulator = Accumulator::default();
    criterion.bench_function("decode a request", |bencher| {
        bencher.iter(|| {
            for &byte in black_box(&frame) {
                if let Some(message) = accumulator.push(byte) {
                    black_box(decode_request(message.expect("whole")).expect("a request"));
                }
            }
        });
    });
}

criterion_group!(benches, messages);
criterion_main!(benches);
