//! Every state of two hosts, a rig and the lines between them.
//!
//! The checker of [stateright] visits all states that the following reach, in any order: two hosts that each state
//! parameters and a test, save, arm, start or home, disarm and pull the record; frames that are lost, or of which a copy comes
//! at any later time; hosts that ask again too early; a host that is not heard for longer than `host_silence_ms`; a reset
//! of the rig; a power cut at any operation of the flash; a gateway that repeats what came last ([`presence`] has what must
//! become of a drive whose owner says nothing new); a PLC at the digital inputs ([`plc`]). In each state the [`Broken`] properties must hold.
//!
//! What runs is the real code: `Server`, `Control`, recorder and stored configuration of the firmware ([`rig`]), and the
//! program's own `Client` ([`host`]). Each host has a `Server` of its own, as at a network. A state holds all of them
//! whole, compared by their own equality ([`intern`] gives equal ones a number), so nothing is left out of it but what
//! [`host`] says. A sample comes only where it changes something: while the drive moves, and after a silence.
//!
//! [`mutant`] plants defects; `tests/mutants.rs` shows that the checker finds each.

pub mod board;
mod broken;
mod distortion;
pub mod flash;
pub mod host;
pub mod intern;
pub mod line;
pub mod mutant;
pub mod pair;
pub mod plc;
pub mod presence;
pub mod rig;
mod step;
mod story;

use std::sync::{Arc, OnceLock};
use std::time::Instant;

use arrayvec::ArrayVec;
use pneudrive_app::Server;
use pneudrive_controller::Parameters;
use stateright::{Checker, Expectation, Model, Property};

pub use broken::Broken;
use host::{Host, Job, Plan, Standing, Waits};
use intern::{Id, Interned, Worked};
use line::{Frame, InFlight};
use mutant::Mutant;
use pair::Pair;
use presence::Time;
use rig::{Rig, Run};
use step::{Change, Delivered, Delivery, Telling, Told};

/// How often each disturbance may happen; each comes at any time, or not at all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Budget {
    /// Frames that are lost, or copied, and questions that are repeated before their time, together.
    pub faults: u8,
    /// Resets of the rig.
    pub resets: u8,
    /// Power cuts in the middle of an operation of the flash.
    pub power_cuts: u8,
    /// Silences of both hosts that are longer than `host_silence_ms`, or so long that a drive holds no longer for them.
    pub silences: u8,
    /// Silences of half that time.
    pub waits: u8,
    /// Changes of the contacts of a PLC at the digital inputs; 0: there is none.
    pub inputs: u8,
    /// Whether a gateway repeats the last frame of a host that has come to the rig, as often as it likes.
    pub gateway: bool,
}

/// What must be possible; otherwise the properties could hold because nothing happens.
pub const REACHED: &str = "both hosts do their job";

/// What must be possible with a PLC that changes its contacts often enough.
pub const BEGUN_ANEW: &str = "the inputs begin a record after a host's stop";

/// All there is to check.
#[derive(Debug, Default)]
pub struct Link {
    plans: ArrayVec<Plan, 2>,
    budget: Option<Budget>,
    mutant: Option<Mutant>,
    cuts: Vec<u8>,
    rigs: Interned<Rig>,
    servers: Interned<Server>,
    fresh_server: OnceLock<Id>,
    hosts: [Interned<Host>; 2],
    frames: Interned<Vec<u8>>,
    standings: Worked<(usize, Id), Arc<Standing>>,
    tellings: Worked<Telling, Arc<Told>>,
    deliveries: Worked<Delivery, Delivered>,
    changes: Worked<(Id, Change), (Id, Option<Broken>)>,
}

/// A state. Numbers stand for what [`Link`] knows under them.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct State {
    rig: Id,
    servers: [Id; 2],
    hosts: [Id; 2],
    to_rig: [InFlight; 2],
    to_host: [InFlight; 2],
    /// The last frames that went through a gateway.
    passed: [Option<Frame>; 2],
    left: Budget,
    broken: Option<Broken>,
}

/// What happens next. The first number is that of the host.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Action {
    /// The next request comes to the rig.
    Asked(usize),
    /// The same, and the power goes at this operation of the flash.
    AskedAndCut(usize, u8),
    /// A copy of a request comes.
    AskedLate(usize, usize),
    /// The next reply comes to the host.
    Answered(usize),
    /// A copy of a reply comes.
    AnsweredLate(usize, usize),
    /// The next request is lost.
    LosesRequest(usize),
    /// The next reply is lost.
    LosesReply(usize),
    /// A copy of the next request will come late.
    CopiesRequest(usize),
    /// A copy of the next reply will come late.
    CopiesReply(usize),
    /// The host asks again.
    AsksAgain(usize),
    /// The host sees that its run is over.
    SeesEnd(usize),
    /// A sample.
    Sample,
    /// Nobody is heard for this time.
    Passes(Time),
    /// A contact of the PLC changes.
    Toggles(u8),
    /// A gateway repeats the last frame of the host.
    Repeats(usize),
    /// The rig is reset.
    Reset,
}

impl Link {
    /// Two hosts with these plans.
    #[must_use]
    pub fn new(plans: [Plan; 2], budget: Budget) -> Link {
        Link { plans: plans.into(), budget: Some(budget), ..Link::default() }
    }

    /// The same with a planted defect.
    #[must_use]
    pub fn with(self, mutant: Mutant) -> Link {
        let mut link = Link { mutant: Some(mutant), ..self };
        link.plans.iter_mut().for_each(|plan| plan.trusts_pieces = mutant == Mutant::IgnoresNameOfRecord);
        link
    }

    /// The power may go at these operations of a save, 0 being its first.
    #[must_use]
    pub fn cut_at(self, operations: impl IntoIterator<Item = u8>) -> Link {
        Link { cuts: operations.into_iter().collect(), ..self }
    }

    /// The pairs of parameters that there may be: as by default, and as each host sets them.
    fn pairs(&self) -> impl Iterator<Item = Pair> + '_ {
        std::iter::once(pair::pair(&Parameters::default())).chain(self.plans.iter().map(|plan| plan.pair))
    }

    /// Visits all states. What came of it in a line, and the shortest path to each property that does not hold, in words.
    ///
    /// # Errors
    /// When a property does not hold, or nothing was done: the paths there.
    pub fn visit(self, threads: usize) -> Result<String, String> {
        let begun = Instant::now();
        told(&self.checker().threads(threads).spawn_bfs().join(), begun)
    }

    /// The same, each path to its end before the next one: a tenth of the memory, and the paths that are told are not the
    /// shortest.
    ///
    /// # Errors
    /// As for [`Link::visit`].
    pub fn visit_deep(self, threads: usize) -> Result<String, String> {
        let begun = Instant::now();
        told(&self.checker().threads(threads).spawn_dfs().join(), begun)
    }

    /// What must be possible.
    fn wanted(&self) -> impl Iterator<Item = &'static str> {
        let properties = self.properties().into_iter();
        properties.filter(|it| matches!(it.expectation, Expectation::Sometimes)).map(|it| it.name)
    }

    /// How many different rigs, servers and hosts were met.
    #[must_use]
    pub fn parts(&self) -> [usize; 3] {
        [self.rigs.len(), self.servers.len(), self.hosts.iter().map(Interned::len).sum()]
    }
}

/// What came of a visit.
fn told(checker: &impl Checker<Link>, begun: Instant) -> Result<String, String> {
    let figures = format!(
        "{} states, {} steps between them, at most {} from the first one, {:.1} s; {:?} rigs, servers and hosts",
        checker.unique_state_count(),
        checker.state_count(),
        checker.max_depth(),
        begun.elapsed().as_secs_f64(),
        checker.model().parts(),
    );
    let mut found = checker.discoveries();
    let never: Vec<&str> = checker.model().wanted().filter(|name| found.remove(name).is_none()).collect();
    let stories =
        found.into_iter().map(|(name, path)| format!("not so: {name}\n{}", checker.model().story(path)));
    let stories: Vec<String> = stories.collect();
    match (never.is_empty(), stories.is_empty()) {
        (true, true) => Ok(figures),
        (false, true) => Err(format!("never: {never:?}; {figures}")),
        (_, false) => Err(stories.join("\n")),
    }
}

impl Model for Link {
    type State = State;
    type Action = Action;

    fn init_states(&self) -> Vec<State> {
        let has_plc = self.budget.is_some_and(|budget| budget.inputs > 0);
        let rig = self.rigs.id(if has_plc { Rig::with_plc(self.mutant) } else { Rig::new(self.mutant) });
        let server = self.fresh_server();
        let mut state = State {
            rig,
            servers: [server; 2],
            hosts: [0, 1].map(|host| self.hosts[host].id(Host::default())),
            to_rig: Default::default(),
            to_host: Default::default(),
            passed: [None; 2],
            left: self.budget.expect("a model is made with a budget"),
            broken: None,
        };
        for host in [0, 1] {
            let standing = self.standing(&state, host);
            let taken = state.to_rig[host].take(&self.numbers(&standing.sent));
            assert!(taken, "the first request has room");
        }
        vec![state]
    }

    fn actions(&self, state: &State, actions: &mut Vec<Action>) {
        if state.broken.is_some() {
            return;
        }
        for host in [0, 1] {
            self.actions_of(state, host, actions);
        }
        self.actions_of_rig(state, actions);
    }

    fn next_state(&self, state: &State, action: Action) -> Option<State> {
        self.step(state, action)
    }

    fn properties(&self) -> Vec<Property<Link>> {
        let mut properties: Vec<Property<Link>> = broken::properties().collect();
        properties.push(Property::sometimes(REACHED, Link::both_have_done_their_job));
        let stops = self.plans.iter().any(|plan| plan.job == Job::Stops);
        if stops && self.budget.is_some_and(|budget| budget.inputs >= plc::TO_BEGIN_ANEW) {
            properties.push(Property::sometimes(BEGUN_ANEW, Link::inputs_move_after_a_stop));
        }
        properties
    }
}

impl Link {
    fn actions_of_rig(&self, state: &State, actions: &mut Vec<Action>) {
        let (rig, left) = (self.rigs.value(state.rig), state.left);
        actions.extend(rig.samples_matter().then_some(Action::Sample));
        // The inputs are heard at every sample.
        if rig.drives() && !rig.inputs_own() {
            actions.extend((left.waits > 0).then_some(Action::Passes(Time::Half)));
            if left.silences > 0 {
                actions.push(Action::Passes(Time::Silence));
                actions.extend((!rig.moves()).then_some(Action::Passes(Time::Hold)));
            }
        }
        if left.inputs > 0 {
            actions.extend(plc::CONTACTS.map(Action::Toggles));
        }
        if left.gateway {
            actions.extend([0, 1].map(Action::Repeats));
        }
        actions.extend((left.resets > 0).then_some(Action::Reset));
    }

    /// The inputs have begun a record that moves, since a host has stopped the drive.
    fn inputs_move_after_a_stop(&self, state: &State) -> bool {
        let rig = self.rigs.value(state.rig);
        rig.moves() && rig.inputs_own() && rig.plc.as_ref().is_some_and(|plc| plc.stopped)
    }

    fn actions_of(&self, state: &State, host: usize, actions: &mut Vec<Action>) {
        let (to_rig, to_host) = (&state.to_rig[host], &state.to_host[host]);
        if !to_rig.is_empty() {
            actions.push(Action::Asked(host));
            if state.left.power_cuts > 0 && self.saves(to_rig.queue[0].id()) {
                actions.extend(self.cuts.iter().map(|&nth| Action::AskedAndCut(host, nth)));
            }
        }
        actions.extend((0..to_rig.late.len()).map(|nth| Action::AskedLate(host, nth)));
        actions.extend((0..to_host.late.len()).map(|nth| Action::AnsweredLate(host, nth)));
        actions.extend((!to_host.is_empty()).then_some(Action::Answered(host)));
        if state.left.faults > 0 {
            if !to_rig.is_empty() {
                actions.extend([Action::LosesRequest(host), Action::CopiesRequest(host)]);
            }
            if !to_host.is_empty() {
                actions.extend([Action::LosesReply(host), Action::CopiesReply(host)]);
            }
        }
        let nothing_on_its_way = to_rig.is_empty() && to_host.is_empty();
        match self.standing(state, host).waits {
            Waits::Answer if nothing_on_its_way || state.left.faults > 0 => {
                actions.push(Action::AsksAgain(host))
            }
            Waits::RunOver if !self.rigs.value(state.rig).moves() => actions.push(Action::SeesEnd(host)),
            _ => {}
        }
    }

    /// Both hosts have ended; each that was to run its test has the record of it, each that was to home has homed.
    fn both_have_done_their_job(&self, state: &State) -> bool {
        let has_done = |host: usize| {
            let (plan, standing) = (&self.plans[host], self.standing(state, host));
            let own = |run: &Run| run.test == plan.test.name() && run.samples.len() == 3;
            let has_done = match plan.job {
                Job::Configures | Job::Stops | Job::Follows | Job::Holds | Job::Rests => true,
                Job::Runs | Job::Both => standing.record.as_ref().is_some_and(own),
                Job::Homes => standing.homed,
            };
            standing.waits == Waits::Nothing && has_done
        };
        (0..2).all(has_done)
    }
}
