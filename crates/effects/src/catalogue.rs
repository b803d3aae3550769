//! The list of all effects: one line each.

use crate::{bulk, interface, load_train, sensor, specimen};
use model::Catalogue;
use std::sync::Arc;

/// Every effect this project knows, in the order of the handbook.
pub fn catalogue() -> Catalogue {
    Catalogue::default()
        .with(Arc::new(bulk::Viscoelastic))
        .with(Arc::new(bulk::Mullins))
        .with(Arc::new(bulk::PermanentSet))
        .with(Arc::new(bulk::FiberRecruitment))
        .with(Arc::new(bulk::FiberDamage))
        .with(Arc::new(bulk::StiffnessDrift))
        .with(Arc::new(interface::LawShape))
        .with(Arc::new(interface::Bridging))
        .with(Arc::new(interface::RateDependentStrength))
        .with(Arc::new(interface::Fatigue))
        .with(Arc::new(interface::ResidualOpening))
        .with(Arc::new(interface::Heterogeneity))
        .with(Arc::new(load_train::Compliance))
        .with(Arc::new(load_train::GripSlip))
        .with(Arc::new(load_train::Slack))
        .with(Arc::new(load_train::Misalignment))
        .with(Arc::new(load_train::Backlash))
        .with(Arc::new(specimen::ThicknessTaper))
        .with(Arc::new(specimen::CutLength))
        .with(Arc::new(specimen::Prestretch))
        .with(Arc::new(sensor::Drift))
        .with(Arc::new(sensor::Gain))
        .with(Arc::new(sensor::Lag))
        .with(Arc::new(sensor::Inertia))
        .with(Arc::new(interface::CrackFriction))
        .with(Arc::new(sensor::SelfWeight))
}
