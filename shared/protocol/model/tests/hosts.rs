//! What is left out of a host's inputs leaves no trace in what it does.

use pneudrive_app::Server;
use pneudrive_protocol_model::host::{Host, Input, Job, Plan, Waits};
use pneudrive_protocol_model::rig::Rig;

fn host(inputs: &[Input]) -> Host {
    inputs.iter().fold(Host::default(), |host, input| host.with(input.clone()))
}

/// The inputs of a host that nobody disturbs, up to its end.
fn conversation(plan: &Plan) -> Vec<Input> {
    let (mut rig, mut server, mut inputs) = (Rig::new(None), Server::default(), Vec::new());
    loop {
        let standing = host(&inputs).standing(plan);
        let mut reply = Vec::new();
        for frame in standing.sent {
            let Ok(()) = server.receive(&frame, &mut rig.control, &mut rig.board, &mut reply);
        }
        match standing.waits {
            Waits::Answer => inputs.push(Input::Reply(reply)),
            Waits::RunOver => {
                while rig.moves() {
                    rig = rig.sampled();
                }
                inputs.push(Input::RunOver);
            }
            Waits::Nothing => return inputs,
        }
    }
}

#[test]
fn a_reply_that_comes_again_and_a_question_that_is_repeated_leave_no_trace() {
    let plan = Plan::new(Job::Both, "one", 0x1001, 100, [11, 12]);
    let inputs = conversation(&plan);
    let standings: Vec<_> = (0..=inputs.len()).map(|end| host(&inputs[..end]).standing(&plan)).collect();
    assert!(standings.last().is_some_and(|last| last.record.is_some()), "it has come to its end");
    let mut compared = 0;
    for at in 0..inputs.len() {
        let replies = inputs[..at].iter().filter(|input| matches!(input, Input::Reply(_)));
        for disturbance in replies.chain([&Input::Silence]) {
            let disturbed: Vec<Input> =
                inputs[..at].iter().chain([disturbance]).chain(&inputs[at..]).cloned().collect();
            for end in at + 1..=inputs.len() {
                assert_eq!(
                    host(&disturbed[..=end]).standing(&plan),
                    standings[end],
                    "{disturbance:?} at {at}"
                );
                compared += 1;
            }
        }
    }
    assert!(compared > 300, "{compared}");
}
