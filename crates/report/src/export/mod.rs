//! An identified bulk law as input of other programs: a deck of one element that is stretched, with the forces that fct
//! computes for it.

mod abaqus;
mod febio;
mod felupe;

use std::fmt::Write;

/// A program that the law is written for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Program {
    /// FElupe, a Python script.
    Felupe,
    /// Abaqus/Standard, an input file.
    Abaqus,
    /// FEBio 4, an input file.
    Febio,
}

/// The law of Holzapfel, Gasser and Ogden with isochoric invariants and fibres in tension, identified; MPa, rad.
#[derive(Clone, Debug, PartialEq)]
pub struct Exported {
    /// Specimen.
    pub specimen: String,
    /// Run that it was identified in.
    pub run: String,
    /// Effects of the model, which these programs do not get.
    pub effects: Vec<String>,
    /// μ, MPa.
    pub mu: f64,
    /// k1, MPa.
    pub k1: f64,
    /// k2.
    pub k2: f64,
    /// γ, angle of the two families to the load axis y, rad.
    pub gamma: f64,
    /// κ.
    pub kappa: f64,
    /// D, 1/MPa; the initial bulk modulus is 2/D.
    pub d: f64,
    /// Gc (N/mm) and σc (MPa) of each area, from the cut on.
    pub areas: Vec<[f64; 2]>,
    /// Stretch along y, and force (N) on a cube of 1 mm with free sides, as fct computes it.
    pub forces: Vec<[f64; 2]>,
}

/// The file, and its ending.
pub fn deck(program: Program, law: &Exported) -> (&'static str, String) {
    match program {
        Program::Felupe => ("py", felupe::script(law)),
        Program::Abaqus => ("inp", abaqus::deck(law)),
        Program::Febio => ("feb", febio::deck(law)),
    }
}

impl Exported {
    /// What stands at the head of each file, line by line.
    fn head(&self, program: &str, tried: &str) -> Vec<String> {
        let mut lines = vec![
            format!("{program}: the bulk law of specimen {} as identified by fct", shown(&self.specimen)),
            format!("Run: {}", shown(&self.run)),
            tried.to_owned(),
            "Units: mm, N, MPa. Load along y, width along x, thickness along z.".to_owned(),
            "One cube of 1 mm, free to contract, stretched along y to 1.2.".to_owned(),
        ];
        if !self.effects.is_empty() {
            lines.push(format!("NOT IN HERE: the effects of the model: {}", shown(&self.effects.join(", "))));
        }
        for (i, [gc, sigma]) in self.areas.iter().enumerate() {
            lines.push(format!(
                "Tear path, area {} from the cut: Gc = {gc:?} N/mm, sigma_c = {sigma:?} MPa",
                i + 1
            ));
        }
        if !self.areas.is_empty() {
            lines.push(
                "The tear path has an exponential cohesive law; it is not part of this one-element deck."
                    .into(),
            );
        }
        lines.push("Force on the cube by fct (stretch, N):".to_owned());
        lines.extend(self.forces.iter().map(|[stretch, force]| format!("  {stretch:.4} {force:.8e}")));
        lines
    }

    fn last_stretch(&self) -> f64 {
        self.forces.last().map_or(1.2, |f| f[0])
    }
}

/// Text that stays on its line, and ends no comment.
fn shown(text: &str) -> String {
    input::visible(&text.replace(['\n', '\r'], " ")).replace("--", "- -").replace('"', "'")
}

/// Lines behind a mark.
fn comments(mark: &str, lines: &[String]) -> String {
    lines.iter().fold(String::new(), |mut out, line| {
        // Writing to a String cannot fail.
        let _ = writeln!(out, "{mark} {line}");
        out
    })
}

#[cfg(test)]
mod tests;
