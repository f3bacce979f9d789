//! The modules of a crate, read from its files; modules for tests are left out.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use quote::ToTokens;
use syn::{Attribute, Item, UseTree, Visibility};

/// A module's names from the crate on: `["assembly", "lag"]`; empty for the crate itself.
pub type Name = Vec<String>;

/// The contents of a module.
#[derive(Default)]
pub struct Module {
    /// Its items, without those for tests.
    pub items: Vec<Item>,
    /// Its re-exports: the name, and the path behind it.
    pub exports: BTreeMap<String, Vec<String>>,
    /// Names of its own functions.
    pub functions: Vec<String>,
}

/// All modules of a crate.
#[derive(Default)]
pub struct Modules(pub BTreeMap<Name, Module>);

impl Modules {
    /// Reads the modules of a crate from its `src` folder.
    ///
    /// # Errors
    /// When a file cannot be read or is no Rust.
    pub fn read(src: &Path) -> Result<Modules> {
        let mut modules = Modules::default();
        let file = ["lib.rs", "main.rs"].map(|name| src.join(name)).into_iter().find(|path| path.exists());
        let file = file.with_context(|| format!("{}: neither lib.rs nor main.rs", src.display()))?;
        modules.add_file(Vec::new(), &file, src)?;
        Ok(modules)
    }

    fn add_file(&mut self, name: Name, file: &Path, children: &Path) -> Result<()> {
        let text = std::fs::read_to_string(file).with_context(|| file.display().to_string())?;
        let parsed = syn::parse_file(&text).with_context(|| file.display().to_string())?;
        self.add(name, parsed.items, children)
    }

    /// Adds a module whose files of child modules stand in `children`.
    fn add(&mut self, name: Name, items: Vec<Item>, children: &Path) -> Result<()> {
        let mut module = Module::default();
        for item in items {
            if attributes(&item).iter().any(is_for_tests) {
                continue;
            }
            match item {
                Item::Mod(child) => {
                    let mut child_name = name.clone();
                    child_name.push(child.ident.to_string());
                    let below = children.join(child.ident.to_string());
                    match child.content {
                        Some((_, items)) => self.add(child_name, items, &below)?,
                        None => self.add_file(child_name, &file_of(&below), &below)?,
                    }
                }
                other => {
                    match &other {
                        Item::Fn(function) => module.functions.push(function.sig.ident.to_string()),
                        Item::Use(import) if !matches!(import.vis, Visibility::Inherited) => {
                            exports(&import.tree, &mut Vec::new(), &mut module.exports);
                        }
                        _ => {}
                    }
                    module.items.push(other);
                }
            }
        }
        self.0.insert(name, module);
        Ok(())
    }
}

fn file_of(below: &Path) -> PathBuf {
    let plain = below.with_extension("rs");
    if plain.exists() { plain } else { below.join("mod.rs") }
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

fn is_for_tests(attribute: &Attribute) -> bool {
    attribute.path().is_ident("cfg") && {
        let condition = attribute.meta.to_token_stream().to_string();
        condition.contains("test") && !condition.contains("not")
    }
}

/// The names of a re-export, and the paths behind them.
fn exports(tree: &UseTree, path: &mut Vec<String>, found: &mut BTreeMap<String, Vec<String>>) {
    match tree {
        UseTree::Path(step) => {
            path.push(step.ident.to_string());
            exports(&step.tree, path, found);
            path.pop();
        }
        UseTree::Name(name) => {
            let full = [&path[..], &[name.ident.to_string()]].concat();
            found.insert(name.ident.to_string(), full);
        }
        UseTree::Rename(name) => {
            let full = [&path[..], &[name.ident.to_string()]].concat();
            found.insert(name.rename.to_string(), full);
        }
        UseTree::Group(group) => group.items.iter().for_each(|tree| exports(tree, path, found)),
        UseTree::Glob(_) => {}
    }
}
