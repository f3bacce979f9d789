//! Chapter 7 of the thesis: validation of the models.

mod accuracy;
mod drives;
mod friction;
mod operator;
mod parts;
mod published;
mod spectra;
mod valve;

use super::Exhibit;

/// Its exhibits, in its order.
pub(super) const EXHIBITS: [&[Exhibit]; 8] = [
    &valve::EXHIBITS,
    &operator::EXHIBITS,
    &spectra::EXHIBITS,
    &friction::EXHIBITS,
    &parts::EXHIBITS,
    &drives::EXHIBITS,
    &accuracy::EXHIBITS,
    &published::EXHIBITS,
];
