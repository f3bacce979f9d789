//! The paths in a module, resolved to modules.

use std::collections::BTreeSet;

use syn::visit::{self, Visit};
use syn::{ItemMod, ItemUse, UseTree};

use super::module::{Modules, Name};

/// A module that uses something of another one.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Use {
    /// The module that uses.
    pub from: Name,
    /// The module that is used.
    pub to: Name,
    /// The item in it; empty for the module itself.
    pub item: String,
}

/// All uses of one module by another within the crate.
pub fn uses(modules: &Modules) -> BTreeSet<Use> {
    let mut found = BTreeSet::new();
    for (name, module) in &modules.0 {
        let mut named = Named::default();
        module.items.iter().for_each(|item| named.visit_item(item));
        for path in named.0 {
            if let Some((to, item)) = resolved(modules, name, &path, 0)
                && to != *name
            {
                found.insert(Use { from: name.clone(), to, item });
            }
        }
    }
    found
}

/// Functions of a module above that are called from below it.
pub fn functions_of_parents(modules: &Modules, uses: &BTreeSet<Use>) -> Vec<String> {
    let of_parent = |using: &&Use| {
        using.from.starts_with(&using.to)
            && modules.0.get(&using.to).is_some_and(|module| module.functions.contains(&using.item))
    };
    let told = |using: &Use| {
        format!("{} calls the function {} of its parent {}", shown(&using.from), using.item, shown(&using.to))
    };
    uses.iter().filter(of_parent).map(told).collect()
}

/// A module's name for messages.
pub fn shown(name: &[String]) -> String {
    if name.is_empty() { "the crate".to_owned() } else { name.join("::") }
}

/// Paths as they stand in the sources.
#[derive(Default)]
struct Named(Vec<Vec<String>>);

impl<'ast> Visit<'ast> for Named {
    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        self.of_tree(&item.tree, &mut Vec::new());
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        self.0.push(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        visit::visit_path(self, path);
    }

    // The paths in an inner module are those of that module.
    fn visit_item_mod(&mut self, _: &'ast ItemMod) {}
}

impl Named {
    fn of_tree(&mut self, tree: &UseTree, path: &mut Vec<String>) {
        match tree {
            UseTree::Path(step) => {
                path.push(step.ident.to_string());
                self.of_tree(&step.tree, path);
                path.pop();
            }
            UseTree::Group(group) => group.items.iter().for_each(|tree| self.of_tree(tree, path)),
            UseTree::Name(name) => self.0.push([&path[..], &[name.ident.to_string()]].concat()),
            UseTree::Rename(name) => self.0.push([&path[..], &[name.ident.to_string()]].concat()),
            UseTree::Glob(_) => self.0.push(path.clone()),
        }
    }
}

/// Re-exports that stand for each other without end are no program.
const MAX_EXPORTS: u32 = 8;

/// The module that a path of a module leads to, and the item in it; None if it leads out of the crate.
fn resolved(modules: &Modules, from: &Name, path: &[String], depth: u32) -> Option<(Name, String)> {
    let (mut at, rest) = begin(modules, from, path)?;
    for (i, step) in rest.iter().enumerate() {
        let child = [&at[..], std::slice::from_ref(step)].concat();
        if modules.0.contains_key(&child) {
            at = child;
            continue;
        }
        if let Some(export) = modules.0.get(&at)?.exports.get(step)
            && depth < MAX_EXPORTS
        {
            let further = [&export[..], &rest[i + 1..]].concat();
            return resolved(modules, &at, &further, depth + 1);
        }
        return Some((at, step.clone()));
    }
    Some((at, String::new()))
}

/// The beginning of a path, and the rest.
fn begin<'a>(modules: &Modules, from: &Name, path: &'a [String]) -> Option<(Name, &'a [String])> {
    let first = path.first()?;
    match first.as_str() {
        "crate" => Some((Vec::new(), &path[1..])),
        "self" if path.len() > 1 => Some((from.clone(), &path[1..])),
        "super" => {
            let ups = path.iter().take_while(|step| *step == "super").count();
            let kept = from.len().checked_sub(ups)?;
            Some((from[..kept].to_vec(), &path[ups..]))
        }
        _ => {
            let child = [&from[..], std::slice::from_ref(first)].concat();
            modules.0.contains_key(&child).then(|| (from.clone(), path))
        }
    }
}
