//! A valve is identified by its conductance, critical ratio and null: from a transient and from measured flows.

use std::fs;

use crate::program::{STROKES as TEST, folder, ok, recorded_with};

/// A valve by its data sheet, which leaks a little.
const DATA_SHEET: &str = "\
[valve]
model = \"iso-6358\"
characteristic = \"linear\"
leakage_percent = 1.0
sonic_conductance_m3_per_s_pa = 1.4e-8
critical_ratio = 0.3
";

#[test]
fn conductance_critical_ratio_and_null_of_a_valve_by_its_data_sheet_are_found() {
    let folder = folder();
    let hidden = [
        ("valve.sonic_conductance_m3_per_s_pa", 1.52e-8),
        ("valve.critical_ratio", 0.22),
        ("valve.null_offset_mm", 0.018),
    ];
    recorded_with(folder.path(), &format!("{TEST}{DATA_SHEET}"), &hidden);
    let keys = hidden.map(|(key, _)| key).join(",");
    ok(folder.path(), &format!("identify rig.toml TARGET01.DAT --fit {keys}"));
    let text = fs::read_to_string(folder.path().join("identified/identification.json")).expect("there");
    let json: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!((&json["converged"], &json["fits"]), (&true.into(), &true.into()), "{text}");
    for (i, (key, hidden)) in hidden.into_iter().enumerate() {
        let found = &json["parameters"][i];
        let number = |name: &str| found[name].as_f64().expect("a number");
        let miss = (number("estimate") - hidden).abs();
        println!("{key}: {} for {hidden}, standard error {}", number("estimate"), number("standard_error"));
        assert!(miss < 4.0 * number("standard_error") && miss < 0.01 * hidden, "{key}: {found}");
    }
}

/// Flows of a bench at 7 bar: C = 2 dm3/(s bar), b = 0.25.
#[test]
fn a_table_of_measured_flows_tells_conductance_and_critical_ratio_without_a_model() {
    let folder = folder();
    let rows = (1..=19).map(|i| {
        let ratio = 0.05 * f64::from(i);
        let beyond = ((ratio - 0.25) / 0.75).max(0.0);
        format!("700,{},{}\n", 700.0 * ratio, 840.0 * (1.0 - beyond * beyond).sqrt())
    });
    let table = format!("upstream_kpa,downstream_kpa,flow_l_min\n{}", rows.collect::<String>());
    fs::write(folder.path().join("bench.csv"), table).expect("written");
    let printed = ok(folder.path(), "identify servo-b --conductance bench.csv");
    assert!(printed.contains("valve.sonic_conductance_m3_per_s_pa = 2.0000e-8"), "{printed}");
    assert!(printed.contains("valve.critical_ratio = 0.2500"), "{printed}");
}
