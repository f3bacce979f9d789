//! The stream of a run: which rows go out, and which can be had again.

use pneudrive_app::stream::Stream;
use pneudrive_controller::Observation;
use pneudrive_protocol::{MAX_ROWS, ReplyBody, StreamedSample};

const ROOM: usize = MAX_ROWS * StreamedSample::BYTES;

fn observe(stream: &mut Stream, indices: impl IntoIterator<Item = u32>) {
    for index in indices {
        let seen = Observation { running: true, index, position: 3 * index as i32, ..Observation::default() };
        stream.observe(&seen);
        // Nobody waits for the next sample.
        stream.observe(&seen);
    }
}

fn ends(stream: &mut Stream) {
    stream.observe(&Observation::default());
}

/// Number of the first row, and the indices of the rows.
fn told(body: &ReplyBody<'_>) -> (u32, Vec<u32>) {
    match body {
        ReplyBody::Rows { first, rows } => {
            (*first, StreamedSample::read(rows).expect("whole rows").map(|row| row.index).collect())
        }
        other => panic!("{other:?}"),
    }
}

fn due(stream: &mut Stream) -> Option<(u32, Vec<u32>)> {
    stream.due(&mut [0; ROOM]).map(|(name, body)| {
        assert_eq!(name, 7);
        told(&body)
    })
}

fn begun(every: u16, batch: u8) -> Stream {
    let mut stream = Stream::default();
    stream.begin(7, every, batch);
    stream
}

#[test]
fn every_nth_sample_of_a_run_goes_out_in_batches_and_the_rest_at_its_end() {
    let mut stream = begun(5, 2);
    stream.grant(100);
    observe(&mut stream, 0..=9);
    assert_eq!(due(&mut stream), Some((0, vec![0, 5])));
    observe(&mut stream, 10..=11);
    assert_eq!(due(&mut stream), None, "half a batch");
    ends(&mut stream);
    assert_eq!(due(&mut stream), Some((2, vec![10])));
    assert_eq!(due(&mut stream), None);
}

#[test]
fn nothing_goes_that_was_not_granted_and_what_is_overwritten_meanwhile_is_lost_by_number() {
    let mut stream = begun(1, 24);
    observe(&mut stream, 0..300);
    assert_eq!(due(&mut stream), None);
    stream.grant(68);
    assert_eq!(due(&mut stream), Some((44, (44..68).collect())), "rows 0 to 43 are overwritten");
    assert_eq!(due(&mut stream), None);
    stream.grant(78);
    stream.grant(20);
    ends(&mut stream);
    assert_eq!(due(&mut stream), Some((68, (68..78).collect())), "a grant is never taken back");
}

#[test]
fn rows_come_again_as_long_as_they_are_held() {
    let mut stream = begun(1, 1);
    observe(&mut stream, 0..300);
    let again = |first, count| told(&stream.read(first, count, &mut [0; ROOM]));
    assert_eq!(again(298, 9), (298, vec![298, 299]));
    assert_eq!(again(40, 6), (44, vec![44, 45]), "the first four are gone");
    assert_eq!(again(3, 6), (44, vec![]), "all are gone");
    assert_eq!(again(400, 6), (300, vec![]), "not yet there");
    assert_eq!(again(u32::MAX, 255), (300, vec![]));
    assert_eq!(again(100, 255).1.len(), MAX_ROWS);
}

#[test]
fn a_stream_that_has_not_begun_gathers_nothing() {
    let mut stream = Stream::default();
    stream.grant(9);
    observe(&mut stream, 0..9);
    ends(&mut stream);
    assert_eq!(stream.due(&mut [0; ROOM]), None);
}
