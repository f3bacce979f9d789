//! What an action makes of a state.

use std::sync::Arc;

use pneudrive_app::Server;
use pneudrive_protocol::{MAX_FRAME, ReplyBody, Request, RequestBody, decode_reply, decode_request, encode};

use crate::host::{Input, Standing, Waits};
use crate::intern::Id;
use crate::line::{Frame, InFlight, message};
use crate::pair::pair;
use crate::plc::Plc;
use crate::presence::{Presence, Time};
use crate::rig::{Rig, Run};
use crate::{Action, Broken, Link, State};

/// A request that comes to the rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Delivery {
    rig: Id,
    server: Id,
    host: usize,
    frame: Frame,
    /// The operation of the flash at which the power goes.
    cut: Option<u8>,
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct Delivered {
    rig: Id,
    server: Id,
    reply: Option<Id>,
    /// Whether the drive has begun to move.
    began: bool,
    broken: Option<Broken>,
    /// Whether the power went.
    cut: bool,
}

/// What a host hears.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Heard {
    /// This frame.
    Reply(Id),
    /// Nothing, for as long as it waits.
    Nothing,
    /// That its run is over.
    RunOver,
}

/// A host, by its place and its number, that hears something.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Telling {
    number: usize,
    host: Id,
    heard: Heard,
}

/// What came of that.
#[derive(Debug, Default)]
pub struct Told {
    /// None if the host passes over it.
    after: Option<Id>,
    sent: Vec<Id>,
    ended: bool,
    record: Option<Run>,
}

/// What becomes of the rig without a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Change {
    /// A sample and its output.
    Sample,
    /// A time in which nobody was heard.
    Passes(Time),
    /// A contact of the PLC changes.
    Toggle(u8),
    /// A reset.
    Reset,
}

impl Link {
    pub(crate) fn step(&self, state: &State, action: Action) -> Option<State> {
        let mut next = state.clone();
        let possible = match action {
            Action::Asked(host) => {
                let frame = next.to_rig[host].queue.remove(0);
                self.ask(&mut next, host, frame, None)
            }
            Action::AskedAndCut(host, nth) => {
                let frame = next.to_rig[host].queue.remove(0);
                next.left.power_cuts -= 1;
                self.ask(&mut next, host, frame, Some(nth))
            }
            Action::AskedLate(host, nth) => {
                let frame = next.to_rig[host].late.remove(nth);
                self.ask(&mut next, host, frame, None)
            }
            Action::Answered(host) => {
                let frame = next.to_host[host].queue.remove(0);
                self.tell(&mut next, host, Heard::Reply(frame.id()))
            }
            Action::AnsweredLate(host, nth) => {
                let frame = next.to_host[host].late.remove(nth);
                self.tell(&mut next, host, Heard::Reply(frame.id()))
            }
            Action::AsksAgain(host) => {
                let too_early = !(next.to_rig[host].is_empty() && next.to_host[host].is_empty());
                next.left.faults -= u8::from(too_early);
                self.tell(&mut next, host, Heard::Nothing)
            }
            Action::SeesEnd(host) => self.tell(&mut next, host, Heard::RunOver),
            Action::LosesRequest(host) => next.fault() && next.to_rig[host].lose_next(),
            Action::LosesReply(host) => next.fault() && next.to_host[host].lose_next(),
            Action::CopiesRequest(host) => next.fault() && next.to_rig[host].copy_next(),
            Action::CopiesReply(host) => next.fault() && next.to_host[host].copy_next(),
            Action::Sample => self.change(&mut next, Change::Sample),
            Action::Passes(time) => {
                match time {
                    Time::Half => next.left.waits -= 1,
                    Time::Silence | Time::Hold => next.left.silences -= 1,
                }
                self.change(&mut next, Change::Passes(time))
            }
            Action::Toggles(contact) => {
                next.left.inputs -= 1;
                self.change(&mut next, Change::Toggle(contact))
            }
            Action::Repeats(host) => self.repeat(&mut next, host),
            Action::Reset => {
                next.left.resets -= 1;
                self.reset(&mut next)
            }
        };
        self.forget_servers_without_host(&mut next);
        possible.then_some(next)
    }

    /// What the server of a host knows that has ended, and of which no frame is on its way any more, does not matter.
    fn forget_servers_without_host(&self, state: &mut State) {
        for host in [0, 1] {
            let InFlight { queue, late } = &state.to_rig[host];
            if queue.is_empty() && late.is_empty() && self.standing(state, host).waits == Waits::Nothing {
                state.servers[host] = self.fresh_server();
            }
        }
    }

    pub(crate) fn fresh_server(&self) -> Id {
        *self.fresh_server.get_or_init(|| self.servers.id(Server::default()))
    }

    /// How a host stands.
    pub(crate) fn standing(&self, state: &State, host: usize) -> Arc<Standing> {
        let id = state.hosts[host];
        self.standings.out((host, id), || Arc::new(self.hosts[host].value(id).standing(&self.plans[host])))
    }

    /// The numbers of frames.
    pub(crate) fn numbers(&self, frames: &[Vec<u8>]) -> Vec<Id> {
        frames.iter().map(|frame| self.frames.id(frame.clone())).collect()
    }

    /// A host experiences something. False if what it has to say has no room.
    fn tell(&self, state: &mut State, host: usize, heard: Heard) -> bool {
        let telling = Telling { number: host, host: state.hosts[host], heard };
        let told = self.tellings.out(telling, || Arc::new(self.told(telling)));
        let Told { after: Some(after), sent, ended, record } = &*told else { return true };
        state.hosts[host] = *after;
        // It has its answer, so it passes over all that is on its way, or it has ended.
        if *ended || heard != Heard::Nothing {
            self.drop_replies(state, host, *ended);
        }
        if record.as_ref().is_some_and(|record| !self.rigs.value(state.rig).runs.contains(record)) {
            state.broken = Some(Broken::OtherRecord);
        }
        state.to_rig[host].take(sent)
    }

    fn drop_replies(&self, state: &mut State, host: usize, ended: bool) {
        let InFlight { queue, late } = std::mem::take(&mut state.to_host[host]);
        for frame in queue.into_iter().chain(late).filter(|_| !ended) {
            let telling = Telling { number: host, host: state.hosts[host], heard: Heard::Reply(frame.id()) };
            let told = self.tellings.out(telling, || Arc::new(self.told(telling)));
            assert!(told.after.is_none(), "an answer to a question that is answered is passed over");
        }
    }

    fn told(&self, Telling { number, host, heard }: Telling) -> Told {
        let input = match heard {
            Heard::Reply(frame) => Input::Reply(self.frames.value(frame).to_vec()),
            Heard::Nothing => Input::Silence,
            Heard::RunOver => Input::RunOver,
        };
        let Some((after, standing)) = self.hosts[number].value(host).after(input, &self.plans[number]) else {
            return Told::default();
        };
        Told {
            after: Some(self.hosts[number].id(after)),
            sent: self.numbers(&standing.sent),
            ended: standing.waits == Waits::Nothing,
            record: standing.record,
        }
    }

    /// A request comes to the rig.
    fn ask(&self, state: &mut State, host: usize, frame: Frame, cut: Option<u8>) -> bool {
        let delivery = Delivery { rig: state.rig, server: state.servers[host], host, frame, cut };
        let delivered = self.deliveries.out(delivery, || self.deliver(&delivery));
        if cut.is_some() && !delivered.cut {
            return false;
        }
        (state.rig, state.servers[host]) = (delivered.rig, delivered.server);
        if state.left.gateway {
            state.passed[host] = Some(frame);
        }
        state.broken = delivered.broken;
        if delivered.began && state.broken.is_none() && !self.standing(state, host).means_to_command {
            state.broken = Some(Broken::MovesUnmeant);
        }
        if delivered.cut {
            return self.reset(state);
        }
        let ended = self.standing(state, host).waits == Waits::Nothing;
        ended || delivered.reply.is_none_or(|reply| state.to_host[host].take(&[reply]))
    }

    /// A gateway repeats to the rig what came through it last, and takes the answer. False if nothing has.
    fn repeat(&self, state: &mut State, host: usize) -> bool {
        let Some(frame) = state.passed[host] else { return false };
        let delivery = Delivery { rig: state.rig, server: state.servers[host], host, frame, cut: None };
        let delivered = self.deliveries.out(delivery, || self.deliver(&delivery));
        (state.rig, state.servers[host]) = (delivered.rig, delivered.server);
        state.broken = delivered.broken.or(delivered.began.then_some(Broken::MovesUnmeant));
        true
    }

    fn deliver(&self, delivery: &Delivery) -> Delivered {
        let before = self.rigs.value(delivery.rig);
        let mut rig = Rig::clone(&before);
        let mut server = Server::clone(&self.servers.value(delivery.server));
        if let Some(nth) = delivery.cut {
            rig.cut_power_at(nth);
        }
        let meant = message(&self.frames.value(delivery.frame.id()));
        let request = decode_request(&meant).expect("a request");
        let body = request.body;
        let reply = self.carry_out(&mut rig, &mut server, request);
        self.note(&mut rig, &before, delivery, request, reply.as_deref());
        self.note_presence(&mut rig, delivery, request.sequence);
        rig.forget();
        let saves = body == RequestBody::ConfigSave;
        assert!(saves || rig.board.kept == before.board.kept, "{body:?} wrote to the flash");
        let began = rig.moves() && !before.moves();
        let broken = if began { self.wrong_start(&rig, delivery) } else { None };
        Delivered {
            broken: broken.or_else(|| self.wrong_parameters(&rig)),
            cut: rig.is_powered_off(),
            began,
            reply: reply.map(|reply| self.frames.id(reply)),
            rig: self.rigs.id(rig),
            server: self.servers.id(server),
        }
    }

    /// Whether this request writes to the flash; no other one does.
    pub(crate) fn saves(&self, frame: Id) -> bool {
        let meant = message(&self.frames.value(frame));
        decode_request(&meant).is_ok_and(|request| request.body == RequestBody::ConfigSave)
    }

    /// Whether this request arms or moves the drive, so that it matters whether it was sent before a reset.
    fn arms_or_moves(&self, frame: Id) -> bool {
        let meant = message(&self.frames.value(frame));
        matches!(
            decode_request(&meant).expect("a request").body,
            RequestBody::Arm { .. }
                | RequestBody::TakeOver { .. }
                | RequestBody::Home
                | RequestBody::SeekNull
                | RequestBody::Start { .. }
        )
    }

    /// Gives the request to the firmware; its reply.
    fn carry_out(&self, rig: &mut Rig, server: &mut Server, request: Request<'_>) -> Option<Vec<u8>> {
        let request = self.mutant.map_or(request, |mutant| mutant.distort(request, rig));
        let mut room = [0; MAX_FRAME];
        let frame = encode(&request, &mut room).expect("it was sent once");
        let mut reply = Vec::new();
        let Ok(()) = server.receive(frame, &mut rig.control, &mut rig.board, &mut reply);
        Some(reply).filter(|reply| !reply.is_empty())
    }

    /// Notes what the properties are judged by.
    fn note(
        &self,
        rig: &mut Rig,
        before: &Rig,
        &Delivery { host, frame, .. }: &Delivery,
        Request { sequence, body, .. }: Request<'_>,
        reply: Option<&[u8]>,
    ) {
        let reply = reply.map(message);
        let done =
            reply.is_some_and(|reply| decode_reply(&reply).is_ok_and(|reply| reply.body == ReplyBody::Done));
        // A copy is answered as the first one was, and not carried out.
        let owns = rig.drives() && rig.control.owner(&rig.board).session == self.plans[host].session;
        match body {
            RequestBody::Arm { .. } | RequestBody::TakeOver { .. } if done && owns => {
                rig.armed_by = Some(host).filter(|_| !frame.is_from_before());
                rig.presence = Presence::of(sequence);
                rig.plc.iter_mut().for_each(Plc::is_armed_by_host);
            }
            RequestBody::Stop if done => rig.plc.iter_mut().for_each(|plc| plc.is_stopped_by(host)),
            RequestBody::ConfigSave if done && rig.board.kept != before.board.kept => {
                rig.saved = pair(rig.control.parameters());
            }
            _ => {}
        }
        if rig.moves() && !before.moves() && !rig.homes() {
            rig.note_run();
        }
    }

    /// Notes that a request of the owner has come, a new one or a copy.
    fn note_presence(&self, rig: &mut Rig, &Delivery { host, frame, .. }: &Delivery, number: u16) {
        if rig.armed_by != Some(host) {
            return;
        }
        let is_copy = number.wrapping_sub(rig.presence.newest()).cast_signed() <= 0;
        if let (true, Some(mutant)) = (is_copy, self.mutant) {
            mutant.hear(rig, self.plans[host].session);
        }
        if !frame.is_from_before() {
            rig.presence.hears(number);
        }
    }

    /// What is wrong with a move that has begun at this request.
    fn wrong_start(&self, rig: &Rig, &Delivery { host, frame, .. }: &Delivery) -> Option<Broken> {
        if rig.armed_by != Some(host) || frame.is_from_before() {
            return Some(Broken::MovesUnarmed);
        }
        if rig.homes() {
            return None;
        }
        (rig.control.test().name() != self.plans[host].test.name()).then_some(Broken::RunsOthersTest)
    }

    fn wrong_parameters(&self, rig: &Rig) -> Option<Broken> {
        let there = pair(rig.control.parameters());
        (!self.pairs().any(|pair| pair == there)).then_some(Broken::MixedConfiguration)
    }

    fn change(&self, state: &mut State, change: Change) -> bool {
        let (rig, broken) = self.changes.out((state.rig, change), || self.changed(state.rig, change));
        (state.rig, state.broken) = (rig, state.broken.or(broken));
        true
    }

    fn changed(&self, rig: Id, change: Change) -> (Id, Option<Broken>) {
        let before = self.rigs.value(rig);
        let (after, broken) = match change {
            Change::Sample => {
                let (after, wrong) = before.sampled();
                (after, wrong.map(Broken::Inputs))
            }
            Change::Passes(time) => {
                let (after, missed) = before.left_alone(time);
                (after, missed.map(Broken::Presence))
            }
            Change::Toggle(contact) => (before.toggled(contact), None),
            Change::Reset => after_reset(&before),
        };
        (self.rigs.id(after), broken)
    }

    /// The rig begins anew, and so do its servers. What is on the lines stays there.
    fn reset(&self, state: &mut State) -> bool {
        state.servers = [self.fresh_server(); 2];
        // Replies are known by the numbers of their requests, whenever they come.
        let matters = |id| self.arms_or_moves(id);
        state.to_rig.iter_mut().for_each(|frame| frame.outlives_reset(matters));
        for frame in state.passed.iter_mut().flatten().filter(|frame| matters(frame.id())) {
            *frame = frame.from_before();
        }
        self.change(state, Change::Reset)
    }
}

/// The rig after a reset, and what is wrong with the configuration that it has taken up.
fn after_reset(before: &Rig) -> (Rig, Option<Broken>) {
    let mut after = before.reset();
    let loaded = pair(after.control.parameters());
    let saving = before.is_powered_off().then(|| pair(before.control.parameters()));
    let old_or_new = loaded == before.saved || Some(loaded) == saving;
    let whole = old_or_new && !after.control.configuration().is_lost();
    after.saved = loaded;
    (after, (!whole).then_some(Broken::OtherConfiguration))
}

impl State {
    fn fault(&mut self) -> bool {
        self.left.faults -= 1;
        true
    }
}
