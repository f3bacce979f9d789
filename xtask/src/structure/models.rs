//! Models of a component of which each has a file: no other source names one. All else asks a model through the trait of
//! its component, so that a model more is a file and its line in `models!`.
//!
//! Refused are the variant of the list's enumeration (`ValveKind::FlowNode`), and the word of the rig file as a literal
//! (`"flow-node"`, in the crate of the list) or as a setting (`valve.model=flow-node`, in all crates).

use std::path::Path;

use anyhow::{Context, Result};
use proc_macro2::{TokenStream, TokenTree};
use quote::ToTokens;
use syn::Item;

use super::module::{Modules, Name};
use super::paths::shown;

/// A component with a list of models.
struct Component {
    /// Its crate.
    home: &'static str,
    /// The module of the list.
    list: &'static [&'static str],
    /// The key that has their words.
    key: &'static str,
    /// The enumeration of them.
    kind: &'static str,
}

const COMPONENTS: [Component; 2] = [
    Component { home: "sim", list: &["component", "valve", "model"], key: "valve.model", kind: "ValveKind" },
    Component { home: "sim", list: &["component", "friction"], key: "load.friction", kind: "FrictionKind" },
];

/// A model as its list has it.
struct Model {
    word: String,
    variant: String,
    file: String,
}

/// Where a model is named outside of its file, in all crates of these folders.
///
/// # Errors
/// When a source cannot be read, or a list is not found.
pub fn named_elsewhere(root: &Path, crates: &[&str]) -> Result<Vec<String>> {
    let mut broken = Vec::new();
    for component in &COMPONENTS {
        let &Component { home, list, .. } = component;
        let at_home = Modules::read(&root.join(home).join("src"))?;
        let list: Name = list.iter().map(|step| (*step).to_owned()).collect();
        let models =
            listed(&at_home, &list).with_context(|| format!("{home}: no models! in {}", shown(&list)))?;
        for folder in crates {
            let is_home = *folder == home;
            let modules = if is_home { &at_home } else { &Modules::read(&root.join(folder).join("src"))? };
            let found = in_crate(modules, &models, is_home.then_some(&list), component);
            broken.extend(found.into_iter().map(|text| format!("{folder}: {text}")));
        }
    }
    Ok(broken)
}

/// What names a model in the modules of a crate; `list` is the module of the list, if it is in this crate.
fn in_crate(modules: &Modules, models: &[Model], list: Option<&Name>, component: &Component) -> Vec<String> {
    let mut broken = Vec::new();
    for (name, module) in &modules.0 {
        let own = list.and_then(|list| name.strip_prefix(&list[..]));
        if own.is_some_and(<[String]>::is_empty) {
            continue;
        }
        let own = own.and_then(<[String]>::first);
        let mut tokens = Vec::new();
        module.items.iter().for_each(|item| flatten(item.to_token_stream(), &mut tokens));
        for model in models.iter().filter(|model| own != Some(&model.file)) {
            if names(&tokens, model, list.is_some(), component) {
                broken.push(format!("{} names the model {:?} of {}", shown(name), model.word, component.key));
            }
        }
    }
    broken
}

/// Whether the tokens name a model.
fn names(tokens: &[String], model: &Model, is_home: bool, component: &Component) -> bool {
    let (word, key) = (&model.word, component.key);
    let literal = format!("{word:?}");
    let settings = [format!("{key}={word}"), format!("{key} = \\\"{word}"), format!("{key}=\\\"{word}")];
    let variant = [component.kind, ":", ":", &model.variant];
    tokens.windows(variant.len()).any(|some| some == variant)
        || tokens.iter().filter(|token| token.starts_with('"')).any(|token| {
            (is_home && *token == literal) || settings.iter().any(|setting| token.contains(setting.as_str()))
        })
}

/// The models of the list in a module.
fn listed(modules: &Modules, name: &Name) -> Option<Vec<Model>> {
    let mut lists = modules.0.get(name)?.items.iter().filter_map(|item| match item {
        Item::Macro(call) if call.mac.path.is_ident("models") => Some(call.mac.tokens.clone()),
        _ => None,
    });
    let mut tokens = Vec::new();
    flatten(lists.next_back()?, &mut tokens);
    // "word" => Variant(file), ... or "word" => Variant(file::Type), ...
    let lines = tokens.windows(5).filter(|some| some[1] == "=" && some[2] == ">");
    let model = |some: &[String]| Model {
        word: some[0].trim_matches('"').to_owned(),
        variant: some[3].clone(),
        file: some[4].clone(),
    };
    Some(lines.map(model).collect())
}

/// The tokens in their order, without groups and attributes.
fn flatten(stream: TokenStream, found: &mut Vec<String>) {
    let mut tokens = stream.into_iter().peekable();
    while let Some(token) = tokens.next() {
        match token {
            TokenTree::Punct(sign) if sign.as_char() == '#' => {
                tokens.next_if(|next| matches!(next, TokenTree::Group(_)));
            }
            TokenTree::Group(group) => flatten(group.stream(), found),
            other => found.push(other.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::named_elsewhere;

    const LIST: &str = r#"
        mod plain;
        models! { "plain-bore" => Plain(plain), "A bore."; }
    "#;

    const FRICTIONS: &str = r#"
        mod dry;
        models! { "none-at-all" => Dry(dry::None), "Nothing."; }
    "#;

    /// What is found in a crate `sim` whose module `network` is this text, and in a crate `host` of that one.
    fn found(network: &str, host: &str) -> Vec<String> {
        let folder = tempfile::tempdir().expect("a folder");
        for (path, text) in [
            ("sim/src/lib.rs", "mod component; mod network;"),
            ("sim/src/component.rs", "mod valve; mod friction;"),
            ("sim/src/component/valve.rs", "mod model;"),
            ("sim/src/component/valve/model.rs", LIST),
            ("sim/src/component/valve/model/plain.rs", "const MODEL: ValveKind = ValveKind::Plain;"),
            ("sim/src/component/friction.rs", FRICTIONS),
            ("sim/src/component/friction/dry.rs", "const MODEL: FrictionKind = FrictionKind::Dry;"),
            ("sim/src/network.rs", network),
            ("host/src/lib.rs", host),
        ] {
            let path = folder.path().join(path);
            fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            fs::write(path, text).expect("a file");
        }
        named_elsewhere(folder.path(), &["sim", "host"]).expect("sources")
    }

    #[test]
    fn a_model_is_named_in_its_file_and_in_its_list_only() {
        assert!(found("fn of() {}", "").is_empty());
        for (network, host) in [
            ("fn of(m: ValveKind) -> bool { matches!(m, ValveKind::Plain | ValveKind::Other) }", ""),
            ("fn of(word: &str) -> bool { [\"plain-bore\"].contains(&word) }", ""),
            ("", "fn of(m: valve::ValveKind) -> bool { m == valve::ValveKind::Plain }"),
            ("", "const SETTING: &str = \"valve.model=plain-bore\";"),
        ] {
            let found = found(network, host);
            assert_eq!(found.len(), 1, "{network}{host}: {found:?}");
            assert!(found[0].ends_with("names the model \"plain-bore\" of valve.model"), "{found:?}");
        }
    }

    #[test]
    fn a_model_of_another_list_is_found_as_well() {
        let told = "sim: network names the model \"none-at-all\" of load.friction";
        assert_eq!(found("fn of(f: FrictionKind) -> bool { f == FrictionKind::Dry }", ""), [told]);
        assert_eq!(found("const SETTING: &str = \"load.friction=none-at-all\";", ""), [told]);
    }

    #[test]
    fn docs_tests_and_words_of_other_crates_may_name_a_model() {
        let network = "/// As with valve.model=plain-bore.\nfn of() {}\n#[cfg(test)] mod tests { fn of() { ValveKind::Plain } }";
        assert!(found(network, "const QUESTION: &str = \"plain-bore\";").is_empty());
    }
}
