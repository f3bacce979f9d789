//! The controller's parameters on a rig, also with firmware that has fewer of them.

use anyhow::{Result, anyhow, bail};
use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::{TABLE, id};
use pneudrive_protocol::{MAX_VALUES, ReplyBody, RequestBody, RequestRefusal, Values};
use pneudrive_records::parameter_names::{Written, name_of};
use pneudrive_records::rig_info::RigParameters;

use super::Client;
use super::answer::{refusal, unexpected};
use super::change::Change;

/// How often parameters are read if they change meanwhile.
const TRIES: u32 = 3;

impl Client {
    /// All parameters of the controller, as they were in force at one time.
    ///
    /// # Errors
    /// When the rig does not answer, has a value out of this program's range, or another program keeps changing them.
    pub fn parameters(&mut self) -> Result<RigParameters> {
        let mut before = self.config_state()?.hash;
        for _ in 0..TRIES {
            let read = self.read_blocks()?;
            let after = self.config_state()?.hash;
            if before == after {
                self.known = Some((after, read.clone()));
                return Ok(read);
            }
            before = after;
        }
        bail!("{}: its parameters change while they are read; is another program using the rig?", self.name)
    }

    /// All but the gain profile, as they are in force. Another program may change them while they are read.
    ///
    /// # Errors
    /// When the rig does not answer, or has a value out of this program's range.
    pub fn scalars(&mut self) -> Result<RigParameters> {
        let mut read = RigParameters::default();
        for (first_id, count) in blocks().filter(|(first_id, _)| *first_id < id::GAIN_PROFILE) {
            self.read_block(first_id, first_id + u16::from(count), &mut read)?;
        }
        Ok(read)
    }

    fn read_blocks(&mut self) -> Result<RigParameters> {
        let mut read = RigParameters::default();
        for (first_id, count) in blocks() {
            self.read_block(first_id, first_id + u16::from(count), &mut read)?;
        }
        Ok(read)
    }

    /// Parameters of consecutive ids. A refusal names the first id that the firmware does not have; those
    /// before it are asked for, and then those behind it.
    fn read_block(&mut self, first: u16, end: u16, into: &mut RigParameters) -> Result<()> {
        let (mut at, mut until) = (first, end);
        while at < end {
            match self.read_values(at, until)? {
                Ok(values) => {
                    for (id, value) in (at..).zip(values) {
                        into.values.set(id, value).map_err(|_| {
                            let name = name_of(id);
                            anyhow!("{} has {value} for {name}, which is out of range here", self.name)
                        })?;
                    }
                    (at, until) = (until, end);
                }
                Err(unknown) if unknown == at => {
                    into.lacking.push(at);
                    (at, until) = (at + 1, end);
                }
                Err(unknown) if at < unknown && unknown < until => until = unknown,
                Err(unknown) => {
                    return Err(refusal(&self.name, &RequestRefusal::UnknownParameter { id: unknown }));
                }
            }
        }
        Ok(())
    }

    /// The values of these ids, or the first id that the firmware does not have.
    fn read_values(&mut self, first_id: u16, end: u16) -> Result<Result<Vec<i32>, u16>> {
        let count = end - first_id;
        let name = self.name.clone();
        self.ask_for_any(RequestBody::ConfigGet { first_id, count: count as u8 }, |reply| match reply {
            ReplyBody::Config { values, .. } if values.len() == usize::from(count) => {
                Ok(Ok(values.iter().collect()))
            }
            ReplyBody::Refused(RequestRefusal::UnknownParameter { id }) => Ok(Err(*id)),
            ReplyBody::Refused(refused) => Err(refusal(&name, refused)),
            other => Err(unexpected(other)),
        })
    }

    /// Whether the rig has pressure sensors.
    ///
    /// # Errors
    /// When the rig does not answer.
    pub fn measures_pressures(&mut self) -> Result<bool> {
        let read = self.read_values(id::PRESSURE_SENSORS, id::PRESSURE_SENSORS + 1)?;
        Ok(read.map_or(true, |values| values != [0]))
    }

    /// Changes parameters with consecutive ids: all of them or none.
    ///
    /// # Errors
    /// When a value is refused, or the drive is not disarmed.
    pub fn set_parameters(&mut self, first_id: u16, values: &[i32]) -> Result<()> {
        let mut room = [0; 4 * MAX_VALUES];
        let values = Values::fill(&mut room, values.iter().copied())
            .ok_or_else(|| anyhow!("more than {MAX_VALUES} values at once"))?;
        (self.known, self.meant) = (None, None);
        self.ask_done(RequestBody::ConfigSet { first_id, values })
    }

    /// Changes these parameters, ids and values, and no others: all of them or none. Without any the rig is not asked.
    ///
    /// # Errors
    /// When a value is refused, or the drive is not disarmed.
    pub fn change_parameters(&mut self, values: &[(u16, i32)]) -> Result<()> {
        if values.is_empty() {
            return Ok(());
        }
        let mut change = Change::default();
        for run in values.chunk_by(|(before, _), (next, _)| before + 1 == *next) {
            let values: Vec<i32> = run.iter().map(|(_, value)| *value).collect();
            change.add_parameters(run[0].0, &values);
        }
        self.meant = None;
        self.take(&change)
    }

    /// Downloads all parameters that the firmware has, and returns the names of the others, which have their defaults
    /// there. All of them are applied or none.
    ///
    /// # Errors
    /// When one is refused, or the drive is not disarmed; before anything is changed, when the firmware lacks a parameter
    /// whose value is not the default.
    pub fn import_parameters(&mut self, parameters: &Parameters) -> Result<Vec<&'static str>> {
        let mut change = Change::default();
        let lacking = self.add_those_it_has(parameters, &mut change)?;
        self.take(&change).map(|()| lacking)
    }

    /// Adds the parameters that the firmware has to a change, and returns the names of the others.
    pub(super) fn add_those_it_has(
        &mut self,
        parameters: &Parameters,
        change: &mut Change,
    ) -> Result<Vec<&'static str>> {
        let on_rig = self.parameters()?;
        self.refuse_to_leave_out(&on_rig, parameters)?;
        for (first_id, values) in runs(&on_rig, parameters) {
            change.add_parameters(first_id, &values);
        }
        Ok(on_rig.lacking_names())
    }

    fn refuse_to_leave_out(&self, on_rig: &RigParameters, parameters: &Parameters) -> Result<()> {
        let default = Parameters::default();
        let wanted = on_rig.lacking.iter().find(|&&id| parameters.get(id) != default.get(id));
        let Some(&id) = wanted else { return Ok(()) };
        let text = |of: &Parameters| {
            let value = of.get(id).unwrap_or(0);
            Written::of(id).map_or_else(|| value.to_string(), |written| written.text(value))
        };
        bail!(
            "{}: its firmware has no parameter {}, which should be {} (default {}); flash newer firmware, or keep the default",
            self.name,
            name_of(id),
            text(parameters),
            text(&default)
        )
    }
}

/// First ids and values of the parameters that a rig has.
fn runs(on_rig: &RigParameters, parameters: &Parameters) -> Vec<(u16, Vec<i32>)> {
    let ids = blocks().map(|(first_id, count)| (first_id..first_id + u16::from(count)).collect());
    let has = |ids: Vec<u16>| -> Vec<Vec<u16>> {
        ids.split(|id| on_rig.lacking.contains(id)).map(<[u16]>::to_vec).collect()
    };
    let runs = ids.flat_map(has).filter(|run| !run.is_empty());
    runs.map(|run| (run[0], run.iter().filter_map(|&id| parameters.get(id)).collect())).collect()
}

/// First id and length of the blocks in which all parameters are read and written.
fn blocks() -> impl Iterator<Item = (u16, u8)> {
    let scalars = TABLE.iter().filter(|p| p.len == 1).count() as u16;
    let runs = std::iter::once((TABLE[0].id, scalars))
        .chain(TABLE.iter().filter(|p| p.len > 1).map(|p| (p.id, p.len)));
    runs.flat_map(|(first, len)| {
        (0..len).step_by(MAX_VALUES).map(move |at| (first + at, (len - at).min(MAX_VALUES as u16) as u8))
    })
}
