//! Sessions and boots: which host a request comes from, and which start of the drive it is meant for.
//!
//! A host draws a number for as long as it runs, and names it in every request. The number is at least [`FIRST`], so the varint
//! behind the sequence number has its top bit set in a request and never in a reply, where the number of the variant stands: on
//! a line that is coupled into itself, neither side takes what it has said itself for a message of the other.
//!
//! A drive gives each of its boots another number. A host asks for it when it connects
//! ([`RequestBody::Boot`](crate::RequestBody::Boot)) and names it in every request from then on. A request for another boot, such
//! as a copy that comes after a reset, is refused if it could arm, move or change anything.

/// No session: that of a drive without an owner.
pub const NOBODY: u32 = 0;

/// The smallest session of a host.
pub const FIRST: u32 = 128;

/// The owner of a drive that its digital inputs have enabled. No host has this session.
pub const INPUTS: u32 = u32::MAX;

/// The boot of a drive that cannot tell its boots apart, and of requests to it. A host also names it until it knows better.
pub const NO_BOOT: u32 = 0;

/// Bytes of the name that a host gives itself. A longer one is cut.
pub const HOST_BYTES: usize = 32;

/// Whether a host may have this session.
#[must_use]
pub(crate) fn is_of_host(session: u32) -> bool {
    (FIRST..INPUTS).contains(&session)
}
