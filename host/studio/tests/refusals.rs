//! Whom the studio refuses.

use axum::http::{Method, StatusCode};
use pneudrive_studio::guard::{MAX_BYTES, MAX_BYTES_OF_RECORD};
use pneudrive_studio::token::Token;
use pneudrive_studio::{Opened, Options, Studio};

use crate::visitor::{TOKEN, ask, ask_as_page, studio};

/// Every route behind the token.
const ROUTES: [(&str, &str); 17] = [
    ("GET", "/api/keys"),
    ("GET", "/api/rigs"),
    ("GET", "/api/rigs/servo-a"),
    ("POST", "/api/check"),
    ("POST", "/api/run"),
    ("POST", "/api/ensemble"),
    ("POST", "/api/save"),
    ("POST", "/api/compare"),
    ("POST", "/api/spectrum"),
    ("POST", "/api/difference"),
    ("POST", "/api/plan"),
    ("GET", "/api/choices"),
    ("POST", "/api/study"),
    ("GET", "/api/port"),
    ("POST", "/api/drive"),
    ("POST", "/api/order"),
    ("POST", "/api/ask"),
];

fn get(studio: &Studio, path: &str, headers: &[(&str, &str)]) -> StatusCode {
    ask(studio, Method::GET, path, headers, Vec::new()).status
}

/// A page of a foreign name that resolves to this machine is no page of ours.
#[test]
fn a_request_to_a_foreign_host_is_refused() {
    let studio = studio();
    let port = studio.local_address().port();
    let bearer = format!("Bearer {TOKEN}");
    let to = |host: &str| get(&studio, "/api/keys", &[("host", host), ("authorization", &bearer)]);
    for host in [format!("127.0.0.1:{port}"), format!("localhost:{port}")] {
        assert_eq!(to(&host), StatusCode::OK, "{host}");
    }
    let others = ["", "localhost", "127.0.0.1", "localhost:1", "example.org"].map(str::to_owned);
    let others = others.into_iter().chain(
        ["example.org", "localhost.example.org", "127.0.0.1.example.org", "10.0.0.7"]
            .map(|name| format!("{name}:{port}")),
    );
    for host in others {
        assert_eq!(to(&host), StatusCode::FORBIDDEN, "{host:?}");
    }
    assert_eq!(get(&studio, "/", &[]), StatusCode::FORBIDDEN, "no host");
}

#[test]
fn a_request_of_another_page_is_refused() {
    let studio = studio();
    let host = studio.local_address().to_string();
    let bearer = format!("Bearer {TOKEN}");
    let from = |origin: &str| {
        get(&studio, "/api/keys", &[("host", &host), ("origin", origin), ("authorization", &bearer)])
    };
    assert_eq!(from(&format!("http://{host}")), StatusCode::OK);
    let port = studio.local_address().port();
    for origin in [
        "null",
        "http://example.org",
        "http://127.0.0.1",
        &format!("http://localhost:{port}"),
        &format!("https://{host}"),
    ] {
        assert_eq!(from(origin), StatusCode::FORBIDDEN, "{origin}");
    }
}

#[test]
fn nothing_is_told_and_nothing_done_without_the_token() {
    let studio = studio();
    // A wrong token waits for its answer.
    std::thread::scope(|scope| {
        for (method, path) in ROUTES {
            let studio = &studio;
            scope.spawn(move || is_refused_without_the_token(studio, method, path));
        }
    });
}

fn is_refused_without_the_token(studio: &Studio, method: &str, path: &str) {
    let host = studio.local_address().to_string();
    let shorter = &TOKEN[..TOKEN.len() - 1];
    let method: Method = method.parse().expect("a method");
    for shown in ["", "Bearer", "Bearer ", &format!("Bearer {shorter}"), &format!("Basic {TOKEN}"), TOKEN] {
        let headers =
            [("host", host.as_str()), ("authorization", shown), ("content-type", "application/json")];
        let answer = ask(studio, method.clone(), path, &headers, b"{}".to_vec());
        assert_eq!(answer.status, StatusCode::UNAUTHORIZED, "{method} {path} with {shown:?}");
    }
    let answer = ask(studio, method.clone(), path, &[("host", &host)], b"{}".to_vec());
    assert_eq!(answer.status, StatusCode::UNAUTHORIZED, "{method} {path}");
    assert!(answer.json()["error"].as_str().is_some_and(|why| why.contains("pneudrive studio")));
}

/// A form of another page can send no JSON.
#[test]
fn a_body_that_is_not_json_is_refused() {
    let studio = studio();
    let host = studio.local_address().to_string();
    let bearer = format!("Bearer {TOKEN}");
    let headers = [("host", host.as_str()), ("authorization", &bearer), ("content-type", "text/plain")];
    let answer = ask(&studio, Method::POST, "/api/check", &headers, b"{}".to_vec());
    assert_eq!(answer.status, StatusCode::UNSUPPORTED_MEDIA_TYPE);
    let headers = [("host", host.as_str()), ("authorization", &bearer), ("content-type", "application/json")];
    let answer = ask(&studio, Method::POST, "/api/check", &headers, b"{".to_vec());
    assert_eq!(answer.status, StatusCode::BAD_REQUEST);
    let why = answer.json()["error"].as_str().expect("a reason").to_owned();
    assert!(why.starts_with("the request cannot be read"), "{why}");
}

#[test]
fn a_body_longer_than_any_rig_file_is_refused() {
    let studio = studio();
    for path in ["/api/check", "/api/run", "/api/ensemble", "/api/save", "/api/plan", "/api/study"] {
        let body = serde_json::json!({ "name": "long", "text": "#".repeat(MAX_BYTES), "settings": [] });
        let answer = ask_as_page(&studio, Method::POST, path, Some(body));
        assert_eq!(answer.status, StatusCode::PAYLOAD_TOO_LARGE, "{path}");
    }
}

/// A run folder is longer than a rig file.
#[test]
fn a_body_with_a_record_may_be_longer_and_is_bounded_as_well() {
    let studio = studio();
    for path in ["/api/compare", "/api/spectrum"] {
        let status = |length: usize| {
            let record =
                serde_json::json!({ "name": "long", "run_json": "{}", "trace_csv": "#".repeat(length) });
            let body = serde_json::json!({ "name": "a rig", "text": "", "record": record });
            ask_as_page(&studio, Method::POST, path, Some(body)).status
        };
        assert_eq!(status(MAX_BYTES), StatusCode::UNPROCESSABLE_ENTITY, "{path}: it is read");
        assert_eq!(status(MAX_BYTES_OF_RECORD), StatusCode::PAYLOAD_TOO_LARGE, "{path}");
    }
}

#[test]
fn a_method_that_a_route_does_not_have_is_refused() {
    let studio = studio();
    for (method, path) in [(Method::POST, "/api/keys"), (Method::GET, "/api/save"), (Method::DELETE, "/")] {
        assert_eq!(ask_as_page(&studio, method, path, None).status, StatusCode::METHOD_NOT_ALLOWED, "{path}");
    }
}

#[test]
fn every_answer_forbids_inline_scripts_frames_and_other_servers() {
    let studio = studio();
    let host = studio.local_address().to_string();
    for (path, status) in [("/", 200), ("/studio.js", 200), ("/none.js", 404), ("/api/keys", 401)] {
        let answer = ask(&studio, Method::GET, path, &[("host", &host)], Vec::new());
        assert_eq!(answer.status.as_u16(), status, "{path}");
        let policy = answer.headers["content-security-policy"].to_str().expect("a text").to_owned();
        for part in
            ["default-src 'none'", "script-src 'self';", "frame-ancestors 'none'", "connect-src 'self';"]
        {
            assert!(policy.contains(part), "{path}: {policy}");
        }
        assert!(!policy.contains("unsafe"), "{policy}");
        assert_eq!(answer.headers["x-content-type-options"], "nosniff");
        assert_eq!(answer.headers["referrer-policy"], "no-referrer");
    }
}

#[test]
fn an_address_that_the_network_reaches_needs_a_token() {
    let opened = || Opened { name: "servo-b".to_owned(), text: String::new() };
    let open = |listen: &str, token| {
        Studio::open(Options { listen: listen.to_owned(), token, opened: opened(), port: None })
    };
    let error = open("0.0.0.0:0", None).expect_err("no token").to_string();
    assert!(error.contains("PNEUDRIVE_TOKEN") && error.contains("127.0.0.1"), "{error}");
    assert!(open("0.0.0.0:0", Some(Token::new(TOKEN).expect("a token"))).is_ok());
    let drawn = open("127.0.0.1:0", None).expect("loopback");
    let address = drawn.address();
    let (_, token) = address.split_once("/#token=").expect("a token behind the address");
    assert_eq!(token.len(), 32, "{address}");
    assert!(open("127.0.0.1", None).expect_err("no port").to_string().contains("HOST:PORT"));
}
