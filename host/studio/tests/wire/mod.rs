//! A page that asks a studio over its socket, and reads as long as it likes.

use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::time::Duration;

use serde_json::Value;

use crate::visitor::TOKEN;

/// Sends a request; the stream goes on with the answer.
pub fn asked(host: &str, path: &str, body: &Value) -> BufReader<TcpStream> {
    let mut stream = TcpStream::connect(host).expect("it listens");
    stream.set_read_timeout(Some(Duration::from_secs(60))).expect("a socket");
    let body = body.to_string();
    write!(
        stream,
        "POST {path} HTTP/1.1\r\nHost: {host}\r\nAuthorization: Bearer {TOKEN}\r\nContent-Type: application/json\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{body}",
        body.len()
    )
    .expect("sent");
    BufReader::new(stream)
}

/// The status line of the answer.
pub fn status(page: &mut BufReader<TcpStream>) -> String {
    let mut line = String::new();
    page.read_line(&mut line).expect("a status");
    line
}
