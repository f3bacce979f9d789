//! All instances of this process by number, and how each call comes to its own.

use std::any::Any;
use std::collections::BTreeMap;
use std::ffi::{CStr, CString, c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use anyhow::{Error, Result, anyhow};

use crate::instance::Instance;

/// The status of a call: fmi3Status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub enum Status {
    /// All is well.
    Ok = 0,
    /// The call failed; the log says why.
    Error = 3,
}

/// The importer's handle of an instance: a number, not an address.
pub type Handle = *mut c_void;

/// The importer's own, which its log function gets back.
pub type Environment = *mut c_void;

/// The importer's log function: environment, status, category, message.
pub type LogMessage = Option<unsafe extern "C" fn(Environment, Status, *const c_char, *const c_char)>;

/// The same of FMI 2.0: environment, instance, status, category, and a message in the manner of printf.
pub type LogMessage2 =
    Option<unsafe extern "C" fn(Environment, *const c_char, Status, *const c_char, *const c_char, ...)>;

/// The category of all messages, as in modelDescription.xml.
const CATEGORY: &CStr = c"logStatusError";

/// Where messages go: to a function of the importer, with the address of its environment.
#[derive(Clone, Debug)]
pub enum Log {
    /// The importer has no such function.
    Nobody,
    /// Of FMI 3.0.
    Fmi3(unsafe extern "C" fn(Environment, Status, *const c_char, *const c_char), usize),
    /// Of FMI 2.0, with the name of the instance.
    Fmi2(
        unsafe extern "C" fn(Environment, *const c_char, Status, *const c_char, *const c_char, ...),
        usize,
        CString,
    ),
}

/// A text in C.
fn in_c(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

impl Log {
    /// To a function of an importer of FMI 3.0, if there is one.
    pub fn of_fmi3(function: LogMessage, environment: Environment) -> Log {
        function.map_or(Log::Nobody, |function| Log::Fmi3(function, environment.expose_provenance()))
    }

    /// To a function of an importer of FMI 2.0, if there is one.
    pub fn of_fmi2(function: LogMessage2, environment: Environment, instance: &str) -> Log {
        let environment = environment.expose_provenance();
        function.map_or(Log::Nobody, |function| Log::Fmi2(function, environment, in_c(instance)))
    }

    /// Says why a call failed.
    pub fn error(&self, message: &str) {
        match self {
            Log::Nobody => {}
            Log::Fmi3(function, environment) => {
                let message = in_c(message);
                let environment = ptr::with_exposed_provenance_mut(*environment);
                // SAFETY: the importer gave the function for this with the environment that it gets here; all texts
                // end with a zero and outlive the call.
                unsafe { function(environment, Status::Error, CATEGORY.as_ptr(), message.as_ptr()) };
            }
            Log::Fmi2(function, environment, name) => {
                // The format has no arguments.
                let message = in_c(&message.replace('%', "%%"));
                let environment = ptr::with_exposed_provenance_mut(*environment);
                let (name, category) = (name.as_ptr(), CATEGORY.as_ptr());
                // SAFETY: as above.
                unsafe { function(environment, name, Status::Error, category, message.as_ptr()) };
            }
        }
    }
}

/// An instance with its log.
#[derive(Debug)]
struct Held {
    instance: Mutex<Instance>,
    log: Log,
}

/// All instances of this process, by number.
static INSTANCES: Mutex<BTreeMap<usize, Arc<Held>>> = Mutex::new(BTreeMap::new());
static NEXT: AtomicUsize = AtomicUsize::new(1);

/// The data are whole after a panic: instances in which it happened have failed.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn find(handle: Handle) -> Option<Arc<Held>> {
    lock(&INSTANCES).get(&handle.addr()).cloned()
}

/// The message of a panic.
fn in_panic(panic: &(dyn Any + Send)) -> Error {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default();
    anyhow!("an internal error: {text}")
}

/// Does something that may fail; a panic is a failure.
pub fn caught<T>(act: impl FnOnce() -> Result<T>) -> Result<T> {
    catch_unwind(AssertUnwindSafe(act)).unwrap_or_else(|panic| Err(in_panic(panic.as_ref())))
}

/// Admits an instance, and returns its handle.
pub fn add(instance: Instance, log: Log) -> Handle {
    let number = NEXT.fetch_add(1, Ordering::Relaxed);
    lock(&INSTANCES).insert(number, Arc::new(Held { instance: Mutex::new(instance), log }));
    ptr::without_provenance_mut(number)
}

/// Lets an instance go, if there is one of this handle.
pub fn remove(handle: Handle) {
    let held = lock(&INSTANCES).remove(&handle.addr());
    drop(held);
}

/// Does something with an instance, which fails with it if it panics. The lock is free again before a failure is logged, as
/// a log function may call back.
pub fn with(handle: Handle, act: impl FnOnce(&mut Instance) -> Result<()>) -> Status {
    let Some(held) = find(handle) else { return Status::Error };
    let done = {
        let mut instance = lock(&held.instance);
        catch_unwind(AssertUnwindSafe(|| act(&mut instance))).unwrap_or_else(|panic| {
            instance.fail();
            Err(in_panic(panic.as_ref()))
        })
    };
    match done {
        Ok(()) => Status::Ok,
        Err(error) => {
            held.log.error(&format!("{error:#}"));
            Status::Error
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Part;
    use pneudrive_sim::Rig;

    static SAID: Mutex<Vec<String>> = Mutex::new(Vec::new());

    unsafe extern "C" fn log(_: Environment, _: Status, _: *const c_char, message: *const c_char) {
        // SAFETY: the message ends with a zero.
        let message = unsafe { CStr::from_ptr(message) };
        lock(&SAID).push(message.to_string_lossy().into_owned());
    }

    #[test]
    fn a_panic_is_logged_fails_its_instance_alone_and_does_not_unwind() {
        let handles = [(); 2].map(|()| {
            let rig = Rig::builtin("servo-b-tuned").expect("built in");
            let mut instance = Instance::new(Part::Plant, rig).expect("a plant");
            instance.enter_initialisation(0.0).expect("instantiated");
            instance.exit_initialisation().expect("initialised");
            add(instance, Log::of_fmi3(Some(log), ptr::null_mut()))
        });
        assert_eq!(with(handles[0], |_| panic!("no such {}", "spool")), Status::Error);
        assert_eq!(lock(&SAID).pop().as_deref(), Some("an internal error: no such spool"));
        let step = |handle| with(handle, |instance| instance.step(0.0, 0.0013));
        assert_eq!(handles.map(step), [Status::Error, Status::Ok]);
        let reset = |instance: &mut Instance| {
            instance.reset();
            instance.enter_initialisation(0.0)
        };
        assert_eq!(with(handles[0], reset), Status::Ok, "it can be begun anew");
        handles.into_iter().for_each(remove);
    }
}
