"""The exceptions: one class for each family of errors."""

from __future__ import annotations

import json


class Error(Exception):
    """Something could not be done; the text is what the command prints after ``error:``."""

    #: Name of the error in snake case, as in the command's JSON: ``wrong_column``, ``not_found``.
    kind: str = "other"
    #: The file, as it was given, or the name of the recording.
    file: str | None = None
    #: Line in the file, from 1.
    line: int | None = None
    #: Name of the column.
    column: str | None = None
    #: What to do: what stands after the first semicolon of the text.
    hint: str | None = None


class UsageError(Error, ValueError):
    """Arguments that make no sense together, or a keyword whose text says nothing."""

    kind = "usage"


class ArrayError(UsageError):
    """An argument that is no column of real numbers, or columns of different lengths."""

    kind = "array"


class FileError(Error, OSError):
    """A file that cannot be read or written, or is of another kind."""


class RecordingError(Error, ValueError):
    """A recording that cannot be used: its clock, its columns, its length."""


class ModelError(Error, ValueError):
    """A model that is not one: a missing key, an unknown effect, a value out of range."""


class IdentifyError(Error):
    """Recordings from which no model can be identified."""


class DiscoverError(Error):
    """Recordings from which nothing can be discovered."""


class FitError(Error):
    """A model that cannot be fitted to the recordings."""


class SimulateError(Error, ValueError):
    """An experiment that cannot be simulated."""


class SineFitError(Error):
    """A signal to which no sine can be fitted."""


class ExportError(Error, ValueError):
    """A model that a format cannot take without more being known of the motor."""


class CardError(Error, ValueError):
    """A card of the motor library that is not there, or not one."""


class ControlError(Error, ValueError):
    """A controller or a reference that cannot be used."""


class DeviceError(Error):
    """A board that does not answer, or refuses."""


FAMILIES = {
    "usage": UsageError,
    "file": FileError,
    "recording": RecordingError,
    "model": ModelError,
    "identify": IdentifyError,
    "discover": DiscoverError,
    "fit": FitError,
    "simulate": SimulateError,
    "sine": SineFitError,
    "export": ExportError,
    "card": CardError,
    "control": ControlError,
    "device": DeviceError,
    "other": Error,
}


def of(document: str) -> Error:
    """The exception of an error of the library."""
    fields = json.loads(document)
    error = FAMILIES[fields.pop("family")](fields.pop("message"))
    for name, value in fields.items():
        setattr(error, name, value)
    return error
