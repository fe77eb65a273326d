"""Between Python's and C's values: points, texts, JSON, buffers, records."""

from __future__ import annotations

import ctypes
import dataclasses
import difflib
import json
import os
import pathlib
from typing import Any, Callable, Iterable, Mapping, Sequence, TypeVar, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _api, records
from .errors import BadInputError

Floats = NDArray[np.float64]
Point = Union[Sequence[float], Floats]
Json = Union[Mapping[str, Any], Sequence[Any], str]
SceneSource = Union[Mapping[str, Any], str, "os.PathLike[str]"]
Record = TypeVar("Record")


def point(value: Point) -> _api.sc_point:
    try:
        x, y = value
        return _api.sc_point(float(x), float(y))
    except (TypeError, ValueError):
        raise BadInputError(f"a point has two numbers, x and y, not {value!r}") from None


def array2(value: _api.sc_point) -> Floats:
    return np.array([value.x, value.y])


def encoded(text: str | None) -> bytes | None:
    if text is None:
        return None
    data = text.encode()
    if b"\0" in data:
        raise BadInputError("a text has a zero byte")
    return data


def json_bytes(value: Json) -> bytes:
    """A text as it is, anything else as JSON."""
    if isinstance(value, str):
        return encoded(value) or b""
    return json.dumps(value, default=_plain).encode()


def _plain(value: Any) -> Any:
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise BadInputError(f"{value!r} cannot be written as JSON")


def numbers(value: ArrayLike | None) -> Floats:
    """A contiguous vector; None: an empty one."""
    if value is None:
        return np.empty(0)
    try:
        return np.ascontiguousarray(np.atleast_1d(np.asarray(value, dtype=np.float64)))
    except (TypeError, ValueError):
        raise BadInputError(f"expected numbers, got {value!r}") from None


def corners(value: ArrayLike | None) -> Floats:
    """Points as a contiguous array of shape (n, 2); None: no points."""
    found = numbers(value)
    if value is not None and (found.ndim != 2 or found.shape[1] != 2):
        raise BadInputError(f"expected points as an array of shape (n, 2), got shape {found.shape}")
    return found


def fill(out: ctypes.Structure, values: Mapping[str, Any], what: str, without: Sequence[str] = ()) -> None:
    """Sets members of a definition by name, but none of those in `without`."""
    kinds = dict((field[0], field[1]) for field in out._fields_)
    known = [name for name in kinds if name not in ("size", "reserved", *without)]
    for name, value in values.items():
        if name not in known:
            raise BadInputError(f"{what} has no {unknown(name, known)}")
        try:
            setattr(out, name, point(value) if kinds[name] is _api.sc_point else value)
        except TypeError:
            raise BadInputError(f"{name} of {what} cannot be {value!r}") from None


def unknown(name: str, known: Iterable[str]) -> str:
    """A name that is not known, and the nearest one or all that are."""
    names = list(known)
    near = [n for n in names if n.startswith(name)] or difflib.get_close_matches(name, names, 1)
    return f"{name}; did you mean {near[0]}?" if near else f"{name}; there are {', '.join(names) or 'none'}"


def address(values: Floats) -> int | None:
    return values.ctypes.data if values.size else None


def items(struct: type[Any], call: Callable[[Any, int], int]) -> list[Any]:
    """All items of a call that fills a buffer."""
    capacity = call(None, 0)
    while True:
        buffer = (struct * capacity)()
        count = call(buffer, capacity)
        if count <= capacity:
            return list(buffer)[:count]
        capacity = count


def points(call: Callable[[Any, int], int]) -> Floats:
    """All points of a call that fills a buffer, shape (n, 2)."""
    capacity = 512
    while True:
        out = np.empty((capacity, 2))
        count = call(out.ctypes.data, capacity)
        if count <= capacity:
            return out[:count].copy()
        capacity = count


def record(kind: type[Record], struct: ctypes.Structure) -> Record:
    """The dataclass of a struct."""
    values = []
    for name, flag in _members(kind):
        value = getattr(struct, name)
        values.append(array2(value) if isinstance(value, _api.sc_point) else bool(value) if flag else value)
    return kind(*values)


_known: dict[Any, list[tuple[str, bool]]] = {}


def _members(kind: Any) -> list[tuple[str, bool]]:
    """(name, whether it is yes or no) of the members of a record class."""
    if kind not in _known:
        _known[kind] = [(field.name, str(field.type) == "bool") for field in dataclasses.fields(kind)]
    return _known[kind]


def target(position: Point, angle: float, velocity: Point, spin: float) -> _api.sc_target:
    return _api.sc_target(point(position), angle, point(velocity), spin)


def reaction(struct: _api.sc_reaction) -> records.Reaction:
    return record(records.Reaction, struct)


def choice(value: str, known: Mapping[str, int], what: str) -> int:
    if value not in known:
        raise BadInputError(f"{what} is {value!r}, not one of {', '.join(known)}")
    return known[value]


def source_text(scene: SceneSource, find: Callable[[str], pathlib.Path]) -> tuple[bytes, str]:
    """(JSON, name in messages) of a scene: an object, a JSON text, a path, or the name of a shipped scene."""
    if isinstance(scene, Mapping):
        return json_bytes(scene), "scene"
    name = os.fspath(scene)
    if name.lstrip().startswith("{"):
        return name.encode(), "scene"
    path = find(name)
    try:
        return path.read_bytes(), str(path)
    except OSError as error:
        raise BadInputError(f"cannot read {path}: {error.strerror}") from None
