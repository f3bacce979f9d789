//! Progress of long work, for a page.

use serde_json::{Value, json};

/// The first this many steps are reported one by one; later steps are reported each time another of this many parts of the
/// whole is done. A line for each run would be too many.
const PARTS: usize = 200;

/// Reports the progress of a task whenever it has changed.
pub(super) struct Meter<'a> {
    hears: &'a mut (dyn FnMut(Value) + Send),
    told: Option<(&'static str, usize)>,
}

impl<'a> Meter<'a> {
    pub fn new(hears: &'a mut (dyn FnMut(Value) + Send)) -> Meter<'a> {
        Meter { hears, told: None }
    }

    pub fn at(&mut self, what: &'static str, done: usize, all: usize) {
        let share = (PARTS * done).checked_div(all).unwrap_or(0);
        let part = (what, if done < PARTS { done } else { PARTS + share });
        if self.told != Some(part) {
            self.told = Some(part);
            (self.hears)(json!({ "what": what, "done": done, "all": all }));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_is_told_where_it_has_changed() {
        let mut heard = Vec::new();
        let mut hears = |line: Value| heard.push(line["done"].as_u64());
        let mut meter = Meter::new(&mut hears);
        for done in 0..=100_000 {
            meter.at("points", done, 100_000);
        }
        meter.at("nothing", 0, 0);
        assert_eq!(heard.len(), 2 * PARTS + 2);
        assert_eq!((heard[1], heard[2 * PARTS]), (Some(1), Some(100_000)));
    }
}
