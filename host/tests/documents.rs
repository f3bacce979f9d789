//! The commands of README and book, typed page by page into a shell in an empty folder.
//!
//! A page may hold commands that its reader has behind him, in comments: `<!-- before: pneudrive rig new ... -->`. What a
//! page shows as `text` between its commands must have been printed by them. A block behind `<!-- not followed: why -->`
//! is not typed; the last command of one behind `<!-- fails: why -->` must fail. `/dev/ttyACM0` and P are a virtual rig here.

use std::fs;
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::program::{folder, unhurried_rig};

const DOCS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs");

/// The port that the pages give a virtual rig.
const PORT_OF_PAGES: &str = "127.0.0.1:4000";

/// What a page asks its reader to do, or says that he sees.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Step {
    Type(String),
    /// A command that ends with an exit code that is not 0.
    Fail(String),
    See(String),
}

/// The steps of a page.
fn steps(page: &str) -> Vec<Step> {
    let page = page.replace("\\\n", " ");
    let mut fence: Option<&str> = None;
    let (mut left_out, mut fails) = (false, false);
    let mut steps = Vec::new();
    for line in page.lines() {
        if let Some(language) = line.strip_prefix("```") {
            fence = match fence {
                Some(_) => {
                    if let (true, Some(Step::Type(last))) =
                        (std::mem::take(&mut fails), steps.last().cloned())
                    {
                        steps.pop();
                        steps.push(Step::Fail(last));
                    }
                    None
                }
                None if std::mem::take(&mut left_out) => Some("left out"),
                None => Some(language),
            };
        } else if line.starts_with("<!-- not followed: ") {
            left_out = true;
        } else if line.starts_with("<!-- fails: ") {
            fails = true;
        } else if let Some(typed) = line.strip_prefix("<!-- before: ") {
            steps.push(Step::Type(typed.trim_end_matches("-->").trim().to_owned()));
        } else if fence == Some("") && line.starts_with("pneudrive ") {
            steps.push(Step::Type(line.to_owned()));
        } else if fence == Some("text") {
            steps.push(Step::See(line.to_owned()));
        }
    }
    steps
}

/// A reader with an empty folder.
struct Reader {
    folder: tempfile::TempDir,
    /// What stands in for [`PORT_OF_PAGES`].
    port: String,
    /// A board at `/dev/ttyACM0`.
    board: pneudrive_rigs::virtual_rig::Background,
    printed: String,
    running: Vec<Child>,
}

impl Reader {
    fn new() -> Reader {
        let folder = folder();
        std::os::unix::fs::symlink(env!("CARGO_BIN_EXE_pneudrive"), folder.path().join("pneudrive"))
            .expect("a link");
        fs::create_dir(folder.path().join("here")).expect("a folder");
        std::os::unix::fs::symlink(DOCS, folder.path().join("here/docs")).expect("a link");
        let free = TcpListener::bind("127.0.0.1:0").expect("a port").local_addr().expect("an address");
        let board = unhurried_rig("press");
        Reader { folder, port: free.to_string(), board, printed: String::new(), running: Vec::new() }
    }

    /// The same command on this machine.
    fn here(&self, typed: &str) -> String {
        let typed = typed.replace(PORT_OF_PAGES, &self.port).replace("/dev/ttyACM0", self.board.port());
        typed.replace("--port P ", &format!("--port {} ", self.board.port()))
    }

    fn shell(&self, typed: &str) -> Command {
        let mut shell = Command::new("sh");
        let path = format!("{}:{}", self.folder.path().display(), std::env::var("PATH").expect("a path"));
        shell.args(["-c", typed]).current_dir(self.folder.path().join("here"));
        shell.env("PATH", path).env_remove("RUST_BACKTRACE").stdin(Stdio::null());
        shell
    }

    fn follow(&mut self, step: &Step) {
        match step {
            Step::Type(typed) if typed.starts_with("pneudrive virtual") => {
                self.serve(typed, &self.port.clone())
            }
            Step::Type(typed) if typed.starts_with("pneudrive studio") => {
                let free =
                    TcpListener::bind("127.0.0.1:0").expect("a port").local_addr().expect("an address");
                let command = typed.split(" #").next().expect("a command").trim_end();
                self.serve(&format!("{command} --listen {free}"), &free.to_string());
            }
            Step::Type(typed) => self.run(typed, true),
            Step::Fail(typed) => self.run(typed, false),
            Step::See(line) => assert!(
                plain(&self.printed).contains(&plain(line)),
                "the page has {line:?}, which was not printed:\n{}",
                self.printed
            ),
        }
    }

    fn run(&mut self, typed: &str, succeeds: bool) {
        let output = self.shell(&self.here(typed)).output().expect("a shell");
        let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
        assert_eq!(output.status.success(), succeeds, "{typed}: {}{}", text[0], text[1]);
        self.printed.extend(text);
    }

    /// Starts what does not end, and waits until it answers at its address.
    fn serve(&mut self, typed: &str, address: &str) {
        let mut shell = self.shell(&format!("exec {}", self.here(typed)));
        self.running.push(shell.stdout(Stdio::null()).spawn().expect("a shell"));
        let begun = Instant::now();
        while TcpStream::connect(address).is_err() {
            assert!(begun.elapsed() < Duration::from_secs(30), "{typed}: nothing answers");
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}

impl Drop for Reader {
    fn drop(&mut self) {
        for child in &mut self.running {
            // One that has ended is not there any more.
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// A text without the width of its spaces.
fn plain(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn follow(page: &str) {
    let text = fs::read_to_string(Path::new(DOCS).join(page)).expect(page);
    let mut reader = Reader::new();
    steps(&text).iter().for_each(|step| reader.follow(step));
}

macro_rules! pages {
    ($($name:ident: $page:literal,)*) => {
        /// The pages that are followed.
        const FOLLOWED: &[&str] = &[$($page),*];

        $(
            #[test]
            #[ignore = "long: cargo xtask test long"]
            fn $name() {
                follow($page);
            }
        )*
    };
}

pages! {
    the_readme_can_be_followed: "../README.md",
    a_first_drive_can_be_followed: "tutorial/first-drive.md",
    the_first_hour_can_be_followed: "tutorial/first-hour.md",
    own_drive_can_be_followed: "howto/own-drive.md",
    the_studio_can_be_followed: "howto/studio.md",
    profiles_can_be_followed: "howto/profiles.md",
    identification_can_be_followed: "howto/identification.md",
    bring_up_can_be_followed: "howto/bring-up.md",
    a_drive_without_a_pc_can_be_followed: "howto/without-a-pc.md",
    fmus_can_be_followed: "howto/fmu.md",
    logs_can_be_followed: "howto/logs.md",
    the_thesis_can_be_followed: "explanation/thesis.md",
    json_can_be_followed: "reference/json.md",
}

#[test]
fn every_page_with_commands_is_followed() {
    let folders = ["tutorial", "howto", "explanation", "reference"];
    for folder in folders {
        for entry in fs::read_dir(Path::new(DOCS).join(folder)).expect("a folder").filter_map(Result::ok) {
            let name = format!("{folder}/{}", entry.file_name().to_str().expect("a name"));
            let text = fs::read_to_string(entry.path()).expect("a page");
            let has_commands = steps(&text).iter().any(|step| matches!(step, Step::Type(_)));
            assert!(!has_commands || FOLLOWED.contains(&name.as_str()), "{name}");
        }
    }
}
