//! Where a parameter is: the paths of answers and files, as one type.

use std::fmt;
use std::str::FromStr;

/// Whose parameter it is.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Owner {
    /// The bulk law: `bulk.mu`.
    Bulk,
    /// The interface law, the same in all areas: `interface.lambda`.
    Interface,
    /// One area of the tear path, counted from 1 at the cut: `interface.area[3].gc`.
    Area(usize),
    /// An effect: `effects.viscoelastic.g`.
    Effect(String),
}

/// The path of a parameter. [`fmt::Display`] and [`FromStr`] are inverse to each other.
///
/// ```
/// use params::{Owner, ParamPath};
/// let path: ParamPath = "interface.area[3].gc".parse()?;
/// assert_eq!((&path.owner, path.name.as_str()), (&Owner::Area(3), "gc"));
/// assert_eq!(path.to_string(), "interface.area[3].gc");
/// assert_eq!(path.common().to_string(), "interface.gc");
/// # Ok::<(), params::NoPath>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ParamPath {
    /// Whose it is.
    pub owner: Owner,
    /// Its name.
    pub name: String,
}

/// A text that is no path of a parameter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoPath(pub String);

impl fmt::Display for NoPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "`{}` is no path of a parameter; expected bulk.NAME, interface.NAME, interface.area[1].NAME or effects.EFFECT.NAME",
            self.0
        )
    }
}

impl std::error::Error for NoPath {}

impl ParamPath {
    /// A parameter of the bulk law.
    pub fn bulk(name: &str) -> Self {
        Self { owner: Owner::Bulk, name: name.to_owned() }
    }

    /// A parameter of an area of the tear path, from 1.
    pub fn area(area: usize, name: &str) -> Self {
        Self { owner: Owner::Area(area), name: name.to_owned() }
    }

    /// The same without its area: what all areas have in common.
    pub fn common(self) -> Self {
        match self.owner {
            Owner::Area(_) => Self { owner: Owner::Interface, ..self },
            _ => self,
        }
    }
}

impl fmt::Display for ParamPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.owner {
            Owner::Bulk => write!(f, "bulk.{}", self.name),
            Owner::Interface => write!(f, "interface.{}", self.name),
            Owner::Area(area) => write!(f, "interface.area[{area}].{}", self.name),
            Owner::Effect(effect) => write!(f, "effects.{effect}.{}", self.name),
        }
    }
}

impl FromStr for ParamPath {
    type Err = NoPath;

    fn from_str(text: &str) -> Result<Self, NoPath> {
        let none = || NoPath(text.to_owned());
        let (site, rest) = text.split_once('.').ok_or_else(none)?;
        let (owner, name) = match site {
            "bulk" => (Owner::Bulk, rest),
            "interface" => match rest.strip_prefix("area[").and_then(|r| r.split_once("].")) {
                Some((area, name)) => {
                    let area = area.parse().ok().filter(|a| *a > 0).ok_or_else(none)?;
                    (Owner::Area(area), name)
                }
                None => (Owner::Interface, rest),
            },
            "effects" => {
                let (effect, name) = rest.split_once('.').ok_or_else(none)?;
                (Owner::Effect(effect.to_owned()), name)
            }
            _ => return Err(none()),
        };
        if name.is_empty() {
            return Err(none());
        }
        Ok(Self { owner, name: name.to_owned() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_what_it_was_written_as() {
        for text in ["bulk.mu", "interface.lambda", "interface.area[12].sigma_c", "effects.lag.tau"] {
            let path: ParamPath = text.parse().expect("a path");
            assert_eq!(path.to_string(), text);
        }
    }

    #[test]
    fn what_is_no_path_is_named() {
        for text in
            ["", "mu", "bulk.", "interface.area[0].gc", "interface.area[x].gc", "effects.lag", "tissue.mu"]
        {
            let fault = text.parse::<ParamPath>().expect_err("no path");
            assert!(fault.to_string().starts_with(&format!("`{text}` is no path")));
        }
    }
}
