"""Wall time of a study of 303 small tasks with 1 and 2 workers, and what a task costs besides its own work:
``python tests/scaling.py``. The records are synthetic. Not on a busy machine."""

import json
import pathlib
import tempfile
import time

from conftest import command
from test_campaign import INTACT, MODEL


def main():
    with tempfile.TemporaryDirectory() as place:
        here = pathlib.Path(place)
        rows = ""
        for k in (1, 2, 3):
            text = INTACT.replace("sK", f"s{k}").replace("1K", f"1{k}").replace("seed = K", f"seed = {k}")
            here.joinpath(f"s{k}.toml").write_text(text)
            command(here, "simulate", f"s{k}.toml")
            rows += f'[[specimens]]\nfile = "runs/s{k}/specimen.toml"\n'
        here.joinpath("model.toml").write_text(MODEL)
        for workers in (1, 2):
            head = f'folder = "w{workers}"\n{rows}'
            tail = '[[models]]\nname = "base"\nconfig = "model.toml"\n[repeats]\nbootstrap = 100\n'
            here.joinpath("study.toml").write_text(head + tail)
            command(here, "campaign", "plan", "study.toml")
            begun = time.monotonic()
            command(here, "campaign", "run", "study.toml", "--workers", str(workers), "--threads", "1")
            wall = time.monotonic() - begun
            results = [json.loads(p.read_text()) for p in (here / f"w{workers}/results").glob("*.json")]
            work = sum(r["seconds"] for r in results)
            beside = 1e3 * (workers * wall - work) / len(results)
            print(f"{workers} workers: {len(results)} tasks, {wall:.2f} s, {work:.2f} s in tasks, {beside:.1f} ms beside each")


if __name__ == "__main__":
    main()
