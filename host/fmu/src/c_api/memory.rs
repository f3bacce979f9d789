//! Arrays and texts of an importer.

use std::ffi::{CStr, c_char};
use std::slice;

use anyhow::{Context, Result, bail};

/// A text of an importer.
///
/// # Safety
/// It ends with a zero, or is null.
pub unsafe fn text<'a>(text: *const c_char) -> Result<&'a str> {
    if text.is_null() {
        bail!("it is null");
    }
    // SAFETY: it is not null, and ends with a zero as this function requires.
    unsafe { CStr::from_ptr(text) }.to_str().context("it is not UTF-8")
}

/// An array of an importer; one of no entries may be null.
///
/// # Safety
/// It has this many entries, or is null.
pub unsafe fn array<'a, T>(entries: *const T, count: usize) -> Result<&'a [T]> {
    if count == 0 {
        return Ok(&[]);
    }
    check(entries, count)?;
    // SAFETY: it is aligned and not null, and has as many entries as this function requires.
    Ok(unsafe { slice::from_raw_parts(entries, count) })
}

/// The same to be written.
///
/// # Safety
/// It has this many entries that nobody else uses meanwhile, or is null.
pub unsafe fn array_mut<'a, T>(entries: *mut T, count: usize) -> Result<&'a mut [T]> {
    if count == 0 {
        return Ok(&mut []);
    }
    check(entries, count)?;
    // SAFETY: it is aligned and not null, and has as many entries as this function requires.
    Ok(unsafe { slice::from_raw_parts_mut(entries, count) })
}

/// The checks of an array without access to it.
fn check<T>(entries: *const T, count: usize) -> Result<()> {
    if entries.is_null() {
        bail!("an array of {count} entries is null");
    }
    if !entries.is_aligned()
        || count.checked_mul(size_of::<T>()).is_none_or(|size| isize::try_from(size).is_err())
    {
        bail!("an array of {count} entries is where none can be");
    }
    Ok(())
}

/// Writes a value for an importer that wants it.
///
/// # Safety
/// `place` is null or may be written to.
pub unsafe fn put<T>(place: *mut T, value: T) {
    if !place.is_null() {
        // SAFETY: as this function requires.
        unsafe { place.write(value) };
    }
}
