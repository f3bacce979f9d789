//! The studio as a program, and a drive that it has left moving.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use pneudrive_controller::Fault;
use pneudrive_link::client::Client;
use pneudrive_protocol::Mode;
use pneudrive_sim::rigfile::builtin;
use serde_json::{Value, json};

use crate::program::{folder, transcript, unhurried_rig};

/// A studio of its own process.
struct Served {
    child: Child,
    host: String,
    token: String,
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Served {
    fn start(arguments: &[&str]) -> Served {
        let mut child = Command::new(env!("CARGO_BIN_EXE_pneudrive"))
            .args(["studio", "servo-b-tuned", "--listen", "127.0.0.1:0"])
            .args(arguments)
            .env_remove("PNEUDRIVE_TOKEN")
            .stdout(Stdio::piped())
            .spawn()
            .expect("the program runs");
        let mut line = String::new();
        BufReader::new(child.stdout.take().expect("its output")).read_line(&mut line).expect("a line");
        let address = line.trim().strip_prefix("http://").expect("an address");
        let (host, token) = address.split_once("/#token=").expect("a token");
        Served { host: host.to_owned(), token: token.to_owned(), child }
    }

    /// Sends a request; the stream goes on with the answer.
    fn ask(&self, path: &str, body: &Value) -> BufReader<TcpStream> {
        ask(&self.host, &self.token, path, body).expect("it listens")
    }

    /// Is heard as a page is, until the studio has gone.
    fn beat(&self, number: u64) {
        let (host, token) = (self.host.clone(), self.token.clone());
        let alive = json!({ "number": number, "order": "alive" });
        std::thread::spawn(move || {
            while let Ok(mut answer) = ask(&host, &token, "/api/order", &alive) {
                let _ = answer.read_to_string(&mut String::new());
                std::thread::sleep(Duration::from_millis(50));
            }
        });
    }

    /// The number that the server gives to a page.
    fn open(&self) -> (u64, BufReader<TcpStream>) {
        let mut stream = self.ask("/api/drive", &json!({}));
        loop {
            let mut line = String::new();
            stream.read_line(&mut line).expect("a line");
            if let Some(number) = line.trim().strip_prefix("{\"number\":") {
                let number = number.trim_end_matches('}').parse().expect("a number");
                return (number, stream);
            }
        }
    }
}

/// Sends a request; the stream goes on with the answer.
fn ask(host: &str, token: &str, path: &str, body: &Value) -> std::io::Result<BufReader<TcpStream>> {
    let mut stream = TcpStream::connect(host)?;
    let body = body.to_string();
    write!(
        stream,
        "POST {path} HTTP/1.1\r\nHost: {host}\r\nAuthorization: Bearer {token}\r\nContent-Type: application/json\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{body}",
        body.len()
    )?;
    Ok(BufReader::new(stream))
}

/// Whoever moves a drive and is killed leaves a drive that trips, as its host is silent.
#[test]
fn a_studio_that_is_killed_under_a_moving_drive_leaves_a_drive_that_trips() {
    let rig = unhurried_rig("servo-b-tuned");
    let mut studio = Served::start(&["--port", rig.port()]);
    let (number, _page) = studio.open();
    studio.beat(number);
    let run = json!({
        "number": number, "order": "run",
        "rig": { "name": "servo-b-tuned", "text": builtin("servo-b-tuned"), "settings": ["test.duration_s=20"] },
    });
    let mut answer = String::new();
    studio.ask("/api/order", &run).read_to_string(&mut answer).expect("an answer");
    assert!(answer.starts_with("HTTP/1.1 202"), "{answer}");
    let mut client = Client::connect(rig.port()).expect("a rig");
    wait_for(&mut client, Mode::Running);
    studio.child.kill().expect("killed");
    let begun = Instant::now();
    wait_for(&mut client, Mode::Fault);
    assert_eq!(client.status().expect("a status").fault, Fault::HostSilent.code());
    assert!(begun.elapsed() < Duration::from_secs(2), "{:?}", begun.elapsed());
}

fn wait_for(client: &mut Client, mode: Mode) {
    let begun = Instant::now();
    while client.status().expect("a status").mode != mode {
        assert!(begun.elapsed() < Duration::from_secs(10), "never {mode:?}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn a_rig_that_is_not_there_and_an_address_in_the_network_are_refused_with_what_to_do() {
    let folder = folder();
    let told = transcript(folder.path(), "studio nobody.toml");
    assert!(told.contains("no rig file nobody.toml") && told.ends_with("= 3"), "{told}");
    let told = transcript(folder.path(), "studio servo-b --listen 0.0.0.0:0");
    assert!(told.contains("PNEUDRIVE_TOKEN") && told.ends_with("= 1"), "{told}");
}
