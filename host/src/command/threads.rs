//! How many runs go on at the same time.

use std::num::NonZeroUsize;

use anyhow::{Context, Result};
use pneudrive_analysis::parallel;

/// Gives the pool as many threads as are asked for, and tells how many it has: without being asked, one for each
/// processor.
///
/// # Errors
/// When the system has no room for them.
pub(super) fn prepare(asked: Option<NonZeroUsize>) -> Result<NonZeroUsize> {
    if let Some(threads) = asked {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.get());
        pool.build_global().with_context(|| format!("cannot run on {threads} threads"))?;
    }
    Ok(parallel::threads())
}
