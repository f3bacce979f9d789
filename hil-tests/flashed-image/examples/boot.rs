//! Boots the image and tells how far it came.

use std::path::Path;

use pneudrive_flashed_image::bench::Bench;
use pneudrive_flashed_image::board::Board;
use pneudrive_flashed_image::image::Image;
use pneudrive_flashed_image::peripheral::flash;
use pneudrive_flashed_image::processor::Processor;
use pneudrive_flashed_image::time::{FAST, MILLISECOND};
use pneudrive_sim::Rig;

fn main() -> anyhow::Result<()> {
    let path = std::env::args().nth(1).expect("an image");
    let mut cells = vec![0xff; flash::BYTES];
    Image::read(Path::new(&path))?.flash(&mut cells);
    let bench = Bench::new(&Rig::builtin("servo-b").expect("a rig")).map_err(anyhow::Error::msg)?;
    let mut processor = Processor::new(Board::new(cells, bench, FAST))?;
    let begun = std::time::Instant::now();
    for k in 1..=200 {
        if let Err(stop) = processor.run(k * 10 * MILLISECOND) {
            println!("{stop:?}");
            break;
        }
    }
    let board = processor.board();
    println!("{} us in {:?}, {:?}, said {:?} {:?}", board.microseconds(), begun.elapsed(), board.lateness, board.said, board.faults);
    Ok(())
}
