"""Where shipped scenes are."""

from __future__ import annotations

import difflib
import pathlib
import sys

from . import _loader
from .errors import BadInputError


def folders() -> list[pathlib.Path]:
    """Folders of shipped scenes that exist."""
    found = []
    tree = _loader.checkout()
    if tree is not None:
        found.append(tree / "scenes")
    for prefix in (sys.prefix, "/usr", "/usr/local"):
        found.append(pathlib.Path(prefix) / "share/supercircle/scenes")
    return [f for f in dict.fromkeys(found) if f.is_dir()]


def scenes() -> dict[str, pathlib.Path]:
    """Shipped scenes by name, such as "two_shells" or "experiments/sled"."""
    out: dict[str, pathlib.Path] = {}
    for folder in reversed(folders()):
        for path in folder.rglob("*.json"):
            out[path.relative_to(folder).with_suffix("").as_posix()] = path
    return dict(sorted(out.items()))


def find(name: str) -> pathlib.Path:
    """The file of a path or of a shipped scene's name; BadInputError."""
    path = pathlib.Path(name).expanduser()
    if path.exists() or path.suffix:
        return path
    shipped = scenes()
    if name in shipped:
        return shipped[name]
    near = difflib.get_close_matches(name, shipped, 1)
    raise BadInputError(f"there is no file {name}, and no shipped scene of that name" +
                        (f"; did you mean \"{near[0]}\"?" if near else "; sc.scenes() lists them"))
