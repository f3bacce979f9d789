//! Atomic changes of parameters and test, and the start request that names them.

use anyhow::{Result, bail};
use pneudrive_app::moves::told;
use pneudrive_controller::parameters::is_learned;
use pneudrive_controller::{Parameters, Profile, Sequence};
use pneudrive_protocol::change::{Entry, PART_BYTES, start_crc32, test_crc32};
use pneudrive_protocol::{MAX_VALUES, ReplyBody, RequestBody, RequestRefusal, Values, frame};
use pneudrive_records::rig_info::RigParameters;
use pneudrive_sim::Rig;
use pneudrive_sim::keys;

use super::Client;
use super::answer::{refusal, unexpected};
use crate::failure::Failure;

/// How often a change is sent when the rig has lost a part of it.
const TRIES: u32 = 3;

/// The bytes of a change.
#[derive(Clone, Debug, Default)]
pub(super) struct Change(Vec<u8>);

impl Change {
    /// Adds an entry.
    pub(super) fn add(&mut self, entry: &Entry<'_>) {
        let mut room = [0; PART_BYTES];
        let bytes =
            entry.write(&mut room).expect("names are short, and values no more than a message carries");
        self.0.extend_from_slice(bytes);
    }

    /// Adds parameters of consecutive ids.
    pub(super) fn add_parameters(&mut self, first_id: u16, values: &[i32]) {
        for (block, values) in values.chunks(MAX_VALUES).enumerate() {
            let mut room = [0; 4 * MAX_VALUES];
            let values = Values::fill(&mut room, values.iter().copied()).expect("a block");
            self.add(&Entry::Parameters { first_id: first_id + (block * MAX_VALUES) as u16, values });
        }
    }

    /// Adds the test of a rig, ending with this sample.
    fn add_test(&mut self, rig: &Rig, last_sample: u32) {
        let sequence = rig.sequence();
        self.add(&Entry::Test {
            name: short(rig.name()),
            last_sample,
            round: sequence.round(),
            decimation: rig.get(&keys::test::DECIMATION) as u16,
            pre_trigger: rig.get(&keys::test::PRE_TRIGGER) as u16,
        });
        self.add_moves(&sequence);
    }

    fn add_moves(&mut self, sequence: &Sequence) {
        for next in sequence.moves() {
            match next.profile {
                Profile::Step => self.add(&Entry::Move { at_sample: next.at_sample, target: next.target }),
                _ => self.add(&Entry::Profile { bytes: &told(next).to_bytes() }),
            }
        }
    }
}

impl Client {
    /// Downloads the test of a rig.
    ///
    /// # Errors
    /// When it is refused, or the drive is not disarmed.
    pub fn download_test(&mut self, rig: &Rig) -> Result<()> {
        self.prepare(rig, rig.last_sample(), None).map(drop)
    }

    /// The same, but it ends with another sample (with [`UNTIL_STOPPED`](pneudrive_protocol::UNTIL_STOPPED), once it is
    /// stopped), and parameters are downloaded with it. Returns the names of those that the firmware does not have, as
    /// [`Client::import_parameters`] does.
    ///
    /// # Errors
    /// When it is refused, or the drive is not disarmed. Nothing is changed then.
    pub fn prepare(
        &mut self,
        rig: &Rig,
        last_sample: u32,
        parameters: Option<&Parameters>,
    ) -> Result<Vec<&'static str>> {
        self.last_sample = Some(last_sample);
        // For a test without parameters: those of the rig as this program last read them.
        self.meant = self.known.take().map(|(_, parameters)| parameters);
        let mut change = Change::default();
        let lacking = match parameters {
            Some(parameters) => self.add_those_it_has(parameters, &mut change)?,
            None => Vec::new(),
        };
        change.add_test(rig, last_sample);
        self.take(&change)?;
        if let Some(parameters) = parameters {
            self.meant = Some(RigParameters { values: parameters.clone(), lacking: Vec::new() });
        }
        self.test_crc32 = Some(test_crc32(&change.0));
        Ok(lacking)
    }

    /// Downloads a test that belongs to no rig file: its moves, every Nth sample of which is recorded from the start on.
    ///
    /// # Errors
    /// When it is refused, or the drive is not disarmed.
    pub fn prepare_moves(&mut self, name: &str, sequence: &Sequence, decimation: u16) -> Result<()> {
        let last_sample = sequence.duration_samples;
        let mut change = Change::default();
        let (round, pre_trigger) = (sequence.round(), 0);
        change.add(&Entry::Test { name: short(name), last_sample, round, decimation, pre_trigger });
        change.add_moves(sequence);
        self.last_sample = Some(last_sample);
        self.meant = self.known.take().map(|(_, parameters)| parameters);
        self.take(&change)?;
        self.test_crc32 = Some(test_crc32(&change.0));
        Ok(())
    }

    /// Makes the rig apply a change as a whole.
    pub(super) fn take(&mut self, change: &Change) -> Result<()> {
        self.known = None;
        for _ in 0..TRIES {
            if self.send_and_take(&change.0)? {
                return Ok(());
            }
        }
        bail!("{}: parts of a change were lost repeatedly; is another program using the port?", self.name)
    }

    /// False when the rig has lost a part.
    fn send_and_take(&mut self, bytes: &[u8]) -> Result<bool> {
        let crc32 = frame::crc32(bytes);
        for (index, part) in bytes.chunks(PART_BYTES).enumerate() {
            let first = (index * PART_BYTES) as u16;
            if !self.done_or_not_whole(RequestBody::ChangePart { crc32, first, part })? {
                return Ok(false);
            }
        }
        self.done_or_not_whole(RequestBody::ChangeTake { crc32 })
    }

    fn done_or_not_whole(&mut self, body: RequestBody<'_>) -> Result<bool> {
        let name = self.name.clone();
        self.ask_for_any(body, |reply| match reply {
            ReplyBody::Done => Ok(true),
            ReplyBody::Refused(RequestRefusal::ChangeNotWhole) => Ok(false),
            ReplyBody::Refused(refused) => Err(refusal(&name, refused)),
            other => Err(unexpected(other)),
        })
    }

    /// Starts the test that this client has downloaded. The parameters in force must be those downloaded with it or, without
    /// such, those read before; and those read since, if any.
    ///
    /// # Errors
    /// When it is refused or not answered; also when another program has changed the test or the parameters since.
    pub fn start(&mut self) -> Result<()> {
        // Without a test of its own it names none that a rig could have.
        let test = self.test_crc32.unwrap_or(0);
        // The drive is armed: its parameters can no longer change.
        let parameters = self.config_state()?.hash;
        let read_since = self.known.take_if(|(hash, _)| *hash != parameters).map(|(_, read)| read);
        for expected in [self.meant.take(), read_since].into_iter().flatten() {
            self.refuse_others_parameters(&expected, parameters)?;
        }
        self.ask_done(RequestBody::Start { crc32: start_crc32(test, parameters) })
    }

    /// Refuses to start if the parameters in force, which have this fingerprint, differ from the expected ones.
    fn refuse_others_parameters(&mut self, expected: &RigParameters, hash: u32) -> Result<()> {
        let now = match &self.known {
            Some((known, read)) if *known == hash => read.clone(),
            _ => self.parameters()?,
        };
        if !are_the_same_but_for_what_was_learned(expected, &now) {
            return Err(Failure::Refused
                .error(format!("{}: another program has changed its parameters; run again", self.name)));
        }
        Ok(())
    }
}

/// Compares all but what arming makes of what the last run has learned.
fn are_the_same_but_for_what_was_learned(before: &RigParameters, now: &RigParameters) -> bool {
    let differs = |(was, is): ((u16, i32), (u16, i32))| was.1 != is.1 && !is_learned(was.0);
    !before.values.iter().zip(now.values.iter()).any(differs)
}

/// A name short enough for every message.
fn short(name: &str) -> &str {
    let end = (0..=name.len().min(pneudrive_app::control::NAME_BYTES))
        .rev()
        .find(|&end| name.is_char_boundary(end));
    &name[..end.unwrap_or(0)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneudrive_controller::sequencer::MAX_MOVES;
    use pneudrive_protocol::ProfiledMove;
    use pneudrive_protocol::change::{Entries, MAX_CHANGE};

    #[test]
    fn all_parameters_and_the_longest_test_fit_in_a_change() {
        let mut change = Change::default();
        let ids: Vec<u16> = Parameters::default().iter().map(|(id, _)| id).collect();
        for run in ids.chunk_by(|a, b| a + 1 == *b) {
            change.add_parameters(run[0], &vec![i32::MIN; run.len()]);
        }
        let name = "n".repeat(pneudrive_app::control::NAME_BYTES);
        let (last_sample, round) = (u32::MAX, u32::MAX);
        let (decimation, pre_trigger) = (u16::MAX, u16::MAX);
        change.add(&Entry::Test { name: &name, last_sample, round, decimation, pre_trigger });
        let longest = Entry::Profile { bytes: &[0xff; ProfiledMove::BYTES] };
        for _ in 0..MAX_MOVES {
            change.add(&longest);
        }
        assert!(change.0.len() <= MAX_CHANGE, "{} of {MAX_CHANGE} bytes", change.0.len());
        assert!(Entries::of(&change.0).all(|entry| entry.is_ok()));
    }
}
