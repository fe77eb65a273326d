"""Exceptions. Their text is the library's sentence: what is wrong and what to do."""

from __future__ import annotations

from typing import Any

from . import _api


class Error(Exception):
    """A call was refused; it has changed nothing.

    status: of the C interface, such as 2 for a stale handle; None if the call returns none
    result: what was done until then, if anything (a Frame or a Result)
    """

    status: int | None = None
    result: Any = None


class BadInputError(Error, ValueError):
    """A number is not finite or out of range, a name is unknown, or a text is not valid JSON."""

    status = _api.SC_BAD_INPUT


class StaleError(Error, LookupError):
    """The object was destroyed, or belongs to another world."""

    status = _api.SC_STALE


class BusyError(Error, RuntimeError):
    """Another thread is inside this world."""

    status = _api.SC_BUSY


class RefusedError(Error, RuntimeError):
    """The input is fine, but the present state does not allow it."""

    status = _api.SC_REFUSED


class FailedError(Error, RuntimeError):
    """The simulation could not go on, or an internal check failed."""

    status = _api.SC_FAILED


class OutOfMemoryError(Error, MemoryError):
    """The library is out of memory."""

    status = _api.SC_NO_MEMORY


class VersionError(Error, ImportError):
    """The library has another binary interface than this package."""

    status = _api.SC_WRONG_VERSION


class LibraryError(Error, ImportError):
    """The library was not found, or the system could not load it."""


BY_STATUS: dict[int, type[Error]] = {
    _api.SC_BAD_INPUT: BadInputError, _api.SC_STALE: StaleError, _api.SC_BUSY: BusyError, _api.SC_REFUSED: RefusedError,
    _api.SC_FAILED: FailedError, _api.SC_NO_MEMORY: OutOfMemoryError, _api.SC_WRONG_VERSION: VersionError,
}


def error_of(status: int, sentence: str) -> Error:
    """The exception of a status, with the library's sentence."""
    kind = BY_STATUS.get(status, Error)
    error = kind(sentence or f"the library refused the call with status {status}")
    error.status = status
    return error
