//! Wording of messages.

/// Names for a message: the first few of many.
pub(super) fn few(names: &[&str]) -> String {
    match names {
        [first, second, third, _, more @ ..] => {
            format!("{first}, {second}, {third} and {} more", more.len() + 1)
        }
        names => names.join(", "),
    }
}
