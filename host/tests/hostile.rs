//! A rig that lies, floods or falls silent costs a command its success, and nothing else: it ends soon, with a message and
//! an exit code, in little memory, and nothing that the rig says moves the cursor of the terminal.

use std::fs::read_to_string;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use pneudrive_records::target::TargetFile;

use crate::hostile_rig::HostileRig;
use crate::hostile_rig::lies::{self, Told};
use crate::program::{folder, ok, virtual_rig};

/// A command may not take longer.
const LONGEST: Duration = Duration::from_secs(10);

/// Kilobytes of memory that a command may not need more than.
const MAX_MEMORY_KB: u64 = 200 * 1024;

/// Commands at a time: they wait for the most part.
const AT_ONCE: usize = 6;

/// A program that is on, and the most memory that it was seen to have.
struct Watched {
    child: Child,
    begun: Instant,
    max_memory_kb: u64,
}

impl Watched {
    fn start(folder: &Path, arguments: &str) -> Watched {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pneudrive"));
        command.current_dir(folder).args(arguments.split_whitespace()).env_remove("RUST_BACKTRACE");
        let out = std::fs::File::create(folder.join("out")).expect("a file");
        let err = std::fs::File::create(folder.join("err")).expect("a file");
        let child = command.stdout(out).stderr(err).stdin(Stdio::null()).spawn().expect("the program runs");
        Watched { child, begun: Instant::now(), max_memory_kb: 0 }
    }

    /// Its exit code once it has ended; None if a signal has ended it, an error if nothing has by then.
    fn end(&mut self, within: Duration) -> Result<Option<i32>, String> {
        let status = format!("/proc/{}/status", self.child.id());
        while self.begun.elapsed() < within {
            let memory = read_to_string(&status).unwrap_or_default();
            let peak = memory.lines().find_map(|line| line.strip_prefix("VmHWM:"));
            let peak = peak.and_then(|line| line.trim().trim_end_matches(" kB").parse().ok());
            self.max_memory_kb = self.max_memory_kb.max(peak.unwrap_or(0));
            if let Some(ended) = self.child.try_wait().expect("it was started") {
                return Ok(ended.code());
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
        Err(format!("was still on after {within:?}"))
    }

    #[cfg(unix)]
    fn interrupt(&self) {
        let interrupt = format!("kill -INT {}", self.child.id());
        assert!(Command::new("sh").args(["-c", &interrupt]).status().expect("a shell").success());
    }
}

/// What was said, stderr behind `!`.
fn printed(folder: &Path) -> String {
    let text = |name: &str| -> String {
        read_to_string(folder.join(name))
            .expect("UTF-8")
            .lines()
            .take(12)
            .map(|line| format!("{line}\n"))
            .collect()
    };
    let errors: String = text("err").lines().map(|line| format!("! {line}\n")).collect();
    text("out") + &errors
}

/// Whether a text leaves the terminal as it is.
fn is_clean(text: &str) -> bool {
    !text.chars().any(|c| (c.is_control() && c != '\n') || ('\u{202a}'..='\u{202e}').contains(&c))
}

/// How a command may end: done, or with one of the failures that docs/reference/exit-codes.md has of a rig.
const ENDS: [i32; 6] = [0, 1, 4, 5, 6, 7];

/// What is wrong with how a command gets along with a lie.
fn wrong(lie: &Told, command: &str, expected: &str) -> Option<String> {
    let folder = folder();
    let rig = virtual_rig("servo-b-tuned");
    ok(folder.path(), &format!("run servo-b-tuned --set test.duration_s=0.12 --port {}", rig.port()));
    ok(folder.path(), &format!("device --port {} disarm", rig.port()));
    if command.ends_with("home") {
        ok(folder.path(), &format!("device --port {} arm", rig.port()));
    }
    let rig = HostileRig::before(rig, lie.lie);
    let mut program = Watched::start(folder.path(), &command.replace("PORT", rig.port()));
    let code = match program.end(LONGEST) {
        Ok(Some(code)) if ENDS.contains(&code) => code,
        Ok(code) => return Some(format!("ended with {code:?}: {}", printed(folder.path()))),
        Err(endless) => return Some(format!("{endless}: {}", printed(folder.path()))),
    };
    let printed = format!("{}= {code}", printed(folder.path()));
    if !printed.contains(expected) || (code != 0 && !printed.contains("! error: ")) {
        return Some(format!("{expected:?} is missing in {printed}"));
    }
    if !is_clean(&printed) {
        return Some(format!("moves the cursor: {printed:?}"));
    }
    if program.max_memory_kb > MAX_MEMORY_KB {
        return Some(format!("took {} KB of memory: {printed}", program.max_memory_kb));
    }
    wrong_file(folder.path())
}

/// What is wrong with the files that a command has left: a line that the rig has put there.
fn wrong_file(folder: &Path) -> Option<String> {
    for name in ["TARGET01.DAT", "run.txt"] {
        let Ok(text) = read_to_string(folder.join(name)) else { continue };
        if !is_clean(&text) {
            return Some(format!("{name} holds control characters"));
        }
        match TargetFile::from_text(&text) {
            Ok(file) if file.get("mm_per_count") != Some("0.01205") => {
                return Some(format!("{name} has another scale"));
            }
            Ok(_) => {}
            Err(error) => return Some(format!("{name} cannot be read: {error:#}")),
        }
    }
    None
}

#[test]
fn every_command_gets_along_with_every_lie() {
    let cases: Vec<_> = lies::all()
        .flat_map(|lie| lie.to.iter().map(move |(command, says)| (lie, *command, *says)))
        .collect();
    assert!(lies::all().count() >= 35);
    let (next, complaints) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..AT_ONCE {
            scope.spawn(|| {
                while let Some((lie, command, says)) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
                    if let Some(wrong) = wrong(lie, command, says) {
                        let complaint = format!("{}: {command}: {wrong}", lie.name);
                        complaints.lock().expect("unharmed").push(complaint);
                    }
                }
            });
        }
    });
    let complaints = complaints.into_inner().expect("unharmed");
    let count = complaints.len();
    assert!(complaints.is_empty(), "{count} of {}:\n{}", cases.len(), complaints.join("\n\n"));
}

/// The lie of this name.
fn lie(name: &str) -> &'static Told {
    lies::all().find(|lie| lie.name == name).expect("one of them")
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_a_command_whatever_the_rig_says() {
    let endless = "run servo-b-tuned --until-stopped --port PORT";
    let streamed = format!("{endless} --stream run.txt");
    let cases = [
        ("a run that goes on behind its end", endless),
        ("a run that stands still", endless),
        ("rows without end", &streamed),
        ("rows that are asked for again and come one by one, far away", &streamed),
        ("a run that goes back and forth", &streamed),
        ("numbers as large as they come", "monitor --port PORT --every 0.01"),
        ("noise without end", "monitor --port PORT"),
        ("silence about its samples", "record --port PORT"),
    ];
    std::thread::scope(|scope| {
        for (name, command) in cases {
            scope.spawn(move || {
                let folder = folder();
                let rig = virtual_rig("servo-b-tuned");
                ok(
                    folder.path(),
                    &format!("run servo-b-tuned --set test.duration_s=0.12 --port {}", rig.port()),
                );
                let rig = HostileRig::before(rig, lie(name).lie);
                let mut program = Watched::start(folder.path(), &command.replace("PORT", rig.port()));
                std::thread::sleep(Duration::from_millis(800));
                program.interrupt();
                let waited = program.begun.elapsed() + Duration::from_secs(4);
                // 101 is a panic, 134 an abort.
                let ended = program.end(waited);
                assert!(
                    matches!(ended, Ok(None | Some(0 | 1 | 130))),
                    "{name}: {command}: {ended:?}: {}",
                    printed(folder.path())
                );
            });
        }
    });
}
