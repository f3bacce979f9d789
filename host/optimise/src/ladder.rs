//! The models of each component compared: their cost and their effect (thesis 8.3).
//!
//! The reference is the rig with all that its file leaves out or simplifies switched on, as far as no figure is
//! needed that the file lacks. In each variant one component has another model. Costs are counted: evaluations of
//! the right-hand side and solutions of the flows, times of this machine beside them.

use std::time::Duration;

use anyhow::{Result, anyhow, bail};
use pneudrive_records::judged::{Judged, Spacing};
use pneudrive_sim::component::valve::model::Facts;
use pneudrive_sim::component::{friction, operator, valve};
use pneudrive_sim::key::{Choice, Key};
use pneudrive_sim::keys;
use pneudrive_sim::{Accuracy, Convergence, Rig, run};

use crate::ensemble::run_ensemble;
use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_evaluate::deviation::{Deviation, deviations};
use pneudrive_evaluate::range::with_range;
use pneudrive_evaluate::transient::{CHANNELS, POSITION, PRESSURES, Transient};
use pneudrive_report::{COLOURS, Curve, Figure, Look, Page, Panel, Table};

/// A component and its models, the most complete one first: its name, and its keys.
type Component = (&'static str, &'static [(&'static str, &'static [&'static str])]);

/// Those whose models differ in keys of their own. A model that a rig cannot have is left out.
const COMPONENTS: [Component; 8] = [
    (
        "approach velocity",
        &[("counts", &["valve.upstream_mach=true"]), ("neglected", &["valve.upstream_mach=false"])],
    ),
    (
        "flow force",
        &[
            ("analytical", &["valve.flow_force=analytical"]),
            ("experimental", &["valve.flow_force=experimental"]),
            ("none", &["valve.flow_force=none"]),
        ],
    ),
    (
        "discharge",
        &[("constant", &["valve.discharge_model=constant"]), ("Perry", &["valve.discharge_model=perry"])],
    ),
    (
        "tubing",
        &[
            ("empirical", &["tubing.model=empirical"]),
            ("analytical, 1 m", &["tubing.model=analytical"]),
            ("none", &["tubing.model=none"]),
        ],
    ),
    (
        "operator",
        &[("solenoid", &["operator.model=solenoid"]), ("empirical", &["operator.model=solenoid-empirical"])],
    ),
    (
        "friction of the spool",
        &[
            ("stick and slip", &[]),
            ("none", &["operator.static_friction_n=0.0", "operator.coulomb_friction_n=0.0"]),
        ],
    ),
    ("hysteresis", &[("magnetic", &[]), ("none", &["operator.hysteresis_percent=0.0"])]),
    ("controller", &[("sampled", &[]), ("continuous", &["controller.model=continuous"])]),
];

/// How often a variant and the reference are run for their times.
const TIMES: usize = 3;

/// A rig in which one component has another model than the reference, and what its run has cost and changed.
#[derive(Clone, Debug)]
pub struct Variant {
    /// The component; "" for the whole rig.
    pub component: &'static str,
    /// Its model.
    pub model: &'static str,
    /// Evaluations of the right-hand side a sample.
    pub evaluations: f64,
    /// Iterations over the flows a sample.
    pub flow_iterations: f64,
    /// Time of a run over that of the reference, which ran before it each time: for the shortest runs of both, then
    /// the least and the greatest ratio of a pair.
    pub time_over_reference: [f64; 3],
    /// Its deviation from the reference: the nominal run first, then each perturbed run from the same perturbed run
    /// of the reference.
    pub deviations: Vec<Vec<Deviation>>,
    /// The transient.
    pub transient: Transient,
    /// Whether it has converged.
    pub convergence: Convergence,
}

/// A variant that is to be run.
#[derive(Clone, Debug)]
struct Plan {
    component: &'static str,
    model: &'static str,
    rig: Rig,
}

/// Runs the variants of a rig: the reference first, then the file's own models, then each other model of each component,
/// each with its perturbed runs. `clock` gives the time since some instant; `progress` receives the variants done and all.
///
/// # Errors
/// When a variant cannot be simulated, or `progress` wants no more.
pub fn compare(
    source: &(String, String),
    settings: &[String],
    spacing: Spacing,
    clock: impl Fn() -> Duration,
    mut progress: impl FnMut(usize, usize) -> Result<()>,
) -> Result<Vec<Variant>> {
    let plans = plans(source, settings)?;
    let mut runs = Vec::with_capacity(plans.len());
    for plan in &plans {
        runs.push(Runs::of(plan, &plans[0], spacing, &clock)?);
        progress(runs.len(), plans.len())?;
    }
    let references = runs[0].transients.clone();
    let mut variants: Vec<Variant> =
        plans.iter().zip(runs).map(|(plan, runs)| runs.compared(plan, &references)).collect();
    // The effect of the perturbations alone: a model whose difference is no larger shows nothing.
    variants[0].deviations = references.iter().map(|other| deviations(&references[0], other)).collect();
    Ok(variants)
}

/// The runs of a variant.
struct Runs {
    nominal: Judged,
    time_over_reference: [f64; 3],
    /// The nominal one and its perturbed runs'.
    transients: Vec<Transient>,
}

impl Runs {
    fn of(plan: &Plan, reference: &Plan, spacing: Spacing, clock: &impl Fn() -> Duration) -> Result<Runs> {
        let name = if plan.component.is_empty() {
            plan.model.to_owned()
        } else {
            format!("{}: {}", plan.component, plan.model)
        };
        // It runs alone, because other work would distort its time.
        let time_over_reference = timed(plan, reference, clock)?;
        let transient = |rig: &Rig, run: &_| Transient::of_simulation(&name, rig, run);
        let ensemble = run_ensemble(
            &plan.rig,
            Accuracy::of(&plan.rig),
            spacing,
            transient,
            |_, _| {},
            CancelToken::NEVER,
        )?;
        if let Some(why) = ensemble.nominal.lost.failed.first() {
            bail!("{name}: a perturbed run cannot be simulated; write a smaller --change: {why}");
        }
        Ok(Runs { nominal: ensemble.nominal, time_over_reference, transients: ensemble.measured })
    }

    fn compared(mut self, plan: &Plan, references: &[Transient]) -> Variant {
        let run = &self.nominal.run;
        let samples = run.observations.len().max(1) as f64;
        let pairs = references.iter().zip(&self.transients);
        Variant {
            component: plan.component,
            model: plan.model,
            evaluations: run.work.integrator.n_rhs_evaluations as f64 / samples,
            flow_iterations: run.work.network.iterations as f64 / samples,
            time_over_reference: self.time_over_reference,
            deviations: pairs.map(|(reference, transient)| deviations(reference, transient)).collect(),
            convergence: self.nominal.convergence,
            transient: self.transients.swap_remove(0),
        }
    }
}

fn plans(source: &(String, String), settings: &[String]) -> Result<Vec<Plan>> {
    let file = Rig::read_with(&source.0, &source.1, settings)?;
    // The controller knows nothing of another model of its plant.
    let read = |models: &[&str]| {
        let models: Vec<String> = models.iter().map(|&one| one.to_owned()).collect();
        file.with_plant(&models)
    };
    // As far as the rig allows it.
    let valve = with_nodes(&file);
    let mut complete: Vec<&str> = valve.iter().map(String::as_str).collect();
    for (_, models) in COMPONENTS {
        let with: Vec<&str> = complete.iter().chain(models[0].1).copied().collect();
        if applies(&file, models[0].1) && read(&with).is_ok() {
            complete = with;
        }
    }
    let reference = read(&complete)?;
    let mut plans = vec![
        Plan { component: "", model: "complete", rig: reference.clone() },
        Plan { component: "", model: "as in the file", rig: file.clone() },
    ];
    let has_areas = has_areas(&reference);
    plans.extend(others(&reference, "valve", &keys::valve::MODEL, |model: valve::ValveKind| {
        has_areas && model.facts().has_areas()
    }));
    for (component, models) in COMPONENTS {
        for (model, keys) in &models[1..] {
            let with: Vec<&str> = complete.iter().chain(*keys).copied().collect();
            if applies(&reference, keys)
                && let Ok(rig) = read(&with)
                && differ(&rig, &reference)
            {
                plans.push(Plan { component, model, rig });
            }
        }
    }
    plans.extend(others(
        &reference,
        "friction of the load",
        &keys::friction::FRICTION,
        |_: friction::FrictionKind| true,
    ));
    Ok(plans)
}

/// The most complete model of a valve that is known by its areas.
fn with_nodes(rig: &Rig) -> Option<String> {
    let complete = |facts: Facts| facts.has_areas() && facts.has_node && !facts.replaces_tubes;
    let model = valve::ValveKind::ALL.iter().find(|model| complete(model.facts()))?;
    has_areas(rig).then(|| keys::valve::MODEL.setting(model.word()))
}

fn has_areas(rig: &Rig) -> bool {
    rig.get(&keys::valve::MODEL).facts().has_areas()
}

/// The variants with the other models that a key chooses among.
fn others<C: Choice>(
    reference: &Rig,
    component: &'static str,
    key: &Key,
    may: impl Fn(C) -> bool,
) -> Vec<Plan> {
    let own = reference.word_at(key.path);
    let others = C::WORDS.iter().map(|(word, _)| *word).filter(|word| Some(*word) != own);
    let plan = |model: &'static str| {
        let rig = reference.with_plant(&[key.setting(model)]).ok()?;
        Some(Plan { component, model, rig })
    };
    others.filter(|word| C::of_word(word).is_some_and(&may)).filter_map(plan).collect()
}

/// Whether a value that one of two rigs uses is another one in the other.
fn differ(rig: &Rig, other: &Rig) -> bool {
    rig.entries().any(|(key, value)| other.value(key.path) != Some(value))
}

/// Whether the keys mean something on a rig as it is: an operator that it has, a valve that has a node.
fn applies(rig: &Rig, settings: &[&str]) -> bool {
    let operator = rig.get(&keys::operator::MODEL);
    let flow_force = keys::flow_force::FLOW_FORCE.path;
    settings.iter().all(|setting| match setting.split_once('=') {
        Some((path, "none")) if path == flow_force => true,
        Some((path, _)) if [flow_force, keys::operator::MODEL.path].contains(&path) => operator.is_solenoid(),
        Some((path, _)) if path.split('.').next() == Some(keys::operator::MODEL.table()) => {
            operator == operator::OperatorKind::Solenoid
        }
        _ => true,
    })
}

/// [`Variant::time_over_reference`]. Whatever else the machine does meets both runs of a pair, or shows as a range.
fn timed(plan: &Plan, reference: &Plan, clock: &impl Fn() -> Duration) -> Result<[f64; 3]> {
    let once = |plan: &Plan| {
        let begun = clock();
        run(&plan.rig, Accuracy::of(&plan.rig))
            .map_err(|error| anyhow!("{} {}: {error}", plan.component, plan.model))?;
        Ok::<_, anyhow::Error>((clock() - begun).as_secs_f64())
    };
    let pairs: Vec<[f64; 2]> =
        (0..TIMES).map(|_| Ok([once(reference)?, once(plan)?])).collect::<Result<_>>()?;
    Ok(ratios(&pairs))
}

/// Of pairs of times the ratio of the shortest ones, then the least and the most ratio of a pair; the first lies between
/// the others.
fn ratios(pairs: &[[f64; 2]]) -> [f64; 3] {
    let shortest = |which: usize| pairs.iter().map(|pair| pair[which]).fold(f64::INFINITY, f64::min);
    let all = pairs.iter().map(|[reference, own]| own / reference);
    [shortest(1) / shortest(0), all.clone().fold(f64::INFINITY, f64::min), all.fold(0.0, f64::max)]
}

/// The page.
#[must_use]
pub fn page(name: &str, variants: &[Variant]) -> Page {
    let cost = Figure {
        heading: "cost and effect of each model".to_owned(),
        across: "evaluations of the right-hand side per sample".to_owned(),
        panels: vec![Panel {
            title: "largest difference of the position, mm".to_owned(),
            curves: variants[1..].iter().map(place).collect(),
            ..Panel::default()
        }],
        ..Figure::default()
    };
    let drawn = [POSITION, PRESSURES[0], PRESSURES[1]].map(|channel| {
        let curves = variants.iter().zip(COLOURS.iter().cycle()).map(|(variant, colour)| {
            let transient = &variant.transient;
            let (x, y) = (transient.time.clone(), transient.channels[channel].clone());
            Curve { colour: Some(colour), ..Curve::new(&transient.name, x, y) }
        });
        Panel::new(&format!("{}, {}", CHANNELS[channel].0, CHANNELS[channel].1), curves.collect())
    });
    let transients = Figure { heading: "transients".to_owned(), ..Figure::over_time(drawn.to_vec()) };
    Page {
        title: format!("{name}: the models of its components"),
        notes: vec![
            "The reference has every model in the most complete form for which the rig file has figures. In each variant one component has another model, with defaults for the keys that the file lacks; its transient is compared with that of the reference. In closed loop the controller reduces a difference of the position; --set controller.loop=open, with moves as commands, shows it without a controller.".to_owned(),
            "In brackets: the range over perturbed runs of both, whose mass and starting position differ very slightly. The first row shows how far the perturbed runs of the reference are from it: a difference of that size says nothing about a model.".to_owned(),
            format!("Evaluations and iterations are counted and the same on every machine. Times are of the machine that made this page, relative to the reference, which was run beside each variant: the ratio of the shortest of {TIMES} runs of both and, in brackets, the least and the largest ratio of a pair. A wide range means that the machine was busy."),
        ],
        tables: vec![table(variants)],
        figures: vec![cost, transients],
        ..Page::default()
    }
}

fn place(variant: &Variant) -> Curve {
    let x = vec![variant.evaluations];
    Curve { look: Look::Points, ..Curve::new(&variant.transient.name, x, vec![largest(variant, POSITION)]) }
}

/// A figure of the deviation of a channel, in each run of the ensemble.
fn figures(variant: &Variant, channel: usize, figure: impl Fn(&Deviation) -> f64) -> Vec<Option<f64>> {
    let of =
        |found: &Vec<Deviation>| found.iter().find(|one| one.channel == CHANNELS[channel].0).map(&figure);
    variant.deviations.iter().map(of).collect()
}

fn largest(variant: &Variant, channel: usize) -> f64 {
    figures(variant, channel, |one| one.largest).first().copied().flatten().unwrap_or(f64::NAN)
}

/// The variants in figures.
#[must_use]
pub fn table(variants: &[Variant]) -> Table {
    let columns = [
        "component",
        "model",
        "evaluations per sample",
        "flow iterations per sample",
        "time, %",
        "position rms, mm",
        "largest, mm",
        "P1 rms, kPa",
        "P2 rms, kPa",
        "converged",
    ];
    let rms = |variant: &Variant, channel: usize, decimals: usize| {
        with_range(&figures(variant, channel, |one| one.mean_square.sqrt()), decimals)
    };
    let row = |variant: &Variant| {
        vec![
            if variant.component.is_empty() { "all".to_owned() } else { variant.component.to_owned() },
            variant.model.to_owned(),
            format!("{:.1}", variant.evaluations),
            format!("{:.1}", variant.flow_iterations),
            with_range(&variant.time_over_reference.map(|time| Some(100.0 * time)), 0),
            rms(variant, POSITION, 4),
            with_range(&figures(variant, POSITION, |one| one.largest), 4),
            rms(variant, PRESSURES[0], 3),
            rms(variant, PRESSURES[1], 3),
            if variant.convergence.is_converged() { "yes" } else { "no" }.to_owned(),
        ]
    };
    Table::new("models of the components, one at a time", columns, variants.iter().map(row))
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneudrive_sim::rigfile::{BUILTIN, builtin};

    fn source(rig: &str) -> (String, String) {
        (rig.to_owned(), builtin(rig).expect("a built-in rig").to_owned())
    }

    #[test]
    fn each_rung_is_the_reference_with_one_component_changed() {
        for (name, _) in BUILTIN {
            let plans = plans(&source(name), &[]).unwrap_or_else(|error| panic!("{name}: {error:#}"));
            assert_eq!((plans[0].model, plans[1].model), ("complete", "as in the file"));
            let least = if has_areas(&plans[0].rig) { 6 } else { 5 };
            assert!(plans.len() >= least, "{name}: {}", plans.len());
            for variant in &plans[2..] {
                let value = |rig: &Rig, path| rig.value(path).cloned();
                let changed: Vec<&str> = variant
                    .rig
                    .entries()
                    .filter(|(key, new)| value(&plans[0].rig, key.path).as_ref() != Some(new))
                    .map(|(key, _)| key.path)
                    .collect();
                assert!((1..=2).contains(&changed.len()), "{name}, {}: {changed:?}", variant.model);
            }
        }
    }

    #[test]
    fn a_model_of_the_plant_is_unknown_to_the_controller() {
        for (name, _) in BUILTIN {
            let file = Rig::builtin(name).expect("a built-in rig");
            for plan in plans(&source(name), &[]).expect("variants") {
                let is_own = plan.component == "controller";
                let knows = plan.rig.parameters() == file.parameters();
                assert!(knows || is_own, "{name}, {}: {}", plan.component, plan.model);
                assert_eq!(plan.rig.knows_its_drive(), file.knows_its_drive(), "{name}: {}", plan.model);
            }
        }
    }

    #[test]
    fn a_time_is_that_of_the_shortest_runs_with_the_range_of_the_pairs() {
        assert_eq!(ratios(&[[2.0, 1.0], [1.0, 3.0], [8.0, 16.0]]), [1.0, 0.5, 3.0]);
    }

    #[test]
    fn an_operator_without_its_spool_costs_less_and_every_other_model_changes_something() {
        let settings = ["test.duration_s=0.4".to_owned()];
        let spacing = Spacing { runs: 2, ..Spacing::default() };
        let begun = std::time::Instant::now();
        let clock = || begun.elapsed();
        let variants =
            compare(&source("servo-b-tuned"), &settings, spacing, clock, |_, _| Ok(())).expect("runs");
        assert_eq!(largest(&variants[0], POSITION), 0.0, "the reference is itself");
        assert!(variants[0].deviations.len() == 2 && variants[0].convergence.is_converged());
        let empirical = variants.iter().find(|variant| variant.component == "operator").expect("a variant");
        assert!(empirical.evaluations < variants[0].evaluations / 2.0, "{:.1}", empirical.evaluations);
        for variant in variants[1..].iter() {
            assert!(largest(variant, POSITION) > 0.01, "{}: {}", variant.component, variant.model);
        }
        assert_eq!(table(&variants).rows.len(), variants.len());
    }
}
