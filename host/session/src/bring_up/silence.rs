//! What it means that something does not answer at all.

/// What has answered, apart from the pressures.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answered {
    /// The encoder counted.
    pub counts: bool,
    /// The spool transducer showed it.
    pub spool: bool,
    /// The encoder counted as a hand pushed the slide.
    pub by_hand: bool,
}

impl Answered {
    /// What is silent, in words; None where enough has answered to compare signs.
    pub fn silence(self, pressures: bool) -> Option<&'static str> {
        match (self.counts, pressures, self.spool) {
            (true, true, _) => None,
            (true, false, _) => Some(
                "the slide moves, but the pressures do not change: the transmitters are not at the chambers, or their wires are off",
            ),
            (false, true, _) if self.by_hand => Some(
                "the pressures change, but the slide stands, and the encoder counted by hand: the slide is blocked, or at its stop, or the pulses are too small (--most)",
            ),
            (false, true, _) => Some(
                "the pressures change, but the encoder does not count: check its supply, its line receiver, the wires of tracks A and B and the pull-up of each (a track that does not switch counts to and fro by one)",
            ),
            (false, false, true) => Some(
                "the spool moves, but neither pressures nor slide: the air is off, or the tubes are blocked",
            ),
            (false, false, false) => Some(
                "nothing answers the command: drive_enable does not reach the amplifier, the amplifier has no supply, the wire of the valve command is off, or the air is off",
            ),
        }
    }

    /// The same of a drive without pressure sensors: a dead encoder and air that is off look alike.
    pub fn silence_without_pressures(self) -> Option<&'static str> {
        match (self.counts, self.spool, self.by_hand) {
            (true, ..) => None,
            (false, true, true) => Some(
                "the spool moves, but the slide stands, and the encoder counted by hand: the air is off, the tubes are blocked, the slide is blocked or at its stop, or the pulses are too small (--most)",
            ),
            (false, true, false) => Some(
                "the spool moves, but the encoder does not count. Without pressure sensors this may be the encoder (its supply, its line receiver, the wires of tracks A and B and the pull-up of each), air that is off, or blocked tubes; a push by hand tells whether the encoder counts",
            ),
            (false, false, true) => Some(
                "nothing answers the command, and the encoder counted by hand: drive_enable does not reach the amplifier, the amplifier has no supply, the wire of the valve command is off, the air is off, or the slide is blocked",
            ),
            (false, false, false) => Some(
                "nothing answers the command: drive_enable does not reach the amplifier, the amplifier has no supply, the wire of the valve command is off, the air is off, or the encoder does not count (its supply, its line receiver, the wires of tracks A and B and the pull-up of each); a push by hand tells whether it counts",
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Answered; 8] = {
        let mut all = [Answered { counts: false, spool: false, by_hand: false }; 8];
        let mut bits = 0;
        while bits < 8 {
            all[bits] = Answered { counts: bits & 1 != 0, spool: bits & 2 != 0, by_hand: bits & 4 != 0 };
            bits += 1;
        }
        all
    };

    #[test]
    fn without_pressure_sensors_no_pressure_is_said_to_have_changed_or_not() {
        for answered in ALL {
            let said = answered.silence_without_pressures();
            assert_eq!(said.is_none(), answered.counts, "{answered:?}");
            assert!(!said.is_some_and(|said| said.contains("pressures")), "{answered:?}: {said:?}");
        }
    }

    #[test]
    fn an_encoder_that_counted_by_hand_is_not_suspected() {
        for answered in ALL.into_iter().filter(|answered| answered.by_hand && !answered.counts) {
            let said = [answered.silence(true), answered.silence_without_pressures()];
            assert!(said.iter().flatten().all(|said| !said.contains("line receiver")), "{answered:?}");
        }
    }
}
