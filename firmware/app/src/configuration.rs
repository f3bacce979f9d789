//! The parameters in force, what the law runs on, and where both come from.

use pneudrive_controller::config::ConfigError;
use pneudrive_controller::{Config, Parameters};

use crate::storage::{Load, Outcome, configuration_hash};
use crate::store::{NotStored, Store};

/// Where the parameters come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Source {
    /// None were ever stored: the thesis's, or what was set since.
    #[default]
    NeverSaved,
    /// As stored.
    Stored,
    /// Stored by another version of the firmware, and taken over.
    TakenOver,
    /// What was stored is damaged, or does not go together.
    Damaged,
}

/// The configuration of the drive. By default the thesis's.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Configuration {
    parameters: Parameters,
    config: Config,
    source: Source,
    /// Saves so far, and the fingerprint of what was saved last.
    saves: u32,
    saved_hash: Option<u32>,
    ignored: u16,
    /// What was learned since is to be stored once the drive rests.
    learned: bool,
}

impl Configuration {
    /// Takes up what is stored, after a reset. False when it is lost: the thesis's parameters are in force
    /// then, and the drive must not run on them.
    pub fn take_up(&mut self, store: &mut impl Store) -> bool {
        let Load { parameters, outcome } = store.load();
        let report = match outcome {
            Outcome::NeverSaved => return true,
            Outcome::Damaged | Outcome::UnknownFormat(_) => None,
            Outcome::Loaded(report) => Some(report),
        };
        let Some((report, config)) = report.zip(Config::new(&parameters).ok()) else {
            self.source = Source::Damaged;
            return false;
        };
        self.ignored = report.unknown.saturating_add(report.out_of_range);
        let as_stored = self.ignored == 0 && report.missing == 0;
        self.source = if as_stored { Source::Stored } else { Source::TakenOver };
        self.saves = report.generation;
        self.saved_hash = as_stored.then(|| configuration_hash(&parameters));
        (self.parameters, self.config) = (parameters, config);
        true
    }

    /// Takes other parameters.
    ///
    /// # Errors
    /// When they do not go together; nothing is changed then.
    pub fn replace(&mut self, parameters: Parameters) -> Result<(), ConfigError> {
        self.config = Config::new(&parameters)?;
        self.parameters = parameters;
        self.learned = false;
        Ok(())
    }

    /// Takes parameters that the drive has learned. Where those before them were stored, these will be, too
    /// ([`Configuration::save_learned`]).
    ///
    /// # Errors
    /// When they do not go together; nothing is changed then.
    pub fn learn(&mut self, parameters: Parameters) -> Result<(), ConfigError> {
        let learned = self.learned || self.is_saved();
        self.replace(parameters)?;
        self.learned = learned;
        Ok(())
    }

    /// Stores what was learned since the last save, if anything. It is tried once: what cannot be stored is learned
    /// again after the next reset.
    ///
    /// # Errors
    /// As for [`Configuration::save`].
    pub fn save_learned(&mut self, store: &mut impl Store) -> Result<(), NotStored> {
        if core::mem::take(&mut self.learned) { self.save(store) } else { Ok(()) }
    }

    /// Stores the parameters for the next reset.
    ///
    /// # Errors
    /// When they are not stored; what was stored before is whole then.
    pub fn save(&mut self, store: &mut impl Store) -> Result<(), NotStored> {
        self.saves = store.save(&self.parameters)?;
        self.saved_hash = Some(self.hash());
        self.learned = false;
        self.source = Source::Stored;
        self.ignored = 0;
        Ok(())
    }

    /// Whether what was stored is lost, and nothing was stored since.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        self.source == Source::Damaged
    }

    /// Whether the parameters are those that the next reset will take up.
    #[must_use]
    pub fn is_saved(&self) -> bool {
        self.saved_hash == Some(self.hash())
    }

    /// The parameters, by id.
    #[must_use]
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// What the law runs on.
    #[must_use]
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// Where the parameters come from.
    #[must_use]
    pub fn source(&self) -> Source {
        self.source
    }

    /// How often they were saved, wrapping.
    #[must_use]
    pub fn saves(&self) -> u32 {
        self.saves
    }

    /// Stored values that were ignored: ids or values that this firmware does not know.
    #[must_use]
    pub fn ignored(&self) -> u16 {
        self.ignored
    }

    /// The fingerprint of the parameters in force.
    #[must_use]
    pub fn hash(&self) -> u32 {
        configuration_hash(&self.parameters)
    }
}
