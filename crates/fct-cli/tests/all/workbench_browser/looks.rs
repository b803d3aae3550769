//! What the page looks like: the strip, widths, names of what is pressed.

use super::SOON;
use crate::accessible;
use crate::common::Tested;
use crate::driver::Page;

/// Nothing is wider than its window; everything that is pressed has a name; labels of fields are theirs.
pub(super) fn looks(page: &mut Page) -> Tested {
    page.ask("scrollTo(0, 0)")?;
    page.picture("workbench", false)?;
    for (width, scheme) in [(1280, "light"), (1280, "dark"), (390, "light"), (390, "dark")] {
        page.looks(width, scheme)?;
        page.settle()?;
        page.picture(&format!("workbench-{width}-{scheme}"), true)?;
        assert_eq!(accessible::faults(page)?, Vec::<String>::new(), "{width} {scheme}");
    }
    page.looks(1280, "light")?;
    assert_eq!(accessible::unreached(page)?, Vec::<String>::new());
    Ok(())
}

/// The deformed strip: its pictures are played, and another model's curves are laid over these.
pub(super) fn strip(page: &mut Page) -> Tested {
    page.until("document.querySelector('#frame-told').textContent.includes('picture')", SOON)?;
    let coloured = "(() => { const c = document.querySelector('#mesh-canvas'), d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data, s = new Set();
        for (let i = 0; i < d.length; i += 4) if (d[i + 3] === 255) s.add(d[i] * 65536 + d[i + 1] * 256 + d[i + 2]); return s.size; })()";
    assert!(page.ask(coloured)?.as_u64() > Some(20), "colours of stress");
    let before = page.text("#frame-told")?;
    // Asked again until it holds: pictures of the step that was gone to may still be on their way.
    page.until(
        &format!(
            "(() => {{ const f = document.querySelector('#frame'); f.value = 1; f.dispatchEvent(new Event('input'));
               return document.querySelector('#frame-told').textContent !== {before:?}; }})()"
        ),
        SOON,
    )?;
    page.picture("workbench-strip", true)?;
    page.click("[data-over='2']")?;
    page.until("document.querySelector('#overlays').textContent.includes('Fit')", SOON)?;
    page.click("[data-over='2']")
}
