"""Finds libsupercircle_c and libsupercircle_lab_c, and gives their calls types and exceptions.

The places, in order: $SUPERCIRCLE_LIBRARY (the library or its folder), beside the package, the system's loader, `build`
of the checkout the package lies in or was installed from.
"""

from __future__ import annotations

import ctypes
import math
import os
import pathlib
import sys
from functools import lru_cache
from typing import Any

from . import _api
from .errors import LibraryError, VersionError, error_of

VARIABLE = "SUPERCIRCLE_LIBRARY"
PACKAGE = pathlib.Path(__file__).resolve().parent
SUFFIXES = [".dylib"] if sys.platform == "darwin" else [".so.0", ".so"]


def checkout() -> pathlib.Path | None:
    """The source tree that the package lies in, or that it was installed from; None if there is none."""
    candidates = list(PACKAGE.parents)
    note = PACKAGE / "_checkout.txt"  # written by the build backend
    if note.exists():
        candidates.insert(0, pathlib.Path(note.read_text().strip()))
    for folder in candidates:
        if (folder / "bridge/c/api.json").exists():
            return folder
    return None


def _places(name: str) -> list[tuple[str, list[str]]]:
    """(description, files to try) in order."""
    files = [f"lib{name}{suffix}" for suffix in SUFFIXES]
    places: list[tuple[str, list[str]]] = []
    told = os.environ.get(VARIABLE, "")
    if told:
        path = pathlib.Path(told).expanduser()
        folder = path if path.is_dir() else path.parent
        own = [] if path.is_dir() or name != "supercircle_c" else [str(path)]
        places.append((f"${VARIABLE} ({told})", own or [str(folder / f) for f in files]))
    else:
        places.append((f"${VARIABLE}: not set", []))
    places.append((f"beside the package ({PACKAGE})", [str(PACKAGE / f) for f in files]))
    places.append(("the system's loader", files))
    tree = checkout()
    places.append((f"the checkout ({tree / 'build'})", [str(tree / "build" / f) for f in files]) if tree
                  else ("a checkout: the package lies in none", []))
    return places


def _open(name: str) -> ctypes.CDLL:
    tried = []
    for where, files in _places(name):
        why = "" if not files else "no such file"
        for file in files:
            if os.sep in file and not os.path.exists(file):
                continue
            try:
                return ctypes.CDLL(file)
            except OSError as error:
                why = why if os.sep not in file and why != "no such file" else str(error)
        tried.append(f"  {where}" + (f": {why}" if why else ""))
    tree = checkout()
    remedy = f"Build it: {tree / 'bridge/python/build.sh'}" if tree else "Run bridge/python/build.sh in the source tree"
    raise LibraryError(f"lib{name} was not found. Tried, in this order:\n" + "\n".join(tried) +
                       f"\n{remedy}, or install the Debian package, or set {VARIABLE} to the library or its folder.")


def _bind(library: ctypes.CDLL, calls: _api.Prototypes, error: str, status: str, version: str) -> None:
    def sentence() -> str:
        return (getattr(library, error)() or b"").decode()

    def check_status(result: int, _call: Any, _arguments: Any) -> int:
        if result:
            raise error_of(result, sentence())
        return result

    def check_count(result: int, _call: Any, _arguments: Any) -> int:
        if result < 0:
            raise error_of(-result, sentence())
        return result

    def check_number(result: float, _call: Any, _arguments: Any) -> float:
        if math.isnan(result) or result == 0:
            text = sentence()
            if text:
                raise error_of(getattr(library, status)(), text)
        return result

    def check_text(result: bytes | None, _call: Any, _arguments: Any) -> str:
        if result is None:
            raise error_of(getattr(library, status)(), sentence())
        return result.decode()

    def check_address(result: int | None, _call: Any, _arguments: Any) -> int:
        if result is None:
            raise error_of(getattr(library, status)(), sentence())
        return result

    # Before anything else: the calls below may be those of another version.
    for name in (version, error):
        if not hasattr(library, name):
            raise VersionError(f"{library._name} is no library of Supercircle: it has no call {name}")
    getattr(library, version).restype = ctypes.c_int32
    found = getattr(library, version)()
    if found != _api.SC_API_VERSION:
        raise VersionError(f"{library._name} has version {found} of the binary interface, and this package needs version "
                           f"{_api.SC_API_VERSION}: install both from the same source tree")
    checks = {_api.STATUS: check_status, ctypes.c_int32: check_count, ctypes.c_double: check_number,
              ctypes.c_uint64: check_number, ctypes.c_char_p: check_text, ctypes.c_void_p: check_address}
    for name, (result, parameters) in calls.items():
        try:
            call = getattr(library, name)
        except AttributeError:
            raise VersionError(f"{library._name} has no call {name}: install library and package from the same source "
                               "tree") from None
        call.restype = ctypes.c_int32 if result is _api.STATUS else result
        call.argtypes = list(parameters)
        if name not in (error, status) and result in checks:
            call.errcheck = checks[result]


@lru_cache(maxsize=None)
def core() -> ctypes.CDLL:
    """libsupercircle_c; LibraryError, VersionError."""
    library = _open("supercircle_c")
    _bind(library, _api.CALLS, "sc_error", "sc_error_status", "sc_api_version")
    return library


@lru_cache(maxsize=None)
def laboratory() -> ctypes.CDLL:
    """libsupercircle_lab_c; LibraryError, VersionError."""
    library = _open("supercircle_lab_c")
    _bind(library, _api.LAB_CALLS, "sc_lab_error", "sc_lab_status", "sc_lab_api_version")
    return library


def library_path() -> str:
    """The file of libsupercircle_c that is used."""
    return str(core()._name)


def version() -> str:
    """Version of the library, such as "0.2.0"."""
    return str(core().sc_version())
