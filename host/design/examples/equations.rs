//! How far a program that was written from part I of docs/explanation/equations.md alone is from `simulate`, on drives drawn
//! at random.
//!
//! ```text
//! cargo run --release -p pneudrive-design --example equations -- [DRIVES]
//! ```

#[path = "../tests/drawn/mod.rs"]
mod drawn;
#[path = "../tests/independent/mod.rs"]
mod independent;

fn main() {
    let drives = std::env::args().nth(1).map_or(20, |text| text.parse().expect("a number"));
    let (mut position, mut pressure) = (0.0_f64, 0.0_f64);
    for (seed, (rig, run)) in
        (0..).filter_map(|seed| Some((seed, independent::drive(seed, 2.2)?))).take(drives)
    {
        let apart = independent::apart(&rig, &run);
        println!("{seed}: {:.1e} m, {:.1e} Pa to {:.2} s", apart.position, apart.pressure, apart.until);
        (position, pressure) = (position.max(apart.position), pressure.max(apart.pressure));
    }
    println!("{drives} drives: at most {position:.1e} m and {pressure:.1e} Pa apart");
}
