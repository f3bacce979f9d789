//! The studio's page as a folder of files, for a host that serves files and nothing else: the page, and the designer as
//! WebAssembly in the place of the server.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use pneudrive_build::cargo::{self, built, in_root, root, run};

/// The compiler target of the module in the browser.
pub const TARGET: &str = "wasm32-unknown-unknown";

/// The page's permissions in the browser: load its own files, and run its own module.
const POLICY: &str = "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; \
style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; worker-src 'self'; base-uri 'none'; form-action 'none'\">\n";

/// Where the policy goes.
const BEFORE_POLICY: &str = "<meta charset=\"utf-8\">\n";

/// Where the folder is if nobody says otherwise.
///
/// # Errors
/// When CARGO_TARGET_DIR is relative and the current folder is gone.
pub fn usual_folder() -> Result<PathBuf> {
    built("web")
}

/// Builds the designer and writes the folder.
///
/// # Errors
/// When the target cannot be installed, the designer does not compile, or a file cannot be written.
pub fn build(folder: &Path) -> Result<()> {
    cargo::ensure_target(TARGET)?;
    let package = ["build", "--profile", "web", "--package", "pneudrive-page", "--example", "designer"];
    run(&mut in_root(&[&package[..], &["--target", TARGET]].concat()))?;
    fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    // The files of the page without a server go over those of the page with one.
    for from in ["host/page/web", "host/page/browser/web"] {
        copy_files(&root().join(from), folder)?;
    }
    let index = folder.join("index.html");
    let page = fs::read_to_string(&index)?;
    ensure!(page.contains(BEFORE_POLICY), "index.html has no place for its policy");
    fs::write(&index, page.replace(BEFORE_POLICY, &format!("{BEFORE_POLICY}{POLICY}")))?;
    let module = folder.join("designer.wasm");
    fs::copy(built(&format!("{TARGET}/web/examples/designer.wasm"))?, &module)?;
    println!("{}: {} kB of WebAssembly", folder.display(), fs::metadata(&module)?.len() / 1000);
    Ok(())
}

fn copy_files(from: &Path, to: &Path) -> Result<()> {
    for entry in fs::read_dir(from).with_context(|| from.display().to_string())? {
        let entry = entry?;
        let to = to.join(entry.file_name());
        fs::copy(entry.path(), &to).with_context(|| to.display().to_string())?;
    }
    Ok(())
}
