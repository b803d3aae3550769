//! Whether a noise level is one that its record can have.

use super::section::Section;
use crate::case::{Record, Test};
use crate::diagnostics::Report;
use crate::keys::plain;

/// Least noise, as a share of the record's largest value: no load cell and no camera is better than a part in a million,
/// and the model is not computed to it.
pub(crate) const LEAST_SHARE: f64 = 1e-6;
/// Largest noise, as a share of the largest value: above it there is nothing but noise.
pub(crate) const LARGEST_SHARE: f64 = 10.0;

/// Reports every given standard deviation that its channel cannot have.
pub(super) fn check_noise(s: &Section<'_>, test: &Test, record: &Record) {
    let camera = |c: &Option<Vec<Option<f64>>>| c.iter().flatten().flatten().copied().collect();
    let channels: [(&str, Option<f64>, Vec<f64>); 5] = [
        ("force_sd", test.force_sd, record.force.clone()),
        ("force_x_sd", test.force_x_sd, camera(&record.force_x)),
        ("grip_displacement_sd", test.grip_displacement_sd, camera(&record.grip_displacement)),
        ("tear_front_sd", test.tear_front_sd, camera(&record.tear_front)),
        ("width_change_sd", test.width_change_sd, camera(&record.width_change)),
    ];
    for (name, sd, values) in channels {
        let largest = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let (Some(sd), Some(entry)) = (sd.filter(|_| largest > 0.0), s.entry(name)) else { continue };
        let share = sd / largest;
        if (LEAST_SHARE..=LARGEST_SHARE).contains(&share) {
            continue;
        }
        let shown = |x: f64| plain(x / entry.factor);
        let message = format!(
            "`{}` is {}, {share:.0e} of the record's largest value, {}; expected {LEAST_SHARE:.0e} to {LARGEST_SHARE} of it, {} to {}",
            entry.written,
            shown(sd),
            shown(largest),
            shown(LEAST_SHARE * largest),
            shown(LARGEST_SHARE * largest)
        );
        let help = "give the scatter of the channel at rest, or leave the key out: it is then estimated from the record";
        s.context.report(Report::error(message).key(entry.written).help(help), entry.item.span());
    }
}
