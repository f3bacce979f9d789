//! Opens and saves rig files.
//!
//! A page may write rig files into one folder: the folder of the opened rig, or the one in which the studio was started.
//! An existing file is replaced without a question only if it still holds what the studio last read or wrote there.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use axum::Json;
use axum::extract::{self, State};
use axum::http::StatusCode;
use pneudrive_page::page_rig::PageRig;
use pneudrive_page::refusal::HttpRefusal;
use pneudrive_page::rigs::{self, Opened, ToSave};
use pneudrive_records::whole_file;
use pneudrive_sim::rigfile::builtin;
use serde_json::{Value, json};

use crate::refusal_response::RefusalResponse;

/// Where rig files are.
#[derive(Debug)]
pub struct Files {
    folder: PathBuf,
    opened: Opened,
    /// What the studio last read from or wrote to the files in the folder.
    known: Mutex<BTreeMap<String, String>>,
}

impl Files {
    /// The folder of a rig file; the current folder for a built-in rig.
    #[must_use]
    pub fn new(opened: Opened) -> Files {
        let path = Path::new(&opened.name);
        let name =
            path.file_name().and_then(|name| name.to_str()).filter(|_| builtin(&opened.name).is_none());
        let known = name.map(|name| (name.to_owned(), opened.text.clone()));
        let folder = name.map_or_else(|| PathBuf::from("."), |_| whole_file::folder_of(path).to_owned());
        Files { folder, opened, known: Mutex::new(known.into_iter().collect()) }
    }

    /// A rig file that the studio has read or written, as it was then.
    fn known(&self, name: &str) -> Option<Opened> {
        let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        Some(Opened { name: name.to_owned(), text: known.get(name)?.clone() })
    }

    /// The rig that the studio was started with, as it was last read or written.
    fn opened(&self) -> Opened {
        let name = Path::new(&self.opened.name).file_name().and_then(|name| name.to_str());
        let known = name.and_then(|name| self.known(name));
        Opened {
            text: known.map_or_else(|| self.opened.text.clone(), |known| known.text),
            ..self.opened.clone()
        }
    }

    /// Refuses to save over what a page has not seen: its rig is this file, as it was before another page saved it.
    fn refuse_stale(&self, asked: &PageRig, name: &str) -> Result<(), HttpRefusal> {
        let is_same = Path::new(&asked.name).file_name().is_some_and(|own| own == name);
        match self.known(name) {
            Some(known) if is_same && known.text != asked.text => Err(HttpRefusal::new(
                StatusCode::CONFLICT,
                format!("{name} was saved by another page since this one opened it"),
            )),
            _ => Ok(()),
        }
    }

    /// Writes a rig file whole or not at all.
    fn save(&self, name: &str, text: &str, replace: bool) -> Result<(), HttpRefusal> {
        let path = self.folder.join(file_name(name)?);
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let there = fs::read(&path);
        let theirs = match &there {
            Ok(there) => known.get(name).is_none_or(|known| without_mark(there) != known.as_bytes()),
            Err(error) => error.kind() != std::io::ErrorKind::NotFound,
        };
        if theirs && !replace {
            let message = format!("{} is there already, and the studio has not written it", path.display());
            return Err(HttpRefusal::new(StatusCode::CONFLICT, message));
        }
        let mark = if there.is_ok_and(|there| there.starts_with(MARK)) { MARK } else { &[] };
        whole_file::put(&path, &[mark, text.as_bytes()].concat()).map_err(|error| HttpRefusal::of(&error))?;
        known.insert(name.to_owned(), text.to_owned());
        Ok(())
    }
}

/// The byte order mark that some editors put before a text.
const MARK: &[u8] = "\u{feff}".as_bytes();

fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(MARK).unwrap_or(bytes)
}

/// A name that stays within the folder.
fn file_name(name: &str) -> Result<&str, HttpRefusal> {
    let plain = |letter: char| letter.is_alphanumeric() || "-_. ".contains(letter);
    let fits =
        name.ends_with(".toml") && !name.starts_with('.') && name.len() <= 100 && name.chars().all(plain);
    if fits {
        return Ok(name);
    }
    let message =
        format!("{name:?} is no name of a rig file: write letters, digits, - and _, with .toml at the end");
    Err(HttpRefusal::new(StatusCode::BAD_REQUEST, message))
}

/// The built-in rigs, and the one that was opened.
pub async fn list(State(files): State<Arc<Files>>) -> Json<Value> {
    Json(rigs::list(&files.opened()))
}

/// The text of a built-in rig, or of a file that the studio has read or written.
///
/// # Errors
/// When there is none of that name.
pub async fn open(
    State(files): State<Arc<Files>>,
    extract::Path(name): extract::Path<String>,
) -> Result<Json<Opened>, RefusalResponse> {
    Ok(Json(files.known(&name).map_or_else(|| Opened::builtin(&name), Ok)?))
}

/// Saves a rig: the opened file, with the settings in place of the old values and all other lines kept.
///
/// # Errors
/// When the rig is not valid, the name leads out of the folder, another program has changed the file, or it cannot be
/// written.
pub async fn save(
    State(files): State<Arc<Files>>,
    Json(ToSave { asked, file, replace }): Json<ToSave>,
) -> Result<Json<Value>, RefusalResponse> {
    let text = rigs::text_to_save(&asked, &file)?;
    if !replace {
        files.refuse_stale(&asked, &file)?;
    }
    files.save(&file, &text, replace)?;
    Ok(Json(json!({ "name": file, "text": text })))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_leads_nowhere_but_into_the_folder() {
        for name in ["mine.toml", "drive 2.toml", "größer.toml"] {
            assert!(file_name(name).is_ok(), "{name}");
        }
        for name in ["", ".toml", "../mine.toml", "a/b.toml", "a\\b.toml", "mine.txt", "c:mine.toml"] {
            assert!(file_name(name).is_err(), "{name}");
        }
    }

    /// A rig file under version control, linked into the folder, private, from an editor of another system.
    #[cfg(unix)]
    #[test]
    fn a_rig_file_keeps_its_link_its_mode_its_mark_and_its_line_breaks() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().expect("a folder");
        let (kept, link) = (folder.path().join("kept.toml"), folder.path().join("mine.toml"));
        fs::write(&kept, "\u{feff}[load]\r\nmass_kg = 1.0 # weighed\r\n").expect("written");
        fs::set_permissions(&kept, fs::Permissions::from_mode(0o600)).expect("a mode");
        symlink("kept.toml", &link).expect("a link");
        let text = "[load]\r\nmass_kg = 1.0 # weighed\r\n";
        let files = Files::new(Opened { name: link.display().to_string(), text: text.to_owned() });
        let settings = ["load.mass_kg=2.0".to_owned()];
        let new = pneudrive_records::rig_text::with_settings(text, &settings, "given: set in the studio");
        assert!(files.save("mine.toml", &new.expect("TOML"), false).is_ok());
        let saved = fs::read_to_string(&kept).expect("there");
        let line = "mass_kg = 2.0  # given: set in the studio; before: weighed";
        assert_eq!(saved, format!("\u{feff}[load]\r\n{line}\r\n"));
        assert!(fs::symlink_metadata(&link).expect("there").is_symlink());
        assert_eq!(fs::metadata(&kept).expect("there").permissions().mode() & 0o777, 0o600);
        fs::write(&kept, "changed by another program").expect("written");
        assert!(files.save("mine.toml", text, false).is_err());
    }
}
