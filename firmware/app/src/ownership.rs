//! Ownership: the host that commands an enabled drive.
//!
//! The session that arms a drive owns it until the drive is disarmed or trips. While the owner is present, other
//! hosts may only read and stop. An owner that has left, or has been silent for longer than `host_silence_ms`, is
//! gone: any host may then disarm the drive, arm it again or take it over.
//!
//! | presence | the owner may | others may |
//! |---|---|---|
//! | [`Presence::Nobody`] | (there is none) | everything |
//! | [`Presence::There`] | everything | read, stop |
//! | [`Presence::Gone`] | come back, if it was only silent, but not to move the drive | read, stop, disarm, arm, take over |
//!
//! The digital inputs of a drive are an owner as well ([`session::INPUTS`]). A move that they have begun is theirs
//! until the drive is disabled, and they begin nothing while a host has enabled the drive.
//!
//! A request is a sign of life once. A copy from a gateway that repeats requests is none, nor is an older request.
//! The numbers of a session's requests grow and wrap. So a request counts if its number is ahead of the last one by
//! less than half of the range (RFC 1982).
//!
//! What an owner has said before it fell silent may still be on the line, and come once nobody watches the drive any
//! more. So an owner that was gone arms or takes over again before it starts or homes.

use pneudrive_protocol::{Presence, RequestBody, session};

use crate::name::cut;

/// The name of a host.
pub(crate) type HostName = heapless::String<{ session::HOST_BYTES }>;

/// A request's need of its host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// Nothing: it reads, or it stops the drive.
    Nothing,
    /// That no other host commands the drive: it ends a command, or begins one.
    NoOtherOwner,
    /// To command the drive, if anybody does.
    Command,
}

impl Need {
    /// The need of this request.
    #[must_use]
    pub fn of(body: &RequestBody<'_>) -> Need {
        use RequestBody as Body;
        match body {
            Body::Info
            | Body::Status
            | Body::ConfigGet { .. }
            | Body::Stop
            | Body::RecordInfo
            | Body::RecordRead { .. }
            | Body::Motion
            | Body::ConfigState
            | Body::Events { .. }
            | Body::Timing
            | Body::StreamBegin { .. }
            | Body::StreamGrant { .. }
            | Body::StreamRead { .. }
            | Body::Leave
            | Body::Owner
            | Body::Token { .. }
            | Body::Boot
            | Body::TestRead { .. }
            | Body::MoveRecordsRead { .. }
            | Body::Io
            | Body::IoSet { .. } => Need::Nothing,
            Body::Arm { .. } | Body::TakeOver { .. } | Body::Disarm => Need::NoOtherOwner,
            Body::ConfigSet { .. }
            | Body::Start { .. }
            | Body::Reference { .. }
            | Body::Home
            | Body::ConfigSave
            | Body::ChangePart { .. }
            | Body::ChangeTake { .. }
            | Body::SeekNull
            | Body::AtNull
            | Body::TryWatchdog => Need::Command,
        }
    }
}

/// The host that asks to own the drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Requester<'a> {
    /// Its session.
    pub session: u32,
    /// Its name.
    pub host: &'a str,
    /// The number of the request in which it asks; None for one that sends none.
    pub sequence: Option<u16>,
}

/// The session that has armed the drive last, and how long ago it was heard. By default [nobody's](session::NOBODY).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Ownership {
    session: u32,
    host: HostName,
    /// None on a board that does not judge silence.
    heard_ms: Option<u64>,
    /// The number of its last request.
    last: Option<u16>,
    left: bool,
    /// It was silent for too long, and heard again.
    lapsed: bool,
}

impl Ownership {
    /// A host that owns the drive from its present request on.
    #[must_use]
    pub fn of(by: &Requester<'_>, now_ms: Option<u64>) -> Ownership {
        let Requester { session, host, sequence } = *by;
        Ownership { session, host: cut(host), heard_ms: now_ms, last: sequence, ..Ownership::default() }
    }

    /// The request of this number of a session has come; an owner is gone after `silence_ms` of silence, 0: never.
    pub fn heard(&mut self, session: u32, sequence: u16, now_ms: Option<u64>, silence_ms: u32) {
        if session == self.session && !self.left && self.is_new(sequence) {
            self.last = Some(sequence);
            self.lapsed |= self.gone_for_ms(now_ms, silence_ms).is_some();
            self.heard_ms = now_ms;
        }
    }

    /// Whether this request number is later than all that were heard of the owner.
    fn is_new(&self, sequence: u16) -> bool {
        self.last.is_none_or(|last| sequence.wrapping_sub(last).cast_signed() > 0)
    }

    /// Whether the owner was gone since it became the owner, and so must not move the drive.
    #[must_use]
    pub fn has_lapsed(&self) -> bool {
        self.lapsed
    }

    /// The owner is heard.
    pub fn refresh(&mut self, now_ms: Option<u64>) {
        self.heard_ms = now_ms;
    }

    /// The session leaves. A message of another session changes nothing.
    pub fn leave(&mut self, session: u32) {
        self.left |= session == self.session;
    }

    /// For how long the owner has been silent, milliseconds; 0 where silence is not judged.
    #[must_use]
    pub fn silent_ms(&self, now_ms: Option<u64>) -> u64 {
        now_ms.zip(self.heard_ms).map_or(0, |(now, heard)| now.saturating_sub(heard))
    }

    /// For how long the owner has been gone, milliseconds; None while it is there. It is gone once it leaves, or after
    /// `silence_ms` of silence; 0: silence is not judged.
    #[must_use]
    pub fn gone_for_ms(&self, now_ms: Option<u64>, silence_ms: u32) -> Option<u64> {
        let (silent, limit) = (self.silent_ms(now_ms), u64::from(silence_ms));
        match self.left {
            true => Some(silent),
            false if limit > 0 && silent > limit => Some(silent - limit),
            false => None,
        }
    }

    /// Whether the owner of an enabled drive is there.
    #[must_use]
    pub fn presence(&self, now_ms: Option<u64>, silence_ms: u32) -> Presence {
        match self.gone_for_ms(now_ms, silence_ms) {
            None => Presence::There,
            Some(_) => Presence::Gone,
        }
    }

    /// Whether a session may make a request with this need, with the owner present or not.
    #[must_use]
    pub fn allows(&self, session: u32, need: Need, presence: Presence) -> bool {
        let owns = session == self.session && presence == Presence::There;
        match need {
            Need::Nothing => true,
            Need::NoOtherOwner => owns || presence != Presence::There,
            Need::Command => owns || presence == Presence::Nobody,
        }
    }

    /// Whether the digital inputs have enabled the drive.
    #[must_use]
    pub fn is_of_inputs(&self) -> bool {
        self.session == session::INPUTS
    }

    /// The owner's session.
    #[must_use]
    pub fn session(&self) -> u32 {
        self.session
    }

    /// The owner's name.
    #[must_use]
    pub fn host(&self) -> &str {
        self.host.as_str()
    }
}
