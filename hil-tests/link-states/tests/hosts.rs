//! What is left out of a host's inputs leaves no trace in what it does.

use pneudrive_app::Server;
use pneudrive_link_states::host::{Host, Input, Job, Plan, Waits};
use pneudrive_link_states::rig::Rig;

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
                    rig = rig.sampled().0;
                }
                inputs.push(Input::RunOver);
            }
            Waits::Nothing => return inputs,
        }
    }
}

/// How a host ends whose question is repeated at these of its inputs, told as the model tells it, and how many inputs it had.
fn ends(plan: &Plan, repeated: &[usize]) -> (Host, usize) {
    let (mut rig, mut server, mut host) = (Rig::new(None), Server::default(), Host::default());
    for at in 0.. {
        let mut standing = host.standing(plan);
        if repeated.contains(&at) && standing.waits == Waits::Answer {
            (host, standing) = host.after(Input::Silence, plan).expect("it asks again");
        }
        let mut reply = Vec::new();
        for frame in &standing.sent {
            let Ok(()) = server.receive(frame, &mut rig.control, &mut rig.board, &mut reply);
        }
        let input = match standing.waits {
            Waits::Answer => Input::Reply(reply),
            Waits::RunOver => {
                while rig.moves() {
                    rig = rig.sampled().0;
                }
                Input::RunOver
            }
            Waits::Nothing => return (host, at),
        };
        host = host.after(input, plan).expect("it goes on").0;
    }
    unreachable!("a host ends")
}

#[test]
fn a_host_that_repeats_its_questions_comes_to_the_same_end() {
    let plan = Plan::new(Job::Both, "one", 0x1001, 100, [11, 12]);
    let (end, inputs) = ends(&plan, &[]);
    assert!(end.standing(&plan).record.is_some(), "it has come to its end");
    for one in 0..inputs {
        for other in one..inputs {
            assert_eq!(ends(&plan, &[one, other]).0, end, "{one} and {other}");
        }
    }
}

/// The model tells a host by its answers: it stands as the one that has had every input does.
#[test]
fn a_host_stands_as_one_that_has_had_every_input() {
    let plan = Plan::new(Job::Both, "one", 0x1001, 100, [11, 12]);
    let inputs = conversation(&plan);
    let mut told = Host::default();
    for end in 0..inputs.len() {
        let (next, standing) = told.after(inputs[end].clone(), &plan).expect("an answer");
        assert_eq!((&standing, &next.standing(&plan)), (&host(&inputs[..=end]).standing(&plan), &standing));
        told = next;
    }
}

#[test]
fn a_reply_that_comes_again_leaves_no_trace() {
    let plan = Plan::new(Job::Both, "one", 0x1001, 100, [11, 12]);
    let inputs = conversation(&plan);
    let standings: Vec<_> = (0..=inputs.len()).map(|end| host(&inputs[..end]).standing(&plan)).collect();
    assert!(standings.last().is_some_and(|last| last.record.is_some()), "it has come to its end");
    let mut compared = 0;
    for at in 0..inputs.len() {
        let replies = inputs[..at].iter().filter(|input| matches!(input, Input::Reply(_)));
        for disturbance in replies {
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
