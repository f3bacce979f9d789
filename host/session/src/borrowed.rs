//! Parameters that a program changes on a drive for a while. A file keeps their values until they are given back, so
//! a killed program cannot lose them: the next program that borrows gives them back first.
//!
//! ```text
//! borrow      PORT.borrowed   in the user's folder of states: the program, the boot of the drive, and all parameters as they were
//! give back   the values are set, then the file is removed
//! ```
//!
//! The file is ignored and removed if the drive was reset since, because a reset brings its saved parameters back.
//! The same happens if other parameters differ from those in the file: then somebody has set them since, or another
//! drive is at the port. Parameters that a running program has borrowed are not given back by another one.

use std::fmt::Write;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail};
use pneudrive_controller::parameters::is_learned;
use pneudrive_link::client::Client;
use pneudrive_link::failure::Failure;
use pneudrive_records::parameter_names::Written;
use pneudrive_records::rig_info::RigParameters;
use pneudrive_records::whole_file::{may_run, own_number, put};

use crate::state;

/// The first line of a file of this kind.
const HEAD: &str = "pneudrive-borrowed 1";

/// The last line of it.
const LAST: &str = "end";

/// The ending of its name.
const KIND: &str = "borrowed";

/// The longest file that is read, bytes: all parameters have some kilobytes.
const LONGEST: u64 = 1 << 16;

/// Parameters to give back.
#[derive(Debug)]
pub struct Borrowed {
    path: PathBuf,
    values: Vec<(u16, i32)>,
}

impl Borrowed {
    /// Keeps the values of these parameters before they are changed for a while. First gives back those that a killed
    /// program has left. The drive must be disarmed.
    ///
    /// # Errors
    /// When the drive does not answer or refuses, or the file cannot be written.
    pub fn of(client: &mut Client, ids: &[u16]) -> Result<Borrowed> {
        let path = state::file(client.port_name(), KIND)?;
        give_back_of_killed(client, &path)?;
        let parameters = client.parameters()?;
        let has = |id: &u16| !parameters.lacking.contains(id);
        let value = |id: u16| parameters.values.get(id).map(|value| (id, value));
        let values = ids.iter().filter(|id| has(id)).filter_map(|&id| value(id)).collect();
        let folder = path.parent().unwrap_or(&path);
        fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
        let borrowed = Borrowed { path, values };
        put(&borrowed.path, &borrowed.text(client.boot(), &parameters)).context(
            "what the drive has to get back cannot be kept; PNEUDRIVE_STATE names another folder for it",
        )?;
        Ok(borrowed)
    }

    /// Disarms the drive and gives back what was borrowed, whatever has become of the work that it was borrowed for.
    ///
    /// # Errors
    /// That of the work; or when the drive does not answer or refuses. The file stays then, and the next program that borrows
    /// gives it back.
    pub fn end<T>(self, client: &mut Client, done: Result<T>) -> Result<T> {
        let left = client.disarm().and_then(|()| self.give_back(client));
        let done = done?;
        left.context("the work is done, but the drive could not be disarmed and get back what was borrowed")?;
        Ok(done)
    }

    /// Sets the parameters as they were, on a drive that is disarmed.
    fn give_back(self, client: &mut Client) -> Result<()> {
        for (id, value) in &self.values {
            client.set_parameters(*id, &[*value])?;
        }
        remove(&self.path)
    }

    fn text(&self, boot: u32, parameters: &RigParameters) -> String {
        let mut text = format!("{HEAD}\nprogram {}\nboot {boot}\n", own_number());
        for (id, _) in &self.values {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "borrowed {id}");
        }
        for (id, value) in parameters.values.iter().filter(|(id, _)| !parameters.lacking.contains(id)) {
            let _ = writeln!(text, "{id} {value}");
        }
        text + LAST + "\n"
    }
}

/// Borrows parameters of a disarmed drive for some work; afterwards it is disarmed and has them back.
///
/// # Errors
/// As for [`Borrowed::of`] and [`Borrowed::end`].
pub fn lend<T>(client: &mut Client, ids: &[u16], work: impl FnOnce(&mut Client) -> Result<T>) -> Result<T> {
    let borrowed = Borrowed::of(client, ids)?;
    let done = work(client);
    borrowed.end(client, done)
}

/// What a killed program has left.
#[derive(Debug, Default, PartialEq, Eq)]
struct Unreturned {
    program: u32,
    boot: u32,
    borrowed: Vec<u16>,
    all: Vec<(u16, i32)>,
}

impl Unreturned {
    /// Reads the text of [`Borrowed::text`]; None for any other text.
    fn read(text: &str) -> Option<Unreturned> {
        let mut lines = text.lines();
        if lines.next()? != HEAD {
            return None;
        }
        let program = lines.next()?.strip_prefix("program ")?.parse().ok()?;
        let boot = lines.next()?.strip_prefix("boot ")?.parse().ok()?;
        let mut left = Unreturned { program, boot, ..Unreturned::default() };
        for line in &mut lines {
            if line == LAST {
                return lines.next().is_none().then_some(left);
            }
            let (name, value) = line.split_once(' ')?;
            match name {
                "borrowed" => left.borrowed.push(value.parse().ok()?),
                id => left.all.push((id.parse().ok()?, value.parse().ok()?)),
            }
        }
        None
    }

    /// Whether the drive with these parameters is still in the same boot. A rig that does not count boots may have
    /// been reset.
    fn is_in_force(&self, boot: u32) -> bool {
        self.boot != 0 && self.boot == boot
    }

    /// The values of the drive in place of the borrowed ones.
    fn differing(&self, there: &RigParameters) -> Vec<(u16, i32)> {
        self.values().filter(|(id, value)| there.values.get(*id) != Some(*value)).collect()
    }

    /// Whether a drive with these parameters is the one whose program was killed: they are equal, except for the
    /// borrowed ones and what a run has learned.
    fn is_of(&self, parameters: &RigParameters) -> bool {
        let may_differ = |id| is_learned(id) || self.borrowed.contains(&id);
        self.all.iter().all(|&(id, value)| may_differ(id) || parameters.values.get(id) == Some(value))
    }

    fn values(&self) -> impl Iterator<Item = (u16, i32)> + '_ {
        self.all.iter().copied().filter(|(id, _)| self.borrowed.contains(id))
    }
}

/// Gives back the parameters that a killed program has left.
fn give_back_of_killed(client: &mut Client, path: &Path) -> Result<()> {
    let Some(left) = left_at(path)? else { return Ok(()) };
    if left.program != own_number() && may_run(left.program, path) {
        return Err(Failure::Refused.error(format!(
            "another program (process {}) tests the drive at this port; wait for its end",
            left.program
        )));
    }
    let there = client.parameters()?;
    if left.is_in_force(client.boot()) {
        let is_of = left.is_of(&there);
        for (id, value) in left.differing(&there) {
            if is_of {
                client.set_parameters(id, &[value])?;
                log::info!(
                    "a killed program left a setting of its tests on the drive; restored {}",
                    named(id, value)
                );
            } else {
                log::warn!(
                    "a killed program may have left a setting of its tests on the drive, which had {} before. Other parameters have changed since, so it stays: set it with `pneudrive device config` if that is meant",
                    named(id, value)
                );
            }
        }
    }
    remove(path)
}

/// A parameter with its value.
fn named(id: u16, value: i32) -> String {
    Written::of(id).map_or_else(String::new, |written| format!("{} = {}", written.name, written.text(value)))
}

fn left_at(path: &Path) -> Result<Option<Unreturned>> {
    let about = match fs::symlink_metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        about => about.with_context(|| format!("cannot read {}", path.display()))?,
    };
    if !about.is_file() || about.len() > LONGEST {
        bail!("{} is not a file of this program; remove it", path.display());
    }
    let text = fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    let left = Unreturned::read(&text);
    left.map(Some).ok_or_else(|| {
        anyhow!("{} is damaged; remove it, and look at controller.loop of the drive", path.display())
    })
}

fn remove(path: &Path) -> Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => {
            Err(error).with_context(|| format!("cannot remove {}", path.display()))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use pneudrive_controller::parameters::id;

    use super::*;

    #[test]
    fn what_was_kept_is_read_again_and_no_other_text_is() {
        let values = vec![(id::OPEN_LOOP, 0)];
        let parameters = RigParameters::default();
        let text = Borrowed { path: PathBuf::new(), values }.text(7, &parameters);
        let left = Unreturned::read(&text).expect("it is one");
        assert_eq!((left.boot, &left.borrowed), (7, &vec![id::OPEN_LOOP]));
        assert_eq!(left.all.len(), parameters.values.iter().count());
        for damaged in [
            "",
            "pneudrive-borrowed 2\nprogram 1\nboot 1\nend\n",
            "pneudrive-borrowed 1\nprogram 1\nboot x\nend\n",
        ] {
            assert_eq!(Unreturned::read(damaged), None, "{damaged}");
        }
        for cut in 0..text.len() - 1 {
            assert_eq!(Unreturned::read(&text[..cut]), None, "cut behind {cut} bytes");
        }
    }

    #[test]
    fn it_is_for_a_drive_whose_other_parameters_are_the_same_but_for_what_was_learned() {
        let parameters = RigParameters::default();
        let left = Unreturned {
            program: 1,
            boot: 1,
            borrowed: vec![id::OPEN_LOOP],
            all: parameters.values.iter().collect(),
        };
        let with = |id, value| {
            let mut other = RigParameters::default();
            other.values.set(id, value).expect("in range");
            other
        };
        assert!(left.is_of(&parameters));
        assert!(left.is_of(&with(id::OPEN_LOOP, 1)) && left.is_of(&with(id::NULL_OFFSET_COUNTS, 5)));
        assert!(left.is_of(&with(id::KEPT_MASS, 70_000)));
        assert!(!left.is_of(&with(id::PERIOD_US, 2000)), "somebody has set it since");
        assert_eq!(left.differing(&with(id::OPEN_LOOP, 1)), [(id::OPEN_LOOP, 0)]);
        assert!(left.is_in_force(1) && !left.is_in_force(2));
        assert!(!Unreturned { boot: 0, ..left }.is_in_force(0), "it does not count boots");
    }

    #[test]
    fn each_port_has_a_file_of_its_own_and_leads_nowhere_else() {
        let name = |port| state::file_name(port, KIND);
        assert_eq!(name("tcp://127.0.0.1:4000"), "tcp___127.0.0.1_4000.borrowed");
        assert!(!name("pty:/dev/../x").contains('/'));
    }
}
