//! Names of columns.

/// A name that can stand in the header of a CSV file.
pub(super) fn plain_name(name: &str) -> Result<(), String> {
    let fits = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
    if !name.is_empty() && name.chars().all(fits) {
        Ok(())
    } else {
        Err("a name may contain only letters, digits, - and _".to_owned())
    }
}
