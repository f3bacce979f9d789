//! The page: a summary, and each exhibit with its graphs, its numbers beside the printed ones, and the command that
//! repeats it.

use pneudrive_records::own_file::GENERATOR;

use super::reading::AGREEMENTS;
use super::runs::is_number;
use super::table::{class, table};
use super::{Agreement, Experiment, Shown};
use pneudrive_report::{STYLE, escaped};

/// Title of the page.
#[must_use]
pub fn title() -> &'static str {
    "The thesis, reproduced"
}

/// The whole page. It needs no other file, no script and no network.
#[must_use]
pub fn html(shown: &[Shown]) -> String {
    let sections: String = shown.iter().map(section).collect();
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n{GENERATOR}\n<title>{0}</title>\n<style>{STYLE}{OWN_STYLE}</style>\n</head>\n<body>\n<h1>{0}</h1>\n{1}{2}{sections}</body>\n</html>\n",
        title(),
        summary(shown),
        contents(shown)
    )
}

/// How many numbers and sentences agree, as tiles and as one bar.
fn summary(shown: &[Shown]) -> String {
    let counts = AGREEMENTS.map(|agreement| shown.iter().map(|one| one.count(agreement)).sum::<usize>());
    let all: usize = counts.iter().sum();
    let tile = |(agreement, count): (Agreement, usize)| {
        format!("<div class=\"tile {}\"><b>{count}</b>{}</div>", class(agreement), agreement.word())
    };
    let tiles: String = AGREEMENTS.into_iter().zip(counts).map(tile).collect();
    let part = |(agreement, count): (Agreement, usize)| {
        format!("<i class=\"{}\" style=\"flex:{count}\"></i>", class(agreement))
    };
    let strip: String = AGREEMENTS.into_iter().zip(counts).map(part).collect();
    format!(
        "<p class=\"lead\">{}</p>\n<div class=\"tiles\">{tiles}</div>\n<div class=\"strip\">{strip}</div>\n<p class=\"small\">{all} entries. {LEGEND}</p>\n",
        escaped(&summary_line(shown))
    )
}

/// The text that follows the counts.
const LEGEND: &str = "<b>agrees</b>: the whole range of our figure lies within the tolerance of the printed number, or the share of starts that agree is significantly above two thirds; \
<b>in part</b>: a part of the range does, or some of the starts; <b>cannot be decided</b>: the thesis compares with a measurement or a graph that is lost, or the runs do not show it; \
<b>taken over</b>: our rig file has the number from the thesis. A bar shows the printed number as a tick, its tolerance shaded, and our figure as a dot on its range.";

/// The counts of the numbers and of the sentences, in words.
#[must_use]
pub fn summary_line(shown: &[Shown]) -> String {
    let of = |numbers: bool, agreement: Agreement| {
        let rows = shown.iter().flat_map(Shown::rows).filter(|(entry, _)| !entry.alternative);
        rows.filter(|(entry, reading)| is_number(entry) == numbers && reading.agreement(entry) == agreement)
            .count()
    };
    let told = |numbers: bool| {
        let all: usize = AGREEMENTS.iter().map(|agreement| of(numbers, *agreement)).sum();
        let counts = AGREEMENTS.map(|agreement| (of(numbers, agreement), agreement.of_many()));
        let told: Vec<String> = counts
            .iter()
            .filter(|(count, _)| *count > 0)
            .map(|(count, word)| format!("{count} {word}"))
            .collect();
        let what = if numbers { "printed numbers" } else { "sentences" };
        (all > 0).then(|| format!("{all} {what}: {}.", told.join(", ")))
    };
    [told(true), told(false)].into_iter().flatten().collect::<Vec<_>>().join(" ")
}

fn contents(shown: &[Shown]) -> String {
    let line = |one: &Shown| {
        let dots: String = one
            .rows()
            .filter(|(entry, _)| !entry.alternative)
            .map(|(entry, reading)| format!("<i class=\"{}\"></i>", class(reading.agreement(&entry))))
            .collect();
        format!(
            "<li><a href=\"#{}\"><span>{}</span> {}</a><span class=\"dots\">{dots}</span></li>",
            anchor(one),
            one.exhibit.section,
            escaped(one.exhibit.about)
        )
    };
    format!("<ol class=\"contents\">{}</ol>\n", shown.iter().map(line).collect::<String>())
}

fn anchor(one: &Shown) -> String {
    let text = format!("s{}-{}", one.exhibit.section, one.exhibit.place).to_lowercase();
    text.chars().map(|c| if c.is_ascii_alphanumeric() || c == '.' { c } else { '-' }).collect()
}

fn section(one: &Shown) -> String {
    let exhibit = one.exhibit;
    let place = if exhibit.place.is_empty() { String::new() } else { format!(", {}", exhibit.place) };
    let lost = match exhibit.lost {
        "" => String::new(),
        lost => format!("<p class=\"lost\">Lost from the scan: {}</p>\n", escaped(lost)),
    };
    let charts: String = one.charts.iter().map(super::Chart::svg).collect();
    let why = match exhibit.why {
        "" => String::new(),
        why => format!("<p class=\"why\"><b>What differs, and the likely reason.</b> {}</p>\n", escaped(why)),
    };
    let commands = match exhibit.experiment {
        Experiment::Own(_) => exhibit.commands.join("\n"),
        Experiment::Study(name) => format!("pneudrive study {name} --out DIR"),
    };
    format!(
        "<section id=\"{}\">\n<h2>{}{place} <small>{}</small></h2>\n{lost}{}<div class=\"charts\">{charts}</div>\n{why}<pre>{}</pre>\n</section>\n",
        anchor(one),
        exhibit.section,
        escaped(exhibit.about),
        table(one),
        escaped(&commands)
    )
}

const OWN_STYLE: &str = "\
body{--agrees:#2e7d4f;--part:#c58a14;--differs:#b3382c;--open:#8a8f98;--given:#3a6ea5;line-height:1.4}\
.lead{font-size:1.05rem}.small,.lost,.rests{color:#666;font-size:.8rem}.lost{font-style:italic}\
.tiles{display:flex;gap:.8rem;flex-wrap:wrap}.tile{border-left:4px solid;padding:.2rem .8rem;min-width:6.5rem;font-size:.85rem}\
.tile b{display:block;font-size:1.6rem;line-height:1.1}\
.tile.agrees{border-color:var(--agrees)}.tile.part{border-color:var(--part)}.tile.differs{border-color:var(--differs)}.tile.open{border-color:var(--open)}.tile.given{border-color:var(--given)}\
.strip{display:flex;height:10px;margin:.8rem 0;border-radius:5px;overflow:hidden}\
i.agrees{background:var(--agrees)}i.part{background:var(--part)}i.differs{background:var(--differs)}i.open{background:var(--open)}i.given{background:var(--given)}\
.contents{columns:2;column-gap:2rem;list-style:none;padding:0;font-size:.85rem}\
.contents li{display:flex;justify-content:space-between;gap:.6rem;break-inside:avoid;padding:.1rem 0}\
.contents a{color:#222;text-decoration:none}.contents a span{display:inline-block;min-width:3.4rem;color:#777}\
.dots{white-space:nowrap}.dots i{display:inline-block;width:7px;height:7px;border-radius:50%;margin-left:2px}\
section{border-top:1px solid #ccc;margin-top:1.8rem}h2 small{font-weight:normal;color:#555;margin-left:.5rem}\
section table{font-size:.84rem;margin-bottom:.8rem;display:table;width:100%}th{color:#666;font-weight:600}td small{color:#888}td{vertical-align:top}td.rests{width:17rem;border-left:1px solid #eee}td.says{max-width:18rem}\
tr.alternative td{color:#777}td.figure{white-space:nowrap}.charts{display:flex;flex-wrap:wrap;gap:.4rem 1rem}\
figure{margin:0;flex:1 1 250px;max-width:350px}figcaption{font-size:.82rem;font-weight:600}figure svg{width:100%;height:auto}\
svg text{font-size:10px;fill:#666}svg .mid{text-anchor:middle}svg .end{text-anchor:end}svg .name{fill:#444}\
svg .grid{stroke:#e6e6e6;fill:none}svg polyline{fill:none;stroke-width:1.3;stroke-linejoin:round}\
svg .printed{fill:#e8b64c;opacity:.4}\
.legend{font-size:.74rem;color:#444;display:flex;flex-wrap:wrap;gap:.1rem .8rem}\
.legend i{display:inline-block;width:12px;height:3px;margin-right:4px;vertical-align:middle}.legend i.printed{background:#e8b64c;opacity:.6;height:8px}\
.bar{width:150px;height:18px;display:block}.bar .axis{stroke:#ddd}.bar .tick{stroke:#222;stroke-width:1.6}.bar .range{stroke-width:3;opacity:.55}\
.bar.agrees{color:var(--agrees)}.bar.part{color:var(--part)}.bar.differs{color:var(--differs)}.bar.open{color:var(--open)}\
.bar .range{stroke:currentColor}.bar circle{fill:currentColor}\
.chip{color:#fff;border-radius:3px;padding:0 .4rem;font-size:.76rem;white-space:nowrap}\
.chip.agrees{background:var(--agrees)}.chip.part{background:var(--part)}.chip.differs{background:var(--differs)}.chip.open{background:var(--open)}.chip.given{background:var(--given)}\
.why{font-size:.88rem;background:#f6f6f3;padding:.5rem .8rem}pre{font-size:.76rem;background:#f4f4f4;padding:.5rem .8rem;overflow-x:auto}\
@media(max-width:50rem){.contents{columns:1}}";
