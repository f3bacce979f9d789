//! Encoder and pressure sensors.

use pneudrive_sim::component::encoder::EncoderKind;
use pneudrive_sim::keys;
use pneudrive_sim::rigfile::read_quantity;

use super::air::{SURROUNDINGS, supply};
use super::{Cylinder, RESOLUTION_MM};
use crate::question::{AnswerProblem, Answers};
use crate::rig_file::{Number, RigFile};

/// The kinds of encoders.
const KINDS: [EncoderKind; 3] = [EncoderKind::Quadrature, EncoderKind::Ssi, EncoderKind::Potentiometer];

/// The word of a kind in catalogues.
fn word(kind: EncoderKind) -> &'static str {
    if kind == EncoderKind::Quadrature { "incremental" } else { kind.word() }
}

/// Bits of a potentiometer's converter: those that nobody has described, the fewest and the most.
const BITS: (i64, [i64; 2]) = (12, [8, 30]);

/// The answer that there are no pressure sensors.
const NONE: &str = "none";

/// The encoder of a drive.
#[derive(Clone, Copy, Debug)]
pub(super) struct Encoder {
    kind: EncoderKind,
    /// Bits of a potentiometer's converter.
    bits: i64,
    /// Length of a count, mm.
    pub mm_per_count: f64,
}

impl Encoder {
    /// The encoder by its kind and resolution. A potentiometer measures the stroke; its resolution decides the bits of its
    /// converter.
    pub fn of(answers: &Answers, cylinder: &Cylinder) -> Result<Encoder, AnswerProblem> {
        let (kind, resolution) = (kind(answers)?, answers.number("resolution")?);
        if kind != EncoderKind::Potentiometer {
            return Ok(Encoder { kind, bits: 0, mm_per_count: resolution.unwrap_or(RESOLUTION_MM) });
        }
        let stroke_mm = 1e3 * cylinder.stroke;
        let bits = resolution.map_or(BITS.0, |mm| (stroke_mm / mm + 1.0).log2().ceil() as i64);
        let [fewest, most] = BITS.1;
        let bits = bits.clamp(fewest, most);
        Ok(Encoder { kind, bits, mm_per_count: stroke_mm / ((1_i64 << bits) - 1) as f64 })
    }

    /// The middle of the positions that are read as this count, mm, and in words.
    pub fn middle(&self, count: f64) -> (f64, &'static str) {
        match self.kind {
            EncoderKind::Potentiometer => (count * self.mm_per_count, "on a count"),
            _ => ((count + 0.5) * self.mm_per_count, "half a count on"),
        }
    }

    pub fn write(&self, file: &mut RigFile, answers: &Answers) {
        let text = answers.text("encoder").unwrap_or_default();
        if !text.is_empty() {
            file.word(&keys::encoder::MODEL, self.kind, &format!("given: {text}"));
        }
        if self.kind == EncoderKind::Potentiometer {
            let why = match answers.text("resolution") {
                Some(resolution) => format!("computed: the stroke in counts of {resolution} or finer"),
                None => "typical: a usual converter".to_owned(),
            };
            return file.text(&keys::encoder::BITS, self.bits.to_string(), &why);
        }
        let from = match self.kind {
            EncoderKind::Quadrature => "an incremental encoder; its data sheet tells",
            _ => "an absolute encoder; its data sheet tells",
        };
        let resolution = match answers.text("resolution") {
            Some(resolution) => Number::given(self.mm_per_count, resolution),
            None => Number::typical(RESOLUTION_MM, [0.001, 0.1], from),
        };
        file.number(&keys::encoder::MM_PER_COUNT, &resolution);
    }
}

fn kind(answers: &Answers) -> Result<EncoderKind, AnswerProblem> {
    let Some(text) = answers.text("encoder") else { return Ok(EncoderKind::Quadrature) };
    KINDS.into_iter().find(|kind| word(*kind).eq_ignore_ascii_case(text)).ok_or_else(|| {
        let known = KINDS.map(word).join(", ");
        AnswerProblem::new("encoder", format!("must be one of {known}, is \"{text}\"")).or(word(KINDS[0]))
    })
}

/// Writes the pressure sensors.
pub(super) fn write_pressures(file: &mut RigFile, answers: &Answers) -> Result<(), AnswerProblem> {
    match answers.text("pressure-sensors") {
        None => {
            let above = "above the supply, in whole bar";
            let largest = supply(answers)?.map(|supply| (supply * 1.2e-5).ceil() * 1e5, above);
            file.number(&keys::sensors::PRESSURE_MAX_PA, &largest);
        }
        Some(NONE) => {
            file.text(
                &keys::sensors::PRESSURE,
                "false".to_owned(),
                "given: the drive has no pressure sensors",
            );
        }
        Some(text) => {
            let [low, high] = range(text)?;
            file.number(&keys::sensors::PRESSURE_MIN_PA, &Number::given(low, text));
            file.number(&keys::sensors::PRESSURE_MAX_PA, &Number::given(high, text));
        }
    }
    Ok(())
}

/// The absolute pressures at both ends of a range such as "0 to 10 bar(g)"; a single one is its upper end.
fn range(text: &str) -> Result<[f64; 2], AnswerProblem> {
    let refuse = |message: String| AnswerProblem::new("pressure-sensors", message).or("0 to 10 bar(g)");
    let (low, high) = text.split_once(" to ").unwrap_or(("0", text));
    // The first number usually has no unit of its own.
    let unit =
        high.trim().trim_start_matches(|letter: char| letter.is_ascii_digit() || "+-.eE ".contains(letter));
    let low =
        if low.trim().parse::<f64>().is_ok() { format!("{} {unit}", low.trim()) } else { low.to_owned() };
    let absolute = |text: &str| {
        let reading = read_quantity(text, "Pa").map_err(refuse)?;
        if !reading.says_from_where {
            return Err(refuse(format!("\"{text}\" may be gauge or absolute: write bar(g) or bar(a)")));
        }
        Ok(if reading.gauge { reading.value + SURROUNDINGS.0 } else { reading.value })
    };
    Ok([absolute(&low)?, absolute(high)?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::own_drive::rig_file;
    use pneudrive_sim::Rig;
    use pneudrive_sim::component::controller::Law;
    use pneudrive_sim::component::encoder::mm_per_count;

    const DRIVE: [(&str, &str); 4] = [
        ("cylinder", "iso-15552-32"),
        ("stroke", "250 mm"),
        ("mass", "8 kg"),
        ("valve", "proportional-5-3-350"),
    ];

    fn own(more: &[(&str, &str)]) -> Result<Rig, Vec<AnswerProblem>> {
        let text = rig_file("own", &Answers::of(&[&DRIVE, more].concat()))?;
        Ok(Rig::read("own", &text).unwrap_or_else(|problems| panic!("{problems}\n{text}")))
    }

    #[test]
    fn an_encoder_is_by_its_word_and_its_resolution() {
        for (word, resolution, kind, mm) in [
            ("incremental", "5 um", EncoderKind::Quadrature, 0.005),
            ("ssi", "1 um", EncoderKind::Ssi, 0.001),
            ("SSI", "1 um", EncoderKind::Ssi, 0.001),
            ("potentiometer", "20 um", EncoderKind::Potentiometer, 250.0 / 16_383.0),
        ] {
            let rig = own(&[("encoder", word), ("resolution", resolution)]).expect(word);
            assert_eq!(rig.get(&keys::encoder::MODEL), kind);
            assert!((mm_per_count(&rig) - mm).abs() < 1e-12, "{word}: {}", mm_per_count(&rig));
            assert_eq!(rig.moves().len(), 2);
            for ((_, counts), to_mm) in rig.moves().into_iter().zip([62.5, 187.5]) {
                assert!((counts as f64 * mm_per_count(&rig) - to_mm).abs() <= 0.5 * mm, "{word}: {counts}");
            }
        }
        let refusal = own(&[("encoder", "resolver")]).expect_err("none such")[0].to_string();
        assert_eq!(refusal, "--encoder: must be one of incremental, ssi, potentiometer, is \"resolver\"");
    }

    #[test]
    fn pressure_sensors_have_their_range_or_there_are_none() {
        let ends = |text: &str| {
            let rig = own(&[("pressure-sensors", text)]).expect(text);
            [&keys::sensors::PRESSURE_MIN_PA, &keys::sensors::PRESSURE_MAX_PA].map(|key| rig.get(key))
        };
        // A file has six digits.
        assert_eq!(ends("0 to 10 bar(g)"), [101_325.0, 1_101_320.0]);
        assert_eq!(ends("10 bar(g)"), [101_325.0, 1_101_320.0]);
        assert_eq!(ends("0 to 12 bar(a)"), [0.0, 1_200_000.0]);
        assert_eq!(ends("-1 bar(g) to 9 bar(g)"), [1325.0, 1_001_320.0]);
        let none = own(&[("pressure-sensors", "none")]).expect("a rig");
        assert!(!none.get(&keys::sensors::PRESSURE));
        assert_eq!(none.get(&keys::controller::LAW), Law::GainProfile, "the cascade needs pressures");
        let refusal = own(&[("pressure-sensors", "10 bar")]).expect_err("from where?")[0].to_string();
        assert!(refusal.contains("may be gauge or absolute"), "{refusal}");
    }

    #[test]
    fn the_tolerance_is_in_the_file() {
        let rig = own(&[("tolerance-mm", "0.2")]).expect("a rig");
        assert_eq!(rig.get(&keys::test::TOLERANCE_MM).to_bits(), 0.2_f64.to_bits());
        let refusal = own(&[("tolerance-mm", "0")]).expect_err("too small")[0].to_string();
        assert!(refusal.starts_with("--tolerance-mm: ") && refusal.contains("between 0.0001"), "{refusal}");
    }
}
