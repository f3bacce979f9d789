//! The pages in a browser: no error, no request that leaves the page, and graphs with curves in them.
//!
//! Needs Chromium, so `cargo xtask test web` runs it, and `cargo test --workspace` does not.

#[allow(dead_code)] // It belongs to the other tests, which use the rest.
mod program;

use std::fs;
use std::path::Path;
use std::process::Command;

use pneudrive_sim::Rig;

use program::{folder, ok, virtual_rig_of};

/// What a browser made of a page.
struct Seen {
    /// What the page's scripts complained of.
    console: Vec<String>,
    /// What the page asked the network for.
    requests: Vec<String>,
    /// The page after its scripts have run.
    document: String,
}

/// The command that starts Chromium.
fn chromium() -> &'static str {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let starts = |name: &&str| {
        Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success())
    };
    names.into_iter().find(starts).expect("Chromium, which cargo xtask test web installs where it may")
}

/// Opens a page with no network to reach.
fn open(browser: &str, profile: &Path, page: &Path) -> Seen {
    let log = profile.join("net.json");
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"])
        .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
        .args(["--host-resolver-rules=MAP * ~NOTFOUND", "--enable-logging=stderr", "--v=0"])
        .args(["--virtual-time-budget=20000", "--dump-dom"])
        .arg(format!("--user-data-dir={}", profile.display()))
        .arg(format!("--log-net-log={}", log.display()))
        .arg(format!("file://{}", page.display()))
        .output()
        .expect("the browser runs");
    let errors = String::from_utf8_lossy(&output.stderr);
    let net = fs::read_to_string(&log).expect("a log of the network");
    // The browser's own requests have no page that they belong to.
    let of_page =
        |line: &&str| line.contains("\"network_isolation_key\":\"file://") && line.contains("\"url\":\"http");
    Seen {
        console: errors.lines().filter(|line| line.contains("CONSOLE")).map(str::to_owned).collect(),
        requests: net.lines().filter(of_page).map(str::to_owned).collect(),
        document: String::from_utf8_lossy(&output.stdout).into_owned(),
    }
}

/// What leaves the pages.
const COMMANDS: [&str; 10] = [
    "simulate servo-b-tuned --set test.duration_s=0.5 --out run",
    "eval run --out eval.html",
    "overlay run run --out overlay.html",
    "spectrum run position --out spectrum.html",
    "characterise servo-b flow-gain --out .",
    "characterise servo-b pressure-drop --out .",
    "characterise servo-b frequency-response --out .",
    "study impulse --starts 2 --out .",
    "ladder servo-a --set test.duration_s=0.2 --out .",
    "tune servo-a --settled 2 --overshoot 20 --population 2 --generations 2 --load 0% --friction 0% --out .",
];

/// Pages with their graphs and curves.
///
/// 7 channels of a transient are 7 curves on 5 graphs; the setpoint is drawn once, of two drives, too. The perturbed runs
/// of a run shade six of them between two edges each. The tuning keeps the gains of the file, and no draw meets its
/// goal: the steps are one curve on two graphs, with the two bounds; those that settle and those that do not are two
/// on the third; then come the profile, four of the file's rig, and the search.
const PAGES: [(&str, usize, usize); 10] = [
    ("run/report.html", 5, 7 + 12),
    ("eval.html", 7, 9 + 12),
    ("overlay.html", 5, 13 + 24),
    ("spectrum.html", 1, 1),
    ("flow-gain.html", 2, 10),
    ("frequency-response.html", 2, 4),
    ("pressure-drop.html", 1, 3),
    ("impulse.html", 5, 13),
    ("ladder.html", 4, 35),
    ("tune.html", 14, 26),
];

/// The longest page, without the library that is beside it, bytes.
const LONGEST: u64 = 300_000;

/// The longest page that carries the library.
const LONGEST_SINGLE: u64 = 2_000_000;

fn length(page: &Path) -> u64 {
    fs::metadata(page).expect("written").len()
}

#[test]
fn pages_open_without_an_error_or_a_network_and_show_their_graphs() {
    let browser = chromium();
    let folder = folder();
    let profile = tempfile::tempdir().expect("a folder");
    for arguments in COMMANDS {
        ok(folder.path(), arguments);
    }
    for (name, graphs, curves) in PAGES {
        let page = folder.path().join(name);
        assert!(length(&page) <= LONGEST, "{name}: {} bytes", length(&page));
        let seen = open(browser, profile.path(), &page);
        assert!(seen.console.is_empty(), "{name}: {:?}", seen.console);
        assert!(seen.requests.is_empty(), "{name}: {:?}", seen.requests);
        let drawn = |what: &str| seen.document.matches(what).count();
        assert_eq!(drawn("<g class=\"subplot "), graphs, "{name}");
        assert_eq!(drawn("<g class=\"trace scatter"), curves, "{name}");
        // A line each, more where it has gaps, and a short one each in the legend; or a point.
        let lines = drawn("class=\"js-line\" d=\"M") - drawn("class=\"js-line\" d=\"M5,0h30");
        let points = drawn("<path class=\"point\"");
        assert!(lines + points >= curves, "{name}: {lines} lines and {points} points of {curves} curves");
    }
}

#[test]
fn the_page_of_an_identification_shows_each_record_with_its_model_and_what_remains() {
    let browser = chromium();
    let folder = folder();
    let profile = tempfile::tempdir().expect("a folder");
    // A fit is judged by the noise of the sensors.
    let noisy = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    let rig = virtual_rig_of(noisy.with_numbers(&[("sensors.noise_counts", 1.0)]).expect("valid"));
    ok(folder.path(), &format!("identify servo-b-tuned --plan {} --fit load.mass_kg", rig.port()));
    rig.stop().expect("it served");
    let seen = open(browser, profile.path(), &folder.path().join("identified/identification.html"));
    assert!(seen.console.is_empty() && seen.requests.is_empty(), "{:?} {:?}", seen.console, seen.requests);
    let drawn = |what: &str| seen.document.matches(what).count();
    // Six records: four channels with their model before and after, and four residuals.
    let page = folder.path().join("identified/identification.html");
    assert!(length(&page) <= LONGEST, "{} bytes", length(&page));
    assert_eq!(drawn("<g class=\"subplot "), 6 * 8);
    assert_eq!(drawn("<g class=\"trace scatter"), 6 * 16);
    for table in ["parameters", "root mean square", "correlation of the estimates", "read off the records"] {
        assert!(seen.document.contains(table), "{table}");
    }
}

#[test]
fn a_single_file_shows_its_graphs_alone_and_a_page_without_its_library_says_what_is_missing() {
    let browser = chromium();
    let (folder, alone) = (folder(), tempfile::tempdir().expect("a folder"));
    let profile = tempfile::tempdir().expect("a folder");
    let run = "simulate servo-b-tuned --set test.duration_s=0.5 --overwrite --out run";
    for (options, graphs) in [("--single-file", 5), ("", 0)] {
        ok(folder.path(), &format!("{run} {options}"));
        let page = alone.path().join("moved.html");
        fs::copy(folder.path().join("run/report.html"), &page).expect("copied");
        assert!(length(&page) <= LONGEST_SINGLE, "{} bytes", length(&page));
        let seen = open(browser, profile.path(), &page);
        assert_eq!(seen.document.matches("<g class=\"subplot ").count(), graphs, "{options}");
        assert!(seen.console.is_empty(), "{:?}", seen.console);
        assert_eq!(
            seen.document.contains("beside this page; --single-file puts it into the page.</div>"),
            graphs == 0
        );
    }
}

/// The check would notice.
#[test]
fn a_page_with_an_error_and_a_request_is_noticed() {
    let browser = chromium();
    let folder = folder();
    let page = folder.path().join("bad.html");
    let text = "<!doctype html><script>missing();</script><img src=\"http://example.org/x.png\">";
    fs::write(&page, text).expect("written");
    let seen = open(browser, folder.path(), &page);
    assert!(seen.console.iter().any(|line| line.contains("missing is not defined")), "{:?}", seen.console);
    assert!(seen.requests.iter().any(|line| line.contains("example.org/x.png")), "{:?}", seen.requests);
}
