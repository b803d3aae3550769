//! Every threshold of the diagnosis in one place, with its reason.

/// Thresholds. Naming a wrong effect is worse than abstaining, so the defaults are strict.
#[derive(Clone, Debug, PartialEq)]
pub struct Policy {
    /// Largest false-discovery rate (Benjamini–Hochberg) at which the screen calls an effect significant.
    /// 0.01: on a record without effect it bounds the chance of any false alarm by 1 %, which leaves room
    /// for errors of the noise estimate under the 5 % that is promised.
    pub fdr: f64,
    /// Least expected fall of χ² of a significant effect; 10 is "very strong evidence" (Kass & Raftery 1995).
    pub min_fall: f64,
    /// An effect is called visible when a plausible amplitude gives at least this many standard deviations
    /// beyond what base parameters can imitate. 4 is seen with 95 % power at p = 0.01; 10 is told from its
    /// rivals and from the error of the mesh, too.
    pub visible_snr: f64,
    /// Share |s⊥|/|s| below which a column counts as zero: derivatives are not more accurate than this.
    pub min_visibility: f64,
    /// Two effects are look-alikes when the χ² that would separate them is below this (9: three sigma).
    pub separate_chi2: f64,
    /// And when the angle between what they do is below this, degrees: above it, faint effects are not
    /// alike but only faint.
    pub look_alike_degrees: f64,
    /// Draws of the sup-test's simulation, and its seed: 20,000 give p = 1e-3 within 20 %; smaller p come
    /// from an upper bound.
    pub draws: usize,
    /// Seed of the simulation.
    pub seed: u64,
    /// Least fall of BIC for an effect to be added; 10 is "very strong".
    pub add_bic: f64,
    /// A rival whose BIC is within this of the chosen effect's belongs to its group; 6 is "strong".
    pub tie_bic: f64,
    /// A record is explained when reduced χ² (numerical error included) is at most this, or at most
    /// 1 + `explained_sigmas`·√(2/ν): a noise sd known to 5 % moves χ² by 10 %.
    pub explained_chi2: f64,
    /// Sampling spread of χ² that is allowed for.
    pub explained_sigmas: f64,
    /// Whitened misfits correlated with a p-value below this are structure, whatever χ² says.
    pub structure_p: f64,
}

impl Default for Policy {
    fn default() -> Self {
        Self {
            fdr: 0.01,
            min_fall: 10.0,
            visible_snr: 10.0,
            min_visibility: 1e-4,
            separate_chi2: 9.0,
            look_alike_degrees: 45.0,
            draws: 20_000,
            seed: 20_240_601,
            add_bic: 10.0,
            tie_bic: 6.0,
            explained_chi2: 1.2,
            explained_sigmas: 4.0,
            structure_p: 1e-6,
        }
    }
}
