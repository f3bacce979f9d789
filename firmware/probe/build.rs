//! Links with the probe's own script.

fn main() {
    let folder = std::env::var("CARGO_MANIFEST_DIR").expect("cargo sets it");
    println!("cargo::rustc-link-arg-bins=-T{folder}/probe.x");
    println!("cargo::rerun-if-changed=probe.x");
}
