//! Which requests are allowed, and the headers of every answer.
//!
//! | refused | because |
//! |---|---|
//! | a `Host` that is neither an address nor `localhost` | a foreign name that resolves to this machine makes its page ours (DNS rebinding) |
//! | an `Origin` that is not this server | another page asks |
//! | a request for `/api` without the token; with a wrong one after [`PAUSE`] | the sender was not given the address |
//! | a body of more than [`MAX_BYTES`]; with a record to overlay, of more than [`MAX_BYTES_OF_RECORD`] | no rig file is that long; no page waits for a longer record |

use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;

use axum::extract::{Request, State};
use axum::http::header::{AUTHORIZATION, HOST, HeaderMap, HeaderName, HeaderValue, ORIGIN};
use axum::http::{StatusCode, Uri};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use pneudrive_page::refusal::HttpRefusal;

use crate::connections::Connection;
use crate::refusal_response::RefusalResponse;
use crate::token::Token;

/// The longest body of a request: a rig file of the longest kind in JSON, bytes.
pub const MAX_BYTES: usize = 2 << 20;

/// The longest body of a request with a record: a run folder of some 40,000 samples, bytes.
pub const MAX_BYTES_OF_RECORD: usize = 16 << 20;

/// What a browser may do with the page: load its own files and ask this server. No inline script, no inline style, no
/// frame around it.
pub(crate) const CONTENT_SECURITY_POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; \
     connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// Headers of every answer.
const HEADERS: [(&str, &str); 6] = [
    ("content-security-policy", CONTENT_SECURITY_POLICY),
    ("x-content-type-options", "nosniff"),
    ("referrer-policy", "no-referrer"),
    ("cross-origin-opener-policy", "same-origin"),
    ("cross-origin-resource-policy", "same-origin"),
    ("cache-control", "no-store"),
];

/// How long a wrong token waits for its answer, so that nobody can try many. The right token does not wait.
pub const PAUSE: Duration = Duration::from_secs(1);

/// What needs the token.
const API: &str = "/api/";

/// What the guard needs to know.
#[derive(Clone, Debug)]
pub struct Guard {
    /// Where the server listens.
    pub address: SocketAddr,
    /// The token that a request for `/api` must show.
    pub token: Token,
}

/// Lets a request through, or refuses it.
pub async fn watch(State(guard): State<Arc<Guard>>, request: Request, next: Next) -> Response {
    let mut answer = match guard.check(request.uri(), request.headers()) {
        Ok(()) => {
            note_token(&request);
            next.run(request).await
        }
        Err(refusal) => {
            if refusal.status == StatusCode::UNAUTHORIZED
                && !shown(request.headers()).unwrap_or_default().is_empty()
            {
                tokio::time::sleep(PAUSE).await;
            }
            RefusalResponse(refusal).into_response()
        }
    };
    for (name, value) in HEADERS {
        answer.headers_mut().insert(HeaderName::from_static(name), HeaderValue::from_static(value));
    }
    answer
}

fn text_of(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
    headers.get(name).map(|value| value.to_str().unwrap_or_default())
}

/// The token that a request shows.
fn shown(headers: &HeaderMap) -> Option<&str> {
    text_of(headers, AUTHORIZATION).and_then(|value| value.strip_prefix("Bearer "))
}

/// Marks a connection as one that has shown the token.
fn note_token(request: &Request) {
    let path = request.uri().path();
    if let Some(connection) = request.extensions().get::<Arc<Connection>>()
        && path.starts_with(API)
    {
        connection.shows_token(path);
    }
}

impl Guard {
    /// Whether a request may be carried out.
    ///
    /// # Errors
    /// The reason why it may not.
    pub fn check(&self, uri: &Uri, headers: &HeaderMap) -> Result<(), HttpRefusal> {
        let text = |name| text_of(headers, name);
        let host = text(HOST).filter(|host| self.is_ours(host)).ok_or_else(|| {
            let message = format!("this server is called http://{}, and by no other name", self.address);
            HttpRefusal::new(StatusCode::FORBIDDEN, message)
        })?;
        if text(ORIGIN).is_some_and(|origin| origin.strip_prefix("http://") != Some(host)) {
            return Err(HttpRefusal::new(StatusCode::FORBIDDEN, "another page may not ask this server"));
        }
        if uri.path().starts_with(API) && !shown(headers).is_some_and(|token| self.token.is(token)) {
            let message =
                "open the studio by the address that `pneudrive studio` has printed: it holds the token";
            return Err(HttpRefusal::new(StatusCode::UNAUTHORIZED, message));
        }
        Ok(())
    }

    /// Whether `host:port` is an address of this server. A name other than localhost may belong to anybody.
    fn is_ours(&self, host: &str) -> bool {
        if host == format!("localhost:{}", self.address.port()) {
            return self.address.ip().is_loopback() || self.address.ip().is_unspecified();
        }
        let Ok(named) = host.parse::<SocketAddr>() else { return false };
        let here: IpAddr = self.address.ip();
        named.port() == self.address.port() && (named.ip() == here || here.is_unspecified())
    }
}
