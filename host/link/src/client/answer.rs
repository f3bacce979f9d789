//! Answers that refuse a request, or do not match it.

use anyhow::anyhow;
use pneudrive_protocol::{ReplyBody, RequestRefusal};
use pneudrive_records::untrusted::{SENTENCE, sanitised};
use pneudrive_records::words;

use crate::failure::Failure;

/// The error for an answer that belongs to another kind of request.
pub(super) fn unexpected(reply: &ReplyBody<'_>) -> anyhow::Error {
    let reply = sanitised(&format!("{reply:?}"), SENTENCE);
    anyhow!("the rig gave an answer that does not match the request: {reply}")
}

/// The error for a rig's refusal.
pub(super) fn refusal(rig: &str, refused: &RequestRefusal<'_>) -> anyhow::Error {
    Failure::Refused.error(format!("{rig}: {}", words::refusal(refused)))
}
