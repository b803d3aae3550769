//! A paragraph for the methods section of a paper, with what it cites.

use crate::summary::{ModelSummary, SpecimenRow, StudySummary};

/// The paragraph, as text.
pub fn methods(study: &StudySummary) -> String {
    let first = study.models.first();
    let rows = first.map_or(&[][..], |m| m.specimens.as_slice());
    let answered = rows.iter().filter(|r| r.answered).count();
    let specimens =
        if answered == rows.len() { answered.to_string() } else { format!("{answered} of {}", rows.len()) };
    let excluded = rows.iter().filter(|r| r.excluded.is_some()).count();
    let models: Vec<String> = study.models.iter().map(|m| format!("{} ({})", m.model, m.task)).collect();
    let counts: Vec<String> = study.models.iter().map(counts).collect();
    let unread = match study.status.wrong_rows.len() {
        0 => "",
        1 => " One row of the study's table could not be read.",
        _ => " Several rows of the study's table could not be read.",
    };
    let excluded = match excluded {
        0 => "None was".to_owned(),
        1 => "One specimen was".to_owned(),
        n => format!("{n} specimens were"),
    };
    let repeats = first.and_then(|m| m.specimens.iter().map(|r| r.repeats).max()).unwrap_or(0);
    let bootstrap = if repeats > 0 {
        format!(
            " Standard errors were checked by up to {repeats} refits per specimen to records with their misfit resampled \
             in blocks."
        )
    } else {
        String::new()
    };
    format!(
        "Bulk and cohesive parameters of {specimens} specimens were identified from uniaxial and tearing records by the \
         inverse finite-element analysis of Leng et al. [1] as implemented in fct {} (models: {}). {excluded} excluded \
         beforehand.{unread} A specimen entered the means if the model explained its records within noise and numerical \
         error ({}). Its Gc and σc are means over the areas of the tear path, with standard errors from the covariance of \
         the fit, which allows for areas that the records only fix together.{bootstrap} Means over specimens and the scatter between them are those of a \
         random-effects model fitted by restricted maximum likelihood [2], with Hartung–Knapp–Sidik–Jonkman intervals [3] \
         that are never narrower than the plain ones; prediction intervals follow [4].\n\n\
         [1] Leng X, Davis L, Deng X, Shazly T, Sutton MA, Lessner SM. An inverse analysis of cohesive zone model parameter \
         values for human fibrous cap mode I tearing.\n\
         [2] Viechtbauer W. Bias and efficiency of meta-analytic variance estimators in the random-effects model. J Educ \
         Behav Stat 2005;30:261–293.\n\
         [3] IntHout J, Ioannidis JPA, Borm GF. The Hartung-Knapp-Sidik-Jonkman method for random effects meta-analysis is \
         straightforward and considerably outperforms the standard DerSimonian-Laird method. BMC Med Res Methodol \
         2014;14:25.\n\
         [4] Higgins JPT, Thompson SG, Spiegelhalter DJ. A re-evaluation of random-effects meta-analysis. J R Stat Soc A \
         2009;172:137–159.\n",
        study.version,
        models.join(", "),
        counts.join("; "),
    )
}

/// How many specimens of a model are in its means, and why the others are not. Those excluded beforehand are told before.
fn counts(m: &ModelSummary) -> String {
    let count = |is: &dyn Fn(&SpecimenRow) -> bool| m.specimens.iter().filter(|r| is(r)).count();
    let told = [
        (count(&|r| r.unexplained_alone()), "not explained by their model"),
        (
            count(&|r| r.excluded.is_none() && r.explained && !r.counted()),
            "without a value that their records fix",
        ),
        (count(&|r| r.excluded.is_none() && !r.answered), "without an answer"),
    ];
    let mut out = format!("{}: {} counted", m.model, count(&|r| r.counted()));
    for (n, why) in told.into_iter().filter(|(n, _)| *n > 0) {
        out.push_str(&format!(", {n} {why}"));
    }
    out
}
