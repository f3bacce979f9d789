//! Names and values of the controller's parameters for users, as in rig files.
//!
//! A parameter set by a single key of a rig file has the name, the unit and the words of that key: `hold_ms = 60000` of
//! the device is `safety.hold_s = 60`. A parameter computed from several keys (a limit in counts depends on the stroke,
//! the margin and the encoder), or from none, has the device's own name. The device's names are accepted everywhere, with
//! its units.

use anyhow::{Context, Result, anyhow, bail};
use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::Form::{self, Scaled, Whole, Words};
use pneudrive_controller::parameters::{Parameter, RigKey, TABLE, by_name, id, lookup};
use pneudrive_sim::rig::OF_SEVERAL;

/// A parameter as it is written.
#[derive(Clone, Copy, Debug)]
pub struct Written {
    /// Its line in the table.
    pub parameter: &'static Parameter,
    /// The key of a rig file, or the device's own name.
    pub name: &'static str,
    form: Form,
}

impl Written {
    /// A parameter, or the list that an entry belongs to, by its id.
    pub fn of(id: u16) -> Option<Written> {
        let parameter = lookup(id)?;
        let RigKey { path, form } = parameter.key.unwrap_or(RigKey { path: parameter.name, form: Whole });
        Some(Written { parameter, name: path, form })
    }

    /// A parameter by the key of a rig file, or by the device's own name, which implies the device's unit.
    pub fn named(name: &str) -> Option<Written> {
        let of_key = with_key(name).and_then(|parameter| Written::of(parameter.id));
        let own = || by_name(name).map(|parameter| Written { parameter, name: parameter.name, form: Whole });
        of_key.or_else(own)
    }

    /// All of them, in the order of the table.
    pub fn all() -> impl Iterator<Item = Written> {
        TABLE.iter().filter_map(|parameter| Written::of(parameter.id))
    }

    /// Its unit: the key's, which may be part of the key's name.
    pub fn unit(&self) -> &'static str {
        match self.form {
            Whole => self.parameter.unit,
            Scaled(_) if self.parameter.id == id::ENCODER_PM_PER_COUNT => "mm",
            Scaled(_) => self.name.rsplit('_').next().unwrap_or(""),
            Words(_) => "",
        }
    }

    /// A value as text.
    pub fn text(&self, value: i32) -> String {
        match self.form {
            Whole => value.to_string(),
            Scaled(digits) => scaled(value, digits),
            Words(words) => {
                let word = usize::try_from(value).ok().and_then(|place| words.get(place));
                word.map_or_else(|| value.to_string(), |word| (*word).to_owned())
            }
        }
    }

    /// The value of a text.
    ///
    /// # Errors
    /// When it is not such a value, or has more digits than the device stores.
    pub fn value(&self, text: &str) -> Result<i32> {
        let value = match self.form {
            Whole => whole_number(text).map_err(|error| anyhow!("{error}")),
            Scaled(digits) => unscaled(text, digits).with_context(|| self.device_unit()),
            Words(words) => {
                let text = text.trim_matches('"');
                let place = words.iter().position(|word| *word == text);
                place
                    .map(|place| place as i32)
                    .with_context(|| format!("{text:?} is not one of {}", words.join(", ")))
            }
        };
        value.with_context(|| self.name)
    }

    /// Sets a parameter from a text; a list from values between commas, the last of which repeats.
    ///
    /// # Errors
    /// When the value is invalid, out of range, or the list is longer than the device's; nothing is changed then.
    pub fn put(&self, text: &str, parameters: &mut Parameters) -> Result<()> {
        let Parameter { id, len, .. } = *self.parameter;
        let entries = text.trim().trim_start_matches('[').trim_end_matches(']').split(',');
        let values: Vec<i32> = entries.map(|entry| self.value(entry.trim())).collect::<Result<_>>()?;
        if values.len() > usize::from(len) {
            bail!("{} has {len} entries, not {}", self.name, values.len());
        }
        let mut changed = parameters.clone();
        let last = values.last().copied().unwrap_or(0);
        for (id, value) in (id..id + len).zip(values.into_iter().chain(std::iter::repeat(last))) {
            changed.set(id, value).map_err(|_| {
                anyhow!("{} = {} is out of range: {}", self.name, self.text(value), self.range())
            })?;
        }
        *parameters = changed;
        Ok(())
    }

    /// The words that it is written as, in the order of their values; none of a number.
    pub fn words(&self) -> &'static [&'static str] {
        match self.form {
            Words(words) => words,
            _ => &[],
        }
    }

    fn device_unit(&self) -> String {
        format!("the device stores it as a whole number of {}", self.parameter.unit)
    }

    /// Its value or values; equal entries at the end of a list are written once.
    pub fn all_text(&self, parameters: &Parameters) -> String {
        let Parameter { id, len, .. } = *self.parameter;
        match len {
            1 => self.text(parameters.get(id).unwrap_or(0)),
            len => parameter_text(parameters, id, len),
        }
    }

    /// Its range, in words.
    pub fn range(&self) -> String {
        let Parameter { min, max, .. } = *self.parameter;
        match self.form {
            Words(words) => words.join(" or "),
            _ => format!("{} to {} {}", self.text(min), self.text(max), self.unit()).trim_end().to_owned(),
        }
    }
}

/// The name of the parameter with an id.
pub fn name_of(id: u16) -> &'static str {
    Written::of(id).map_or("?", |written| written.name)
}

/// The users' names of parameters of the device.
pub fn names_of(own: &[&'static str]) -> Vec<&'static str> {
    own.iter().map(|name| by_name(name).map_or(*name, |parameter| name_of(parameter.id))).collect()
}

/// The parameter that a key of a rig file sets by itself.
fn with_key(path: &str) -> Option<&'static Parameter> {
    TABLE.iter().find(|parameter| parameter.key.is_some_and(|key| key.path == path))
}

/// Whether a key of a rig file determines a parameter of the controller, or part of one.
pub fn is_parameter(key: &str) -> bool {
    OF_SEVERAL.iter().any(|of| of.path == key) || with_key(key).is_some()
}

/// The whole number of a text, within the range of the device.
pub fn whole_number(text: &str) -> Result<i32, String> {
    text.parse().map_err(|_| format!("{text:?} is not a whole number of up to 32 bits"))
}

/// The value of a parameter; equal entries at the end of a list are written once, as in a rig file.
pub fn parameter_text(parameters: &Parameters, first: u16, len: u16) -> String {
    let values: Vec<i32> = (first..first + len).filter_map(|id| parameters.get(id)).collect();
    let last = values.last().copied().unwrap_or(0);
    let repeated = values.iter().rev().take_while(|&&value| value == last).count();
    let kept = values.len() - repeated + 1;
    values[..kept.min(values.len())].iter().map(ToString::to_string).collect::<Vec<_>>().join(",")
}

/// A number of 10^-digits as a decimal fraction, exactly.
fn scaled(value: i32, digits: u32) -> String {
    let (unit, size) = (10u64.pow(digits), u64::from(value.unsigned_abs()));
    let sign = if value < 0 { "-" } else { "" };
    let fraction = format!("{:0width$}", size % unit, width = digits as usize);
    let fraction = fraction.trim_end_matches('0');
    let point = if fraction.is_empty() { "" } else { "." };
    format!("{sign}{}{point}{fraction}", size / unit)
}

/// A decimal fraction as a whole number of 10^-digits.
fn unscaled(text: &str, digits: u32) -> Result<i32> {
    let number: f64 = text.parse().map_err(|_| anyhow!("{text:?} is not a number"))?;
    let value = number * f64::from(10u32.pow(digits));
    let whole = value.round();
    if !(f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&whole) {
        bail!("{text} is too large");
    }
    if (value - whole).abs() > 1e-5 {
        bail!("{text} has too many digits");
    }
    Ok(whole as i32)
}

#[cfg(test)]
mod tests {
    use pneudrive_sim::Rig;
    use pneudrive_sim::rig::explain;

    use super::*;

    #[test]
    fn every_name_is_a_key_of_rig_files_and_stands_for_one_parameter() {
        let paths: Vec<&str> = TABLE.iter().filter_map(|parameter| Some(parameter.key?.path)).collect();
        for (place, path) in paths.iter().enumerate() {
            assert!(explain(path).is_ok(), "{path}");
            assert!(!paths[place + 1..].contains(path), "{path}");
        }
    }

    /// A key means the same in a rig file and on the device.
    #[test]
    fn a_rig_file_that_says_what_is_written_of_a_parameter_gives_it_that_value() {
        let default = Rig::read("test", "").expect("the empty file").parameters();
        for written in Written::all().filter(|written| written.parameter.key.is_some()) {
            let Parameter { id, len, .. } = *written.parameter;
            let text = written.all_text(&default);
            let quoted = match written.form {
                Words(words) if words[0].parse::<i32>().is_err() && words[0] != "false" => {
                    format!("\"{text}\"")
                }
                _ if len > 1 => format!("[{text}]"),
                _ => text,
            };
            let setting = format!("{} = {quoted}\n", written.name);
            let rig = Rig::read("test", &setting).unwrap_or_else(|problems| panic!("{setting}: {problems}"));
            assert_eq!(rig.parameters().get(id), default.get(id), "{setting}");
        }
    }

    #[test]
    fn a_value_comes_back_from_its_text() {
        for written in Written::all() {
            let Parameter { min, max, default, name, .. } = *written.parameter;
            for value in [min, max, default, min.saturating_add(1), max.saturating_sub(1)] {
                let value = value.clamp(min, max);
                assert_eq!(written.value(&written.text(value)).ok(), Some(value), "{name}");
            }
        }
    }

    #[test]
    fn a_list_is_put_whole_with_its_last_value_repeated_or_not_at_all() {
        let mut parameters = Parameters::default();
        let list = Written::of(id::GAIN_PROFILE).expect("there is");
        list.put("900, 800,7", &mut parameters).expect("right");
        assert_eq!(list.all_text(&parameters), "900,800,7");
        let before = parameters.clone();
        let long = vec!["1"; 257].join(",");
        for (text, message) in [("1,x", "not a whole number"), ("1,-1", "out of range"), (&long, "not 257")] {
            let error = format!("{:#}", list.put(text, &mut parameters).expect_err(text));
            assert!(error.contains(message) && error.starts_with("controller.gain_profile"), "{error}");
        }
        assert_eq!(parameters, before);
        let period = Written::of(id::PERIOD_US).expect("there is");
        assert!(period.put("0.001,0.002", &mut parameters).is_err(), "one value, not two");
    }

    #[test]
    fn keys_are_in_their_own_units_and_names_of_the_device_in_its() {
        for (name, text, value) in [
            ("safety.hold_s", "60", 60_000),
            ("hold_ms", "60000", 60_000),
            ("controller.period_s", "0.0013", 1300),
            ("controller.loop", "open", 1),
            ("encoder.polarity", "-1", 1),
            ("encoder.mm_per_count", "0.01205", 12_050_000),
            ("sensors.spool_min_mm", "-1.25", -1_250_000),
            ("controller.velocity_gain", "70", 70),
        ] {
            let written = Written::named(name).expect("there is");
            assert_eq!(
                (written.value(text).ok(), written.text(value)),
                (Some(value), text.to_owned()),
                "{name}"
            );
        }
        let hold = Written::named("safety.hold_s").expect("there is");
        assert_eq!((hold.unit(), hold.range()), ("s", "0 to 3600 s".to_owned()));
        assert!(
            format!("{:#}", hold.value("0.00001").expect_err("too small")).contains("whole number of ms")
        );
        assert!(hold.value("1e300").is_err() && hold.value("nan").is_err() && hold.value("x").is_err());
    }
}
