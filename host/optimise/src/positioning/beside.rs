//! The steps of a run beside the bang-bang bound on their time.

use std::collections::BTreeMap;

use pneudrive_evaluate::evaluation::Move;
use pneudrive_sim::Rig;
use pneudrive_sim::component::encoder::mm_per_count;

use super::bang_bang::{Bound, bound_of};
use super::course::Steps;

/// This many different steps have their bound computed: a fifth of a second.
const MOST: usize = 4;

/// A sentence for each step that settled: its time, and how many times the bound that is. Nothing for a law without a model
/// of its drive, whose time is a matter of its gains, and of moves with profiles, whose time is asked for.
#[must_use]
pub fn beside_bound(rig: &Rig, moves: &[Move]) -> Vec<String> {
    if !rig.knows_its_drive() {
        return Vec::new();
    }
    let mut bounds = BTreeMap::new();
    moves.iter().filter_map(|one| sentence(rig, one, &mut bounds)).collect()
}

fn sentence(rig: &Rig, one: &Move, bounds: &mut BTreeMap<[i64; 2], Option<Bound>>) -> Option<String> {
    let (to_mm, settled_s) = (one.to_mm?, one.settling_s?);
    if one.is_cut || one.tracking.is_some() {
        return None;
    }
    let ends = [one.from_mm, to_mm].map(|mm| (mm / mm_per_count(rig)).round() as i64);
    if !bounds.contains_key(&ends) && bounds.len() < MOST {
        let [from, to] = ends;
        // A step that the valve cannot make has no bound.
        bounds.insert(ends, bound_of(rig, Steps { from, to }).ok().flatten());
    }
    let Bound { time_s, .. } = (*bounds.get(&ends)?)?;
    Some(format!(
        "Move {}, {:.1} to {to_mm:.1} mm: {settled_s:.3} s, {:.1} times the bang-bang bound of {time_s:.3} s.",
        one.number,
        one.from_mm,
        settled_s / time_s
    ))
}
