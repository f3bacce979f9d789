//! FMUs as the crate `fmi` has them: its instances, with variables by name.
//!
//! Its reader (fmi-schema 0.8) refuses a description whose variables have a `unit`, or whose units have a kelvin, `K`.
//! FMI 3.0 has both. So what it loads is a copy whose description has no such attributes; all else is what the command
//! wrote.

use std::fs::{self, File};
use std::io::{Cursor, Read, Write};
use std::path::Path;

use fmi::fmi3::import::Fmi3Import;
use fmi::fmi3::instance::InstanceCS;
use fmi::fmi3::{CoSimulation, Common, Fmi3Model, GetSet};
use fmi::import;
use fmi::traits::FmiImport;
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

/// An instance of an FMU.
pub struct Fmu {
    /// As the crate has it.
    pub instance: InstanceCS,
    /// modelDescription.xml.
    description: String,
    /// The unpacked FMU, which is removed with it.
    _import: Fmi3Import,
}

impl Fmu {
    /// Loads an FMU, and makes an instance of it.
    ///
    /// # Panics
    /// When the crate cannot load it.
    #[must_use]
    pub fn load(path: &Path) -> Fmu {
        let copy = without_units(path);
        let import: Fmi3Import = import::new(Cursor::new(copy)).expect("an FMU");
        let description =
            fs::read_to_string(import.archive_path().join("modelDescription.xml")).expect("a description");
        let instance = import.instantiate_cs("one", false, true, false, false, &[]).expect("an instance");
        Fmu { instance, description, _import: import }
    }

    /// Ends the initialisation with what was set.
    ///
    /// # Panics
    /// When the FMU refuses.
    pub fn start(&mut self) {
        self.instance.enter_initialization_mode(None, 0.0, None).expect("instantiated");
        self.instance.exit_initialization_mode().expect("initialised");
    }

    /// The value reference of a variable.
    ///
    /// # Panics
    /// When there is no such variable.
    #[must_use]
    pub fn reference(&self, name: &str) -> u32 {
        let named = format!(" name=\"{name}\" valueReference=\"");
        let begin =
            self.description.find(&named).unwrap_or_else(|| panic!("there is no {name}")) + named.len();
        let digits = self.description[begin..].split('"').next().unwrap_or_default();
        digits.parse().expect("a reference")
    }

    /// A whole number.
    ///
    /// # Panics
    /// When the FMU refuses.
    pub fn integer(&mut self, name: &str) -> i32 {
        let mut value = [0];
        self.instance.get_int32(&[self.reference(name)], &mut value).expect("a value");
        value[0]
    }

    /// Sets a whole number.
    ///
    /// # Panics
    /// When the FMU refuses.
    pub fn set_integer(&mut self, name: &str, value: i32) {
        self.instance.set_int32(&[self.reference(name)], &[value]).expect("it is taken");
    }

    /// A step. Whether the FMU accepts it.
    pub fn step(&mut self, time: f64, step: f64) -> bool {
        let (mut event, mut end, mut early, mut reached) = (true, true, true, f64::NAN);
        let done = self.instance.do_step(time, step, true, &mut event, &mut end, &mut early, &mut reached);
        done.is_ok() && !event && !end && !early && (reached - time - step).abs() < 1e-9
    }
}

/// The bytes of an FMU without the attributes that the crate does not know.
fn without_units(path: &Path) -> Vec<u8> {
    let mut archive = ZipArchive::new(File::open(path).expect("an FMU")).expect("an archive");
    let mut copy = ZipWriter::new(Cursor::new(Vec::new()));
    for place in 0..archive.len() {
        let mut file = archive.by_index(place).expect("a file");
        let name = file.name().expect("a name").into_owned();
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).expect("its bytes");
        if name == "modelDescription.xml" {
            let text = String::from_utf8(bytes).expect("UTF-8");
            bytes = without(&without(&text, " unit=\""), " K=\"").into_bytes();
        }
        copy.start_file(name, SimpleFileOptions::default()).expect("a place");
        copy.write_all(&bytes).expect("a copy");
    }
    copy.finish().expect("a copy").into_inner()
}

/// A description without an attribute, which is given with the space before and the quotation mark behind it.
fn without(description: &str, attribute: &str) -> String {
    let mut parts = description.split(attribute);
    let first = parts.next().unwrap_or_default();
    let rest = parts.map(|part| part.split_once('"').map_or(part, |(_, rest)| rest));
    std::iter::once(first).chain(rest).collect()
}
