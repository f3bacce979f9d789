//! Answers that do not fit.

use anyhow::anyhow;
use pneudrive_protocol::ReplyBody;

use crate::foreign::{SENTENCE, cleaned};

/// What is wrong with an answer to another request than the one that was sent.
pub(super) fn unexpected(reply: &ReplyBody<'_>) -> anyhow::Error {
    let reply = cleaned(&format!("{reply:?}"), SENTENCE);
    anyhow!("the rig gave an answer that does not fit the request: {reply}")
}
