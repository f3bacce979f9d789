//! The number of simultaneous runs.

use std::num::NonZeroUsize;

use anyhow::{Context, Result};
use pneudrive_evaluate::parallel;

/// More threads than this no machine serves better, and some systems do not start.
const MAX: NonZeroUsize = NonZeroUsize::new(256).unwrap();

/// Sets the number of threads of the pool, and returns it; by default, one for each processor.
///
/// # Errors
/// When the system cannot start them.
pub(super) fn prepare(asked: Option<NonZeroUsize>) -> Result<NonZeroUsize> {
    if let Some(threads) = asked {
        let threads = threads.min(MAX);
        if Some(threads) != asked {
            tell!("note: --threads is at most {threads}");
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.get());
        pool.build_global().with_context(|| format!("cannot run on {threads} threads"))?;
    }
    Ok(parallel::threads())
}
