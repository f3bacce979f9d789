//! Models of the valve, and what the rest asks of one. A model is a file and its line in `models!`.
//!
//! All else goes by the [`Facts`] of a model, its laws of flow and its opening: no other code names a model.

use crate::component::valve::characteristic::Characteristic;
use crate::component::valve::flow_law::FlowLaw;
use crate::component::valve::flow_map::FlowMap;
use crate::key::{Key, words};
use crate::values::{Findings, Rig};

/// What is known of the paths of a valve, each from the supply or the exhaust to a port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Paths {
    /// The areas of lands, with coefficients of discharge.
    Areas,
    /// Their conductances when open; the characteristic of the rig tells how they follow the spool.
    Conductances,
    /// The model itself tells all.
    Own,
}

/// The properties of a model, whatever the values of a rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Facts {
    /// What is known of its paths.
    pub paths: Paths,
    /// Whether a spool opens them, with a null that may lie off the middle.
    pub has_spool: bool,
    /// Whether each port has a small volume between its lands and its bore.
    pub has_node: bool,
    /// Whether a restriction at the cylinder takes the place of each tube.
    pub replaces_tubes: bool,
    /// The words of the operators that it can have; empty: all.
    pub operators: &'static [&'static str],
}

impl Facts {
    /// A spool with lands of known areas, without nodes.
    pub const AREAS: Facts = Facts {
        paths: Paths::Areas,
        has_spool: true,
        has_node: false,
        replaces_tubes: false,
        operators: &[],
    };
    /// A spool with paths of known conductances, which have the losses of the ports in them.
    pub const CONDUCTANCES: Facts = Facts { paths: Paths::Conductances, ..Facts::AREAS };

    /// Whether lands open its paths.
    #[must_use]
    pub const fn has_lands(&self) -> bool {
        !matches!(self.paths, Paths::Own)
    }

    /// Whether its lands are known by their areas.
    #[must_use]
    pub const fn has_areas(&self) -> bool {
        matches!(self.paths, Paths::Areas)
    }
}

/// How the paths of a valve open over its spool.
#[derive(Clone, Debug)]
pub enum Opening {
    /// As the areas of its lands.
    Areas,
    /// By shares of their conductances.
    Shares(Characteristic),
    /// As was measured.
    Map(FlowMap),
}

/// What a drive asks of a model of the valve.
pub trait ValveModel {
    /// What does not depend on the values of a rig.
    const FACTS: Facts;

    /// What the paths to the supply and to the exhaust are, fully open.
    fn laws(rig: &Rig) -> [FlowLaw; 2] {
        FlowLaw::of_areas(rig)
    }

    /// How the paths open, where no characteristic of the rig tells.
    fn opening(_rig: &Rig) -> Opening {
        Opening::Areas
    }

    /// The bore of the restriction that takes the place of a tube, m, where the model has a figure of its own.
    fn connector_bore(_rig: &Rig) -> Option<f64> {
        None
    }

    /// The constraints on the keys of the model.
    fn check(_rig: &Rig, _findings: &mut Findings) {}
}

/// Lists the models: each with its word in a rig file, its file and its type. Keys, checks and calls follow from the list.
macro_rules! models {
    ($($word:literal => $name:ident($file:ident), $about:literal;)+) => {
        $(pub mod $file;)+

        words! {
            /// How the flows through the valve are formed.
            pub enum ValveKind {
                $(#[doc = $about] $name = $word,)+
            }
        }

        /// The words of the models, and what is known of each.
        const ALL: &[(&str, Facts)] = &[$(($word, <$file::$name as ValveModel>::FACTS)),+];

        /// The keys of all models.
        pub(crate) static KEYS: &[&[&Key]] = &[$($file::keys::ALL),+];

        impl ValveKind {
            /// All of them.
            pub const ALL: &[ValveKind] = &[$(ValveKind::$name),+];

            /// What does not depend on the values of a rig.
            #[must_use]
            pub const fn facts(self) -> Facts {
                match self { $(ValveKind::$name => <$file::$name as ValveModel>::FACTS,)+ }
            }

            /// What the paths to the supply and to the exhaust of a rig are, fully open.
            #[must_use]
            pub fn laws(self, rig: &Rig) -> [FlowLaw; 2] {
                match self { $(ValveKind::$name => $file::$name::laws(rig),)+ }
            }

            /// How the paths of a rig open, where no characteristic tells.
            pub(super) fn opening(self, rig: &Rig) -> Opening {
                match self { $(ValveKind::$name => $file::$name::opening(rig),)+ }
            }

            /// The bore of the restriction in place of a tube, m, where the model has a figure of its own.
            pub(crate) fn connector_bore(self, rig: &Rig) -> Option<f64> {
                match self { $(ValveKind::$name => $file::$name::connector_bore(rig),)+ }
            }

            pub(super) fn check(self, rig: &Rig, findings: &mut Findings) {
                match self { $(ValveKind::$name => $file::$name::check(rig, findings),)+ }
            }
        }
    };
}

/// The words of the models of which something holds.
macro_rules! words_where {
    ($about:literal $name:ident: |$facts:ident| $holds:expr) => {
        #[doc = $about]
        pub(crate) const $name: &[&str] = {
            const COUNT: usize = {
                let (mut count, mut i) = (0, 0);
                while i < ALL.len() {
                    let $facts = &ALL[i].1;
                    count += $holds as usize;
                    i += 1;
                }
                count
            };
            const WORDS: [&str; COUNT] = {
                let (mut words, mut count, mut i) = ([""; COUNT], 0, 0);
                while i < ALL.len() {
                    let $facts = &ALL[i].1;
                    if $holds {
                        words[count] = ALL[i].0;
                        count += 1;
                    }
                    i += 1;
                }
                words
            };
            &WORDS
        };
    };
}

words_where!("Models whose lands have areas." WITH_AREAS: |facts| facts.has_areas());
words_where!("Models by the conductances of their paths." WITH_CONDUCTANCES: |facts| matches!(facts.paths, Paths::Conductances));
words_where!("Models with a node between lands and port, and with tubes." WITH_NODES_AND_TUBES: |facts| facts.has_node && !facts.replaces_tubes);
words_where!("Models with lands." WITH_LANDS: |facts| facts.has_lands());
words_where!("Models with a spool." WITH_SPOOL: |facts| facts.has_spool);
words_where!("Models with restrictions in place of tubes." WITH_CONNECTORS: |facts| facts.replaces_tubes);
words_where!("Models with tubes." WITH_TUBES: |facts| !facts.replaces_tubes);
words_where!("Models with flow nodes." WITH_NODES: |facts| facts.has_node);

models! {
    "flow-node" => FlowNode(flow_node), "Each port has a small volume between its lands and its bore.";
    "single-restriction" => SingleRestriction(single_restriction), "The lands are all there is.";
    "multiple-flow-node" => MultipleFlowNode(multiple_flow_node), "As the flow node, with a restriction in place of each tube to the cylinder.";
    "iso-6358" => ByConductance(by_conductance), "The lands are components by their conductance.";
    "flow-map" => ByMap(by_map), "The lands have a measured map.";
    "poppet" => Poppet(poppet), "Seats, each by its conductance, that open on or off.";
}
