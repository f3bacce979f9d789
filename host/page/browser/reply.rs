//! A request answered.

use pneudrive_page::refusal::HttpRefusal;
use pneudrive_page::rigs::{self, Opened};
use pneudrive_page::study::{Audience, Study};
use pneudrive_page::{Answer, answer};
use serde::Deserialize;
use serde_json::{Value, json};

/// The rig that a page begins with.
const FIRST: &str = "press";

/// A request of the page.
#[derive(Debug, Deserialize)]
struct Request {
    request: String,
    #[serde(default)]
    body: Value,
}

/// The answer to a request.
#[derive(Clone, Debug)]
pub struct Reply {
    /// 200, or why it is refused.
    pub status: u16,
    /// JSON, or columns of numbers.
    pub bytes: Vec<u8>,
}

/// Answers a request in JSON. Of a study, `hears` is given how far it is.
#[must_use]
pub fn reply(request: &[u8], hears: &mut (dyn FnMut(Value) + Send)) -> Reply {
    match answered(request, hears) {
        Ok(Answer::Json(value)) => Reply { status: 200, bytes: value.to_string().into_bytes() },
        Ok(Answer::Columns(bytes)) => Reply { status: 200, bytes },
        Err(refusal) => {
            Reply { status: refusal.status.as_u16(), bytes: refusal.body().to_string().into_bytes() }
        }
    }
}

fn answered(request: &[u8], hears: &mut (dyn FnMut(Value) + Send)) -> Result<Answer, HttpRefusal> {
    let Request { request, body } =
        serde_json::from_slice(request).map_err(|error| HttpRefusal::malformed(&error))?;
    match request.as_str() {
        "rigs" => Ok(Answer::Json(rigs::list(&Opened::builtin(FIRST)?))),
        "port" => Ok(Answer::Json(json!({ "port": null }))),
        // The page ends a worker that it no longer needs.
        "study" => Study::read(&body)?.work(Audience { hears, waits: &|| true }).map(Answer::Json),
        _ => answer(&request, &body, &|| true),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(request: &str, body: &Value) -> (u16, Value) {
        let request = json!({ "request": request, "body": body }).to_string();
        let reply = reply(request.as_bytes(), &mut |_| {});
        (reply.status, serde_json::from_slice(&reply.bytes).expect("JSON"))
    }

    #[test]
    fn the_page_begins_with_a_rig_and_no_port() {
        let (status, rigs) = asked("rigs", &Value::Null);
        assert_eq!((status, &rigs["opened"]["name"]), (200, &json!(FIRST)));
        assert_eq!(rigs["opened"]["text"].as_str(), pneudrive_sim::rigfile::builtin(FIRST));
        assert_eq!(asked("port", &Value::Null), (200, json!({ "port": null })));
    }

    #[test]
    fn a_rig_that_is_wrong_is_refused_at_its_key() {
        let text = pneudrive_sim::rigfile::builtin(FIRST).expect("a built-in rig");
        let (status, refusal) =
            asked("run", &json!({ "name": FIRST, "text": text, "settings": ["load.mass_kg=-1"] }));
        assert_eq!(status, 422);
        assert_eq!(refusal["problems"][0]["key"], "load.mass_kg");
    }

    #[test]
    fn what_is_no_request_is_refused() {
        for bytes in [&b""[..], b"{", b"[]", b"\xff"] {
            assert_eq!(reply(bytes, &mut |_| {}).status, 400);
        }
    }
}
