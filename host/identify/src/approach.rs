//! From a point to near a minimum, stage by stage: a stroke that is late by more than it takes shows no slope to follow.

use super::least_squares::minimise;
use super::model::FittedModel;

/// Shares of each transient that the fit takes one after the other.
const STAGES: [f64; 3] = [0.35, 0.65, 1.0];

/// From a point to near a minimum; never to where more is left than at the point. The model is rough from then on.
pub(super) fn approach(model: &mut FittedModel, from: Vec<f64>, progress: &mut dyn FnMut(&str)) -> Vec<f64> {
    model.fine = false;
    let mut u = from.clone();
    for share in STAGES {
        model.share = share;
        progress(&format!("the first {:.0} % of each transient", 100.0 * share));
        u = minimise(model, &u, false, progress).map_or(u, |minimum| minimum.u);
    }
    if model.mean_square(&u) <= model.mean_square(&from) { u } else { from }
}
