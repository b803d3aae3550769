"""Tables as TOML, for the files that the engine reads."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any


def _value(x: Any) -> str:
    if isinstance(x, bool):
        return "true" if x else "false"
    if isinstance(x, str):
        return json.dumps(x, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(x, Mapping):
        return "{ " + ", ".join(f"{_key(k)} = {_value(v)}" for k, v in x.items()) + " }"
    if hasattr(x, "tolist"):  # numpy scalars and arrays
        return _value(x.tolist())
    if isinstance(x, int):
        return str(x)
    if isinstance(x, float):
        # repr gives the shortest text that reads back the same double.
        text = repr(x) if math.isfinite(x) else ("nan" if math.isnan(x) else ("inf" if x > 0 else "-inf"))
        return text if any(c in text for c in ".einf") else text + ".0"
    if isinstance(x, Sequence):
        return "[" + ", ".join(_value(v) for v in x) + "]"
    raise TypeError(f"expected a number, a text, a list or a table, not {type(x).__name__}")


def _key(name: str) -> str:
    bare = name.isascii() and name.replace("_", "").replace("-", "").isalnum()
    return name if bare else _value(name)


def table(content: Mapping[str, Any], path: tuple[str, ...] = ()) -> str:
    """The table as TOML: plain keys first, then the tables in it; lists of tables as ``[[name]]``."""
    plain, inner = [], []
    for name, x in content.items():
        tables = isinstance(x, (list, tuple)) and bool(x) and all(isinstance(v, Mapping) for v in x)
        # A parameter with its bounds, and a protocol, are written in place.
        if isinstance(x, Mapping) and not (path and "start" in x):
            inner.append((name, x, False))
        elif tables and not path:
            inner.append((name, x, True))
        elif x is not None:
            plain.append(f"{_key(name)} = {_value(x)}\n")
    out = "".join(plain)
    for name, x, many in inner:
        head = ".".join(_key(p) for p in (*path, name))
        for one in x if many else [x]:
            out += ("\n[[" + head + "]]\n" if many else f"\n[{head}]\n") + table(one, (*path, name))
    return out
