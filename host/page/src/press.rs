//! A drive for the tests: as `rig new` writes it for four figures, with the law that has a model of its drive.

use pneudrive_design::own_drive::rig_file;
use pneudrive_design::question::{Answers, question_of};

/// Its rig file.
pub(crate) fn text() -> String {
    let figures = [
        ("cylinder", "iso-15552-32"),
        ("stroke", "250 mm"),
        ("mass", "8 kg"),
        ("valve", "proportional-5-3-350"),
    ];
    let mut answers = Answers::default();
    for (question, figure) in figures {
        answers.answer(question_of(question).expect("a question"), figure);
    }
    rig_file("press", &answers).expect("a rig file")
}
