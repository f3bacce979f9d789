//! The part of a drive in an FMU, and its rig.

use anyhow::{Result, bail};
use pneudrive_protocol::frame::crc32;
use pneudrive_sim::Rig;
use pneudrive_sim::component::controller::ControllerKind;
use pneudrive_sim::gain_bug;
use pneudrive_sim::keys;

/// A part of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Valve, tubes, cylinder, load and sensors.
    Plant,
    /// The controller, bit for bit the firmware's.
    Controller,
    /// Both.
    Drive,
}

impl Part {
    /// All of them.
    pub const ALL: [Part; 3] = [Part::Plant, Part::Controller, Part::Drive];

    /// Its word.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Part::Plant => "plant",
            Part::Controller => "controller",
            Part::Drive => "drive",
        }
    }

    /// Whether it has the plant in it.
    #[must_use]
    pub(crate) fn has_plant(self) -> bool {
        self != Part::Controller
    }

    /// Whether it has the controller in it.
    #[must_use]
    pub(crate) fn has_controller(self) -> bool {
        self != Part::Plant
    }

    /// The name of the library in modelDescription.xml: the name of its file.
    #[must_use]
    pub(crate) fn identifier(self) -> String {
        format!("pneudrive_{}", self.word())
    }

    /// Whether an FMU of this part can be made of a rig.
    ///
    /// # Errors
    /// For features of `pneudrive simulate` that the firmware lacks: the continuous controller, the historical bug.
    pub fn check(self, rig: &Rig) -> Result<()> {
        if rig.get(&keys::controller::MODEL) == ControllerKind::Continuous {
            bail!(
                "the continuous controller is the simulator's own and has no samples; write controller.model = \"sampled\""
            );
        }
        if self.has_controller()
            && let Some(bug) = gain_bug::named(rig)
        {
            bail!(
                "{bug} is a bug that the simulator adds to the controller, and no firmware has; take it out"
            );
        }
        Ok(())
    }

    /// The token of an FMU of this part with this rig file.
    #[must_use]
    pub fn token(self, rig_text: &str) -> String {
        format!("pneudrive {} {} {:08x}", env!("CARGO_PKG_VERSION"), self.word(), crc32(rig_text.as_bytes()))
    }

    /// The part that a token is of, if it goes with the rig file beside it.
    ///
    /// # Errors
    /// When the token is of another library, or of another rig file.
    pub(crate) fn of_token(token: &str, rig_text: &str) -> Result<Part> {
        let named = Part::ALL.into_iter().find(|part| token.split(' ').nth(2) == Some(part.word()));
        match named {
            Some(part) if part.token(rig_text) == token => Ok(part),
            Some(part) => bail!(
                "the instantiation token is {token:?}, but library and resources/rig.toml make {:?}: the FMU was changed by hand; export it again",
                part.token(rig_text)
            ),
            None => bail!("the instantiation token {token:?} is not of this FMU"),
        }
    }
}
