//! The system's Chromium, told what to do by its DevTools protocol.
//!
//! The protocol is JSON over a web socket, and the tests need six of its methods. Crates for all of it bring a generator of
//! code, a TLS stack and a downloader; tungstenite alone does.

use std::fs;
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;
use tungstenite::{Message, WebSocket};

/// How long the page may take for anything.
const PATIENCE: Duration = Duration::from_secs(60);

/// A browser with one page.
pub struct Browser {
    child: Child,
    socket: WebSocket<TcpStream>,
    session: Option<String>,
    calls: u64,
    /// What the page's scripts complained of.
    pub complaints: Vec<String>,
    _profile: TempDir,
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The command that starts Chromium.
fn program() -> &'static str {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let starts = |name: &&str| {
        Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success())
    };
    names.into_iter().find(starts).expect("Chromium, which cargo xtask test web installs where it may")
}

impl Browser {
    /// Opens a page in a window of this size, pixels.
    pub fn open(address: &str, [width, height]: [u32; 2]) -> Browser {
        let profile = tempfile::tempdir().expect("a folder");
        let child = Command::new(program())
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--hide-scrollbars"])
            .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
            .args(["--remote-debugging-port=0", "about:blank"])
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg(format!("--window-size={width},{height}"))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the browser starts");
        let socket = connected(&profile);
        let mut browser =
            Browser { child, socket, session: None, calls: 0, complaints: Vec::new(), _profile: profile };
        let target = browser.call("Target.createTarget", json!({ "url": "about:blank" }));
        let attached = json!({ "targetId": target["targetId"], "flatten": true });
        let attached = browser.call("Target.attachToTarget", attached);
        browser.session = attached["sessionId"].as_str().map(str::to_owned);
        for domain in ["Page.enable", "Runtime.enable", "Log.enable"] {
            browser.call(domain, json!({}));
        }
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        browser.call("Emulation.setDeviceMetricsOverride", size);
        browser.call("Page.navigate", json!({ "url": address }));
        browser
    }

    /// Opens a second tab at an address, and goes there; the tab before, for [`Browser::go_to`].
    pub fn open_tab(&mut self, address: &str) -> Option<String> {
        let before = self.session.take();
        let target = self.call("Target.createTarget", json!({ "url": address }));
        let attached = json!({ "targetId": target["targetId"], "flatten": true });
        let attached = self.call("Target.attachToTarget", attached);
        self.session = attached["sessionId"].as_str().map(str::to_owned);
        self.call("Runtime.enable", json!({}));
        before
    }

    /// Goes to another tab; the tab before.
    pub fn go_to(&mut self, tab: Option<String>) -> Option<String> {
        std::mem::replace(&mut self.session, tab)
    }

    /// Calls a method of the protocol.
    pub fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.try_call(method, parameters).unwrap_or_else(|error| panic!("{method}: {error}"))
    }

    /// The result of a method of the protocol, or the browser's error.
    fn try_call(&mut self, method: &str, parameters: Value) -> Result<Value, Value> {
        self.calls += 1;
        let mut message = json!({ "id": self.calls, "method": method, "params": parameters });
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        self.socket.send(Message::text(message.to_string())).expect("the browser listens");
        loop {
            let Message::Text(text) = self.socket.read().expect("the browser answers") else { continue };
            let heard: Value = serde_json::from_str(&text).expect("JSON");
            if heard["id"] == json!(self.calls) {
                let error = &heard["error"];
                return if error.is_null() { Ok(heard["result"].clone()) } else { Err(error.clone()) };
            }
            self.note(&heard);
        }
    }

    fn note(&mut self, heard: &Value) {
        let parameters = &heard["params"];
        match heard["method"].as_str() {
            Some("Runtime.exceptionThrown") => {
                self.complaints.push(parameters["exceptionDetails"].to_string())
            }
            Some("Log.entryAdded") if parameters["entry"]["level"] == "error" => {
                let entry = parameters["entry"].to_string();
                // A rig that is refused, and a file that is there already, are answers that tests ask for.
                if !["status of 422", "status of 409"].iter().any(|refusal| entry.contains(refusal)) {
                    self.complaints.push(entry);
                }
            }
            _ => {}
        }
    }

    /// What a script makes; a promise is waited for.
    pub fn evaluate(&mut self, script: &str) -> Value {
        self.try_evaluate(script).unwrap_or_else(|error| panic!("{script}: {error}"))
    }

    fn try_evaluate(&mut self, script: &str) -> Result<Value, Value> {
        let call = json!({ "expression": script, "awaitPromise": true, "returnByValue": true });
        let made = self.try_call("Runtime.evaluate", call)?;
        assert!(made["exceptionDetails"].is_null(), "{script}: {made}");
        Ok(made["result"]["value"].clone())
    }

    /// Waits until a script makes true, and tells how long that took. A page that goes while it is asked is asked again.
    pub fn wait_until(&mut self, script: &str) -> Duration {
        let begun = Instant::now();
        loop {
            match self.try_evaluate(&format!("Boolean({script})")) {
                Ok(made) if made == json!(true) => break,
                Err(error) if !error.to_string().contains("navigated") => panic!("{script}: {error}"),
                _ => {}
            }
            let state = "document.getElementById('state')?.textContent";
            assert!(begun.elapsed() < PATIENCE, "never: {script}; the page says {}", self.evaluate(state));
            sleep(Duration::from_millis(20));
        }
        begun.elapsed()
    }

    /// The text of an element.
    pub fn text(&mut self, selector: &str) -> String {
        let text = self.evaluate(&format!("document.querySelector({selector:?}).textContent"));
        text.as_str().expect("a text").to_owned()
    }

    /// The middle of an element on the screen.
    pub fn middle(&mut self, selector: &str) -> [f64; 2] {
        let script = format!(
            "(() => {{ const one = document.querySelector({selector:?}); one.scrollIntoView({{ block: 'nearest' }}); \
             const box = one.getBoundingClientRect(); return [box.x + box.width / 2, box.y + box.height / 2]; }})()"
        );
        let place = self.evaluate(&script);
        [0, 1].map(|axis| place[axis].as_f64().expect("a place"))
    }

    /// An event of the mouse: mousePressed, mouseMoved or mouseReleased.
    pub fn mouse(&mut self, kind: &str, [x, y]: [f64; 2]) {
        let held = i32::from(kind != "mouseReleased");
        let event =
            json!({ "type": kind, "x": x, "y": y, "button": "left", "buttons": held, "clickCount": 1 });
        self.call("Input.dispatchMouseEvent", event);
    }

    /// Clicks on an element.
    pub fn click(&mut self, selector: &str) {
        let place = self.middle(selector);
        self.mouse("mousePressed", place);
        self.mouse("mouseReleased", place);
    }

    /// Presses a key, with Control held if asked.
    pub fn press(&mut self, key: &str, code: u32, control: bool) {
        for kind in ["keyDown", "keyUp"] {
            let modifiers = if control { 2 } else { 0 };
            let text = if key == "Enter" { "\r" } else { "" };
            let event = json!({
                "type": kind, "key": key, "text": text, "windowsVirtualKeyCode": code, "modifiers": modifiers,
            });
            self.call("Input.dispatchKeyEvent", event);
        }
    }

    /// Types a text into a field, in the place of what it has.
    pub fn type_into(&mut self, selector: &str, text: &str) {
        self.evaluate(&format!(
            "document.querySelector({selector:?}).focus(); document.querySelector({selector:?}).select()"
        ));
        self.call("Input.insertText", json!({ "text": text }));
    }

    /// The page as a picture, PNG in base 64.
    pub fn picture(&mut self) -> String {
        let picture = self.call("Page.captureScreenshot", json!({ "format": "png" }));
        picture["data"].as_str().expect("a picture").to_owned()
    }
}

/// The browser writes its port into its profile.
fn connected(profile: &TempDir) -> WebSocket<TcpStream> {
    let begun = Instant::now();
    let text = loop {
        let text = fs::read_to_string(profile.path().join("DevToolsActivePort")).unwrap_or_default();
        if text.lines().count() >= 2 {
            break text;
        }
        assert!(begun.elapsed() < PATIENCE, "the browser tells no port");
        sleep(Duration::from_millis(20));
    };
    let (port, path) = text.split_once('\n').expect("port and path");
    let stream = TcpStream::connect(format!("127.0.0.1:{port}")).expect("the browser listens");
    stream.set_nodelay(true).expect("a socket");
    tungstenite::client(format!("ws://127.0.0.1:{port}{}", path.trim()), stream).expect("a web socket").0
}
