//! Circles between modules of the same parent.

use std::collections::{BTreeMap, BTreeSet};

use super::module::{Modules, Name};
use super::paths::{Use, shown};

/// Which sibling uses which, each with one of the uses that make it so.
type Arrows<'a> = BTreeMap<&'a str, BTreeMap<&'a str, &'a Use>>;

/// The circles between siblings, below every parent, with one use for each arrow.
pub fn circles(modules: &Modules, uses: &BTreeSet<Use>) -> Vec<String> {
    modules.0.keys().filter_map(|parent| circle_below(parent, uses)).collect()
}

fn circle_below(parent: &Name, uses: &BTreeSet<Use>) -> Option<String> {
    let arrows = arrows_below(parent, uses);
    let circle = arrows.keys().filter_map(|start| shortest_circle(&arrows, start)).min_by_key(Vec::len)?;
    let told: Vec<String> = circle
        .iter()
        .zip(circle.iter().cycle().skip(1))
        .map(|(from, to)| {
            let using = arrows[from][to];
            let of = if using.item.is_empty() {
                shown(&using.to)
            } else {
                format!("{}::{}", shown(&using.to), using.item)
            };
            format!("{from} -> {to} ({} uses {of})", shown(&using.from))
        })
        .collect();
    Some(format!("a circle below {}: {}", shown(parent), told.join(", ")))
}

fn arrows_below<'a>(parent: &Name, uses: &'a BTreeSet<Use>) -> Arrows<'a> {
    let mut arrows = Arrows::new();
    let child = |name: &'a Name| name.starts_with(parent).then(|| name.get(parent.len())).flatten();
    for using in uses {
        if let (Some(from), Some(to)) = (child(&using.from), child(&using.to))
            && from != to
        {
            arrows.entry(from).or_default().entry(to).or_insert(using);
        }
    }
    arrows
}

/// The shortest path from a sibling back to it.
fn shortest_circle<'a>(arrows: &Arrows<'a>, start: &'a str) -> Option<Vec<&'a str>> {
    let mut paths = vec![vec![start]];
    let mut seen = BTreeSet::new();
    while !paths.is_empty() {
        let mut longer = Vec::new();
        for path in paths {
            for next in arrows.get(path[path.len() - 1]).into_iter().flat_map(BTreeMap::keys) {
                if *next == start {
                    return Some(path);
                }
                if seen.insert(*next) {
                    longer.push([&path[..], &[*next]].concat());
                }
            }
        }
        paths = longer;
    }
    None
}
