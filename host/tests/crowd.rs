//! Connections that show no token, and wrong ones, keep neither the owner of a drive nor a stop out: programs of their own, with
//! no more descriptors than a system may give them.
#![cfg(unix)]

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use pneudrive_link::client::Client;
use pneudrive_protocol::{MAX_FRAME, Mode, Request, RequestBody, encode};
use serde_json::{Value, json};

use crate::program::unhurried_rig;

const SECRET: &str = "correct-horse-battery-staple";

/// More than the program has descriptors for.
const CROWD: usize = 300;

/// How long who has the token may wait for an answer.
const SOON: Duration = Duration::from_secs(5);

/// A program with 256 descriptors, and the first line that it prints.
struct Narrow(Child, String);

impl Drop for Narrow {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Narrow {
    fn start(arguments: &str) -> Narrow {
        let program = format!("ulimit -n 256; exec {} {arguments}", env!("CARGO_BIN_EXE_pneudrive"));
        let mut child = Command::new("sh")
            .args(["-c", &program])
            .env("PNEUDRIVE_TOKEN", SECRET)
            .stdout(Stdio::piped())
            .spawn()
            .expect("a shell");
        let mut line = String::new();
        BufReader::new(child.stdout.take().expect("its output")).read_line(&mut line).expect("a line");
        Narrow(child, line.trim().to_owned())
    }
}

/// Connections that say nothing.
fn crowd(address: &str) -> Vec<TcpStream> {
    let address = address.parse().expect("an address");
    let come = |_| TcpStream::connect_timeout(&address, Duration::from_secs(1)).ok();
    (0..CROWD).filter_map(come).collect()
}

/// What `pneudrive device` prints, and how long that takes.
fn device(port: &str, what: &str) -> (bool, String, Duration) {
    let begun = Instant::now();
    let mut command = Command::new(env!("CARGO_BIN_EXE_pneudrive"));
    let output = command.args(["device", "--port", port, what]).env("PNEUDRIVE_TOKEN", SECRET).output();
    let output = output.expect("the program runs");
    let printed = [output.stdout, output.stderr].concat();
    (output.status.success(), String::from_utf8(printed).expect("UTF-8"), begun.elapsed())
}

#[test]
fn a_crowd_without_a_token_keeps_nobody_from_a_virtual_rig_that_has_it() {
    let rig = Narrow::start("virtual servo-b-tuned --listen tcp:127.0.0.1:0");
    let port = rig.1.rsplit(' ').next().expect("a port").to_owned();
    let crowd = crowd(port.strip_prefix("tcp://").expect("TCP"));
    assert!(crowd.len() > 100, "{} have come", crowd.len());
    for what in ["arm", "status", "stop"] {
        let (done, printed, took) = device(&port, what);
        println!("device {what}: {took:?} beside {} connections", crowd.len());
        assert!(done && took < SOON, "{what}: {took:?}, {printed}");
    }
    assert!(device(&port, "status").1.contains("fault"), "it is stopped");
}

#[test]
fn wrong_tokens_again_and_again_keep_nobody_from_a_virtual_rig_and_each_waits() {
    let rig = Narrow::start("virtual servo-b-tuned --listen tcp:127.0.0.1:0");
    let port = rig.1.rsplit(' ').next().expect("a port").to_owned();
    let address = port.strip_prefix("tcp://").expect("TCP");
    let mut frame = [0; MAX_FRAME];
    let body = RequestBody::Token { token: "wrong-horse-battery-staple" };
    let request = Request { sequence: 1, session: 1007, boot: 0, body };
    let wrong = encode(&request, &mut frame).expect("fits");
    let begun = Instant::now();
    let mut guesses: Vec<TcpStream> = (0..20)
        .map(|_| {
            let mut stream = TcpStream::connect(address).expect("it listens");
            stream.write_all(wrong).expect("sent");
            stream
        })
        .collect();
    let (done, printed, took) = device(&port, "stop");
    assert!(done && took < SOON, "{took:?}, {printed}");
    for guess in &mut guesses {
        let end = guess.read(&mut [0]);
        assert!(matches!(end, Ok(0) | Err(_)), "it is sent away without a word");
        assert!(begun.elapsed() > Duration::from_millis(900), "{:?}", begun.elapsed());
    }
}

/// A request as the page of a studio makes it; the stream goes on with the answer.
fn ask(host: &str, token: &str, path: &str, body: &Value) -> BufReader<TcpStream> {
    let mut stream = TcpStream::connect(host).expect("it listens");
    stream.set_read_timeout(Some(Duration::from_secs(20))).expect("a socket");
    let body = body.to_string();
    write!(
        stream,
        "POST {path} HTTP/1.1\r\nHost: {host}\r\nAuthorization: Bearer {token}\r\nContent-Type: application/json\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{body}",
        body.len()
    )
    .expect("sent");
    BufReader::new(stream)
}

fn status(answer: &mut BufReader<TcpStream>) -> String {
    let mut line = String::new();
    answer.read_line(&mut line).expect("a status");
    line
}

/// A studio beside a virtual rig of this process: the studio, its host and the rig.
fn studio(port: &str) -> (Narrow, String) {
    let studio = Narrow::start(&format!("studio servo-b-tuned --listen 127.0.0.1:0 --port {port}"));
    let host = studio.1.strip_prefix("http://").and_then(|rest| rest.split('/').next()).expect("an address");
    let host = host.to_owned();
    (studio, host)
}

#[test]
fn a_crowd_without_a_token_keeps_neither_a_page_nor_its_stop_from_a_studio() {
    let rig = unhurried_rig("servo-b-tuned");
    let (_studio, host) = studio(rig.port());
    let mut page = ask(&host, SECRET, "/api/drive", &json!({}));
    assert!(status(&mut page).contains("200"));
    let crowd = crowd(&host);
    assert!(crowd.len() > 100, "{} have come", crowd.len());
    let begun = Instant::now();
    assert!(status(&mut ask(&host, SECRET, "/api/order", &json!({ "order": "stop" }))).contains("202"));
    println!("stop: {:?} beside {} connections", begun.elapsed(), crowd.len());
    assert!(begun.elapsed() < SOON, "{:?}", begun.elapsed());
    let mut client = Client::connect(rig.port()).expect("a rig");
    assert_eq!(client.status().expect("a status").mode, Mode::Fault);
    // The page that commands is told of it all the time.
    let mut told = String::new();
    while !told.contains("\"mode\":\"fault\"") {
        told.clear();
        assert!(page.read_line(&mut told).expect("a line") > 0, "the page has lost its connection");
        assert!(begun.elapsed() < 2 * SOON, "{told}");
    }
}

#[test]
fn wrong_tokens_again_and_again_keep_nobody_from_a_studio_and_each_waits() {
    let rig = unhurried_rig("servo-b-tuned");
    let (_studio, host) = studio(rig.port());
    let stop = json!({ "order": "stop" });
    let begun = Instant::now();
    let mut guesses: Vec<_> =
        (0..20).map(|_| ask(&host, "wrong-horse-battery-staple", "/api/order", &stop)).collect();
    assert!(status(&mut ask(&host, SECRET, "/api/order", &stop)).contains("202"));
    assert!(begun.elapsed() < SOON, "{:?}", begun.elapsed());
    for guess in &mut guesses {
        assert!(status(guess).contains("401"));
        assert!(begun.elapsed() > Duration::from_millis(900), "{:?}", begun.elapsed());
    }
}
