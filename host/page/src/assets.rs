//! The files of the page, embedded in the program, so that it works offline.

const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";

macro_rules! asset {
    ($name:literal, $kind:expr) => {
        ($name, $kind, include_str!(concat!("../web/", $name)))
    };
}

/// The files of the page: name, media type, content.
pub const ASSETS: &[(&str, &str, &str)] = &[
    asset!("index.html", HTML),
    asset!("colours.css", CSS),
    asset!("controls.css", CSS),
    asset!("studio.css", CSS),
    asset!("inspector.css", CSS),
    asset!("commission.css", CSS),
    asset!("figures.css", CSS),
    asset!("picture.css", CSS),
    asset!("comparison.css", CSS),
    asset!("report.css", CSS),
    asset!("study.css", CSS),
    asset!("studio.js", SCRIPT),
    asset!("server.js", SCRIPT),
    asset!("answer.js", SCRIPT),
    asset!("header.js", SCRIPT),
    asset!("history.js", SCRIPT),
    asset!("simulation.js", SCRIPT),
    asset!("inspector.js", SCRIPT),
    asset!("key-list.js", SCRIPT),
    asset!("field.js", SCRIPT),
    asset!("slider.js", SCRIPT),
    asset!("picture.js", SCRIPT),
    asset!("components.js", SCRIPT),
    asset!("svg.js", SCRIPT),
    asset!("plot.js", SCRIPT),
    asset!("panel.js", SCRIPT),
    asset!("scale.js", SCRIPT),
    asset!("vector.js", SCRIPT),
    asset!("figures.js", SCRIPT),
    asset!("records.js", SCRIPT),
    asset!("runs.js", SCRIPT),
    asset!("spectrum.js", SCRIPT),
    asset!("difference.js", SCRIPT),
    asset!("toolbar.js", SCRIPT),
    asset!("report.js", SCRIPT),
    asset!("dialog.js", SCRIPT),
    asset!("commission.js", SCRIPT),
    asset!("orders.js", SCRIPT),
    asset!("measures.js", SCRIPT),
    asset!("save.js", SCRIPT),
    asset!("scope.js", SCRIPT),
    asset!("state-line.js", SCRIPT),
    asset!("recent.js", SCRIPT),
    asset!("trigger.js", SCRIPT),
    asset!("parameters.js", SCRIPT),
    asset!("bring-up.js", SCRIPT),
    asset!("export.js", SCRIPT),
    asset!("incoming.js", SCRIPT),
    asset!("player.js", SCRIPT),
    asset!("views.js", SCRIPT),
    asset!("study.js", SCRIPT),
    asset!("sweep-form.js", SCRIPT),
    asset!("tune-form.js", SCRIPT),
    asset!("identify-form.js", SCRIPT),
    asset!("numbers.js", SCRIPT),
    asset!("exhibit.js", SCRIPT),
    asset!("chart.js", SCRIPT),
    asset!("parallel.js", SCRIPT),
    asset!("axis.js", SCRIPT),
];
