//! Which wires are swapped, from the signs of the answers to a command.
//!
//! Let V be the wires of the valve command, T the tubes, E the encoder's tracks, P the two pressure transmitters and
//! S the spool transducer, each +1 if right and -1 if swapped. A positive command then shows
//!
//! ```text
//! counts                      V T E
//! pressure 1 less pressure 2  V T P
//! spool                       V S
//! and a push out by hand      E
//! ```
//!
//! The fewest swaps that explain everything seen are assumed. If several explain it (V or T without a spool
//! transducer), each is named.

/// Two wires or tubes in each other's place, or one that is turned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Swap {
    /// The valve command is turned, at the converter's stage or the amplifier; of a stepper its direction.
    Valve,
    /// The tubes at the working ports of the valve.
    Tubes,
    /// The tracks of the encoder.
    Encoder,
    /// The pressure transmitters.
    Pressures,
    /// The spool transducer is turned.
    Spool,
}

impl Swap {
    /// Every swap.
    pub const ALL: [Swap; 5] = [Swap::Valve, Swap::Tubes, Swap::Encoder, Swap::Pressures, Swap::Spool];

    /// The swap and its remedy.
    #[must_use]
    pub fn advice(self) -> &'static str {
        match self {
            Swap::Valve => {
                "the valve command is turned: exchange the two wires at the amplifier's input, or set `pneudrive device config set output_inverted` to the other value; of a stepper exchange a pair of its phases"
            }
            Swap::Tubes => {
                "the tubes are swapped: exchange them at ports 2 and 4 of the valve, so that a positive command fills the blind side"
            }
            Swap::Encoder => super::hand::TURN_ENCODER,
            Swap::Pressures => {
                "the pressure transmitters are swapped: exchange their wires (on the Nucleo A5 is the blind side, A4 the rod side)"
            }
            Swap::Spool => {
                "the spool transducer is turned: exchange its wires, or sensors.spool_min_mm and spool_max_mm do not suit it; the law does not use it"
            }
        }
    }
}

/// The signs seen; None: not seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Signs {
    /// Counts while a hand pushed the slide out.
    pub pushed: Option<i32>,
    /// Counts after a positive command.
    pub counts: Option<i32>,
    /// Pressure 1 minus pressure 2 after a positive command.
    pub pressures: Option<i32>,
    /// Spool after a positive command.
    pub spool: Option<i32>,
}

impl Signs {
    /// The signs that these swaps would give.
    #[must_use]
    pub fn with(swaps: &[Swap]) -> Signs {
        let sign =
            |of: &[Swap]| if of.iter().filter(|swap| swaps.contains(swap)).count() % 2 == 0 { 1 } else { -1 };
        Signs {
            pushed: Some(sign(&[Swap::Encoder])),
            counts: Some(sign(&[Swap::Valve, Swap::Tubes, Swap::Encoder])),
            pressures: Some(sign(&[Swap::Valve, Swap::Tubes, Swap::Pressures])),
            spool: Some(sign(&[Swap::Valve, Swap::Spool])),
        }
    }

    /// The smallest sets of swaps that explain the signs; one empty set if everything is right.
    #[must_use]
    pub fn explanations(&self) -> Vec<Vec<Swap>> {
        let sets = (0..1u32 << Swap::ALL.len()).map(|bits| {
            let chosen = Swap::ALL.iter().enumerate().filter(|(place, _)| bits >> place & 1 == 1);
            chosen.map(|(_, swap)| *swap).collect::<Vec<Swap>>()
        });
        let fitting: Vec<Vec<Swap>> = sets.filter(|swaps| self.is_explained_by(swaps)).collect();
        let fewest = fitting.iter().map(Vec::len).min().unwrap_or(0);
        fitting.into_iter().filter(|swaps| swaps.len() == fewest).collect()
    }

    fn is_explained_by(&self, swaps: &[Swap]) -> bool {
        let would = Signs::with(swaps);
        let fits = |seen: Option<i32>, would: Option<i32>| seen.is_none() || seen == would;
        fits(self.pushed, would.pushed)
            && fits(self.counts, would.counts)
            && fits(self.pressures, would.pressures)
            && fits(self.spool, would.spool)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_single_swap_is_named_alone_by_what_answers_a_command() {
        for swap in Swap::ALL {
            let unpushed = Signs { pushed: None, ..Signs::with(&[swap]) };
            assert_eq!(unpushed.explanations(), [[swap]], "{swap:?}");
        }
        assert_eq!(Signs::with(&[]).explanations(), [[]], "right wires are explained by nothing");
    }

    #[test]
    fn without_a_spool_transducer_a_turned_valve_and_swapped_tubes_look_alike() {
        let seen = Signs { spool: None, ..Signs::with(&[Swap::Tubes]) };
        assert_eq!(seen.explanations(), [[Swap::Valve], [Swap::Tubes]]);
    }

    /// Swapped transmitters and tubes answer a command in the same way as swapped tracks; only a push by hand tells
    /// them apart.
    #[test]
    fn a_push_by_hand_tells_swapped_tracks_from_what_looks_like_them() {
        let both = Signs::with(&[Swap::Tubes, Swap::Pressures]);
        assert_eq!(Signs { pushed: None, ..both }.explanations(), [[Swap::Encoder]]);
        assert_eq!(both.explanations(), [vec![Swap::Tubes, Swap::Pressures]]);
    }

    #[test]
    fn every_explanation_looks_as_what_was_seen_and_needs_no_more_swaps_than_there_are() {
        for bits in 0..1 << Swap::ALL.len() {
            let swaps: Vec<Swap> =
                (0..Swap::ALL.len()).filter(|i| bits >> i & 1 == 1).map(|i| Swap::ALL[i]).collect();
            let seen = Signs::with(&swaps);
            let found = seen.explanations();
            assert!(!found.is_empty());
            assert!(
                found.iter().all(|set| Signs::with(set) == seen && set.len() <= swaps.len()),
                "{swaps:?}"
            );
        }
    }
}
