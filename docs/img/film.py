"""Pictures NNNN-T.png (T: tenths of a second) to one animated GIF: `just workbench-film`. Needs Pillow.

    python3 film.py FOLDER OUT.gif [WIDTH]
"""

import sys
from pathlib import Path

from PIL import Image, ImageChops

COLOURS = 64
# The README is to load quickly, MB.
MOST = 1.9


def frames(folder: Path, width: int) -> list[tuple[Image.Image, int]]:
    """Pictures in order with how long each is seen, ms; pictures that are alike are one."""
    out: list[tuple[Image.Image, int]] = []
    for file in sorted(folder.glob("*.png")):
        tenths = int(file.stem.split("-")[1])
        picture = Image.open(file).convert("RGB")
        picture = picture.resize((width, picture.height * width // picture.width), Image.LANCZOS)
        # What took minutes is told in seconds: pictures of waiting are seen for a fifth of one.
        shown = 200 if tenths <= 1 else 100 * tenths
        if out and ImageChops.difference(out[-1][0], picture).getbbox() is None:
            out[-1] = (picture, max(out[-1][1], shown))
        else:
            out.append((picture, shown))
    return out


def thinned(all_: list[tuple[Image.Image, int]], most: int) -> list[tuple[Image.Image, int]]:
    """At most so many pictures of waiting, evenly; those that are meant to be looked at stay."""
    waiting = [k for k, (_, shown) in enumerate(all_) if shown <= 200]
    if len(waiting) <= most:
        return all_
    kept = {waiting[k * len(waiting) // most] for k in range(most)}
    return [f for k, f in enumerate(all_) if f[1] > 200 or k in kept]


def main() -> None:
    folder, out = Path(sys.argv[1]), Path(sys.argv[2])
    width = int(sys.argv[3]) if len(sys.argv) > 3 else 860
    found = frames(folder, width)
    if not found:
        raise SystemExit(f"{folder}: no pictures NNNN-T.png")
    for waiting in (40, 30, 22, 16, 10):
        all_ = thinned(found, waiting)
        pictures = [picture.quantize(COLOURS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE) for picture, _ in all_]
        pictures[0].save(
            out, save_all=True, append_images=pictures[1:], duration=[d for _, d in all_], loop=0, optimize=True
        )
        if out.stat().st_size < MOST * 1e6:
            break
    print(f"{out}: {len(all_)} pictures, {sum(d for _, d in all_) / 1000:.0f} s, {out.stat().st_size / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
