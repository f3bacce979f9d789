//! Answers that refuse, or do not fit.

use anyhow::anyhow;
use pneudrive_protocol::{Refused, ReplyBody};
use pneudrive_records::untrusted::{SENTENCE, sanitised};
use pneudrive_records::words;

use crate::failure::Failure;

/// What is wrong with an answer to another request than the one that was sent.
pub(super) fn unexpected(reply: &ReplyBody<'_>) -> anyhow::Error {
    let reply = sanitised(&format!("{reply:?}"), SENTENCE);
    anyhow!("the rig gave an answer that does not fit the request: {reply}")
}

/// A rig's refusal, as this program ends with it.
pub(super) fn refusal(rig: &str, refused: &Refused<'_>) -> anyhow::Error {
    Failure::Refused.error(format!("{rig}: {}", words::refusal(refused)))
}
