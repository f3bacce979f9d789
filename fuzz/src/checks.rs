//! What must hold of each request, whoever sends it and whenever it comes.

use pneudrive_app::{Control, Recorder};
use pneudrive_controller::{Fault, Mode, Parameters};
use pneudrive_protocol::{Reply, ReplyBody, Request, RequestBody, RequestRefusal};

/// What a refused request leaves as it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seen {
    /// Its mode.
    pub mode: Mode,
    referenced: bool,
    parameters: Parameters,
    test: pneudrive_app::control::Test,
}

impl Seen {
    /// A drive as it is.
    #[must_use]
    pub fn of(control: &Control<Recorder>) -> Seen {
        let supervisor = &control.state().supervisor;
        Seen {
            mode: supervisor.mode(),
            referenced: supervisor.is_referenced(),
            parameters: control.parameters().clone(),
            test: control.test().clone(),
        }
    }
}

/// What may come of any request.
///
/// # Panics
/// When something else has.
pub fn check(request: &Request<'_>, reply: Option<&Reply<'_>>, before: &Seen, after: &Seen, owner: u32) {
    let body = request.body;
    let starts = matches!(body, RequestBody::Start { .. } | RequestBody::Home);
    if let Some(reply) = reply {
        assert_eq!(reply.sequence, request.sequence);
    }
    let refused = matches!(reply, Some(Reply { body: ReplyBody::Refused(_), .. }));
    if reply.is_none() || (refused && !(starts && before.mode == Mode::Disarmed)) {
        assert_eq!(before, after, "{body:?}: {reply:?}");
    }
    if moves(after.mode) && !moves(before.mode) {
        assert!(starts && before.mode == Mode::Armed, "{body:?} from {:?}", before.mode);
        assert_eq!(request.session, owner, "the drive moves for its owner alone");
    }
    let changes = matches!(
        body,
        RequestBody::ConfigSet { .. } | RequestBody::ChangeTake { .. } | RequestBody::Arm { .. }
    );
    assert!(changes || before.parameters == after.parameters, "{body:?} changed parameters");
}

/// Whether the drive is enabled.
#[must_use]
pub fn drives(mode: Mode) -> bool {
    matches!(mode, Mode::Armed | Mode::Running | Mode::Done | Mode::Homing)
}

/// Whether the rod is on its way.
#[must_use]
pub fn moves(mode: Mode) -> bool {
    matches!(mode, Mode::Running | Mode::Homing)
}

/// A request that was meant for another boot than the one that is on arms, moves and changes nothing; it may stop and disarm.
/// The number of this boot, if it was refused for that.
///
/// # Panics
/// When it has done something, or was refused in its own boot.
pub fn check_boot(
    meant: u32,
    now: u32,
    reply: Option<&Reply<'_>>,
    before: &Seen,
    after: &Seen,
) -> Option<u32> {
    let refused = ReplyBody::Refused(RequestRefusal::OtherBoot { number: now });
    let is_refused = reply.is_some_and(|reply| reply.body == refused);
    let is_other = meant != now;
    assert!(is_other || !is_refused, "it was meant for this boot");
    let is_off = matches!(after.mode, Mode::Disarmed | Mode::Fault(Fault::Stop));
    let only_switched_off = Seen { mode: before.mode, ..after.clone() } == *before && is_off;
    assert!(!is_other || before == after || only_switched_off, "{before:?}, {after:?}: {reply:?}");
    is_refused.then_some(now)
}
