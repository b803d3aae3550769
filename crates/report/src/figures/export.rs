//! A figure as a file of its own: SVG as it is; with the feature `pictures` PDF for papers and PNG for slides.

#[cfg(feature = "pictures")]
mod pictures;

use super::Figure;
use crate::ReportError;
use input::Figure as Format;

/// Ending of a format's files.
pub fn ending(format: Format) -> &'static str {
    match format {
        Format::Svg => "svg",
        Format::Pdf => "pdf",
        Format::Png => "png",
    }
}

/// Whether this build can write a format.
///
/// # Errors
/// What it can, and how to build one that can.
pub fn offered(format: Format) -> Result<(), ReportError> {
    if format == Format::Svg || cfg!(feature = "pictures") {
        return Ok(());
    }
    Err(ReportError::Figure {
        name: format!("*.{}", ending(format)),
        reason: "this fct was built without PDF and PNG; write svg, which every browser prints to PDF, or build with \
                 `cargo build --release --features pictures`"
            .into(),
    })
}

/// The figure in a format.
///
/// # Errors
/// If the figure cannot be converted, or this build cannot write the format.
pub fn export(figure: &Figure, format: Format) -> Result<Vec<u8>, ReportError> {
    offered(format)?;
    match format {
        Format::Svg => Ok(figure.svg.clone().into_bytes()),
        #[cfg(feature = "pictures")]
        Format::Pdf | Format::Png => pictures::converted(&figure.svg, format).map_err(|reason| {
            ReportError::Figure { name: format!("{}.{}", figure.name, ending(format)), reason }
        }),
        #[cfg(not(feature = "pictures"))]
        Format::Pdf | Format::Png => Ok(Vec::new()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(svg: &str) -> Figure {
        Figure { name: "a".into(), caption: String::new(), svg: svg.into() }
    }

    const SVG: &str = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"40\" height=\"20\"><rect width=\"40\" \
                       height=\"20\" fill=\"#D55E00\"/><text x=\"4\" y=\"14\" font-family=\"sans-serif\">F</text></svg>";

    #[test]
    fn svg_is_written_as_it_is() {
        assert_eq!(export(&figure(SVG), Format::Svg).ok(), Some(SVG.as_bytes().to_vec()));
    }

    #[cfg(feature = "pictures")]
    #[test]
    fn every_format_is_what_its_ending_says() -> Result<(), ReportError> {
        assert!(export(&figure(SVG), Format::Pdf)?.starts_with(b"%PDF"));
        assert!(export(&figure(SVG), Format::Png)?.starts_with(b"\x89PNG"));
        assert!(matches!(export(&figure("no svg"), Format::Pdf), Err(ReportError::Figure { .. })));
        Ok(())
    }

    #[cfg(not(feature = "pictures"))]
    #[test]
    fn what_was_not_built_says_how_it_is() {
        for format in [Format::Pdf, Format::Png] {
            let told = export(&figure(SVG), format).expect_err("not built").to_string();
            assert!(told.contains("--features pictures"), "{told}");
        }
    }
}
