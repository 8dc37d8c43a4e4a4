"""What the functions take: files, recordings and arrays."""

from __future__ import annotations

import os
from typing import Any, Iterable, Mapping, Union

import numpy as np

from . import _native
from ._errors import ArrayError, UsageError

#: A file, a recording that was read, or the arrays (t, u, x) or (t, u, x, current).
Source = Union[str, "os.PathLike[str]", _native.Recording, "tuple[Any, ...]"]

#: Keywords that say which columns and rows of a file are meant.
OF_FILES = ("time", "input", "position", "current", "where", "dbc")
#: Keywords that files and arrays have in common.
OF_BOTH = ("time_unit", "fs", "encoder_step", "wrap", "counts_per_turn", "from_s", "to_s")


def column(name: str, values: Any) -> np.ndarray:
    """One dimension of real numbers, as float64. Masked values are NaN, as in a log that has no value there."""
    try:
        array = np.asanyarray(values)
    except ValueError as error:
        raise ArrayError(f"`{name}` is no array of numbers: {error}") from error
    if array.dtype.kind not in "iuf":
        raise ArrayError(f"`{name}` holds {array.dtype}; a column holds real numbers, integers or floats")
    if array.ndim != 1:
        raise ArrayError(f"`{name}` has the shape {array.shape}; a column has one dimension, a number per sample")
    if isinstance(array, np.ma.MaskedArray):
        array = np.ma.filled(array.astype(np.float64), np.nan)
    return np.asarray(array, dtype=np.float64)


def of_one_length(**columns: Any) -> list[np.ndarray]:
    """The columns, all of one length."""
    arrays = {name: column(name, values) for name, values in columns.items()}
    lengths = {len(array) for array in arrays.values()}
    if len(lengths) > 1:
        said = ", ".join(f"`{name}` has {len(array)}" for name, array in arrays.items())
        raise ArrayError(f"the columns differ in length: {said} samples")
    return list(arrays.values())


def options(given: Mapping[str, Any]) -> dict[str, Any]:
    """The keywords as the reader takes them; an unknown one is refused."""
    unknown = [name for name in given if name not in (*OF_FILES, *OF_BOTH, "units")]
    if unknown:
        raise TypeError(f"unexpected keyword argument: {', '.join(unknown)}")
    taken = {name: given.get(name) for name in (*OF_FILES, *OF_BOTH) if name != "where"}
    where = given.get("where") or ()
    if isinstance(where, str):
        where = [where]
    elif isinstance(where, Mapping):
        where = [f"{name}={value}" for name, value in where.items()]
    taken["select"] = list(where)
    if taken["dbc"] is not None:
        taken["dbc"] = os.fspath(taken["dbc"])
    if taken["wrap"] is not None:
        taken["wrap"] = str(taken["wrap"])
    return taken


def of_arrays(
    t: Any, u: Any, x: Any, *, current: Any = None, name: str = "arrays", **given: Any
) -> _native.Recording:
    """A recording of arrays."""
    columns = {"t": t, "u": u, "x": x}
    if current is not None:
        columns["current"] = current
    arrays = of_one_length(**columns)
    for_files = [keyword for keyword in OF_FILES if given.get(keyword) is not None]
    if for_files:
        raise UsageError(f"{', '.join(for_files)}: these name columns and rows of a file; arrays have none")
    units = given.pop("units", None) or (None, None)
    return _native.Recording(
        *arrays[:3],
        current=arrays[3] if len(arrays) > 3 else None,
        units=tuple(units),
        name=name,
        options=options(given),
    )


def recordings(
    sources: Source | Iterable[Source], given: Mapping[str, Any], name: str = "arrays"
) -> list[_native.Recording]:
    """Recordings of one source or of several; ``name`` is what messages call arrays."""
    if _is_one(sources):
        return [_one(sources, name, given)]
    listed = list(sources)  # type: ignore[arg-type]
    return [_one(source, f"{name} {number}", given) for number, source in enumerate(listed, 1)]


def _is_one(sources: Any) -> bool:
    if isinstance(sources, (str, os.PathLike, _native.Recording)):
        return True
    # A tuple of columns; a tuple of files or recordings is several.
    several = (str, os.PathLike, _native.Recording, tuple)
    return isinstance(sources, tuple) and len(sources) > 0 and not isinstance(sources[0], several)


def _one(source: Any, name: str, given: Mapping[str, Any]) -> _native.Recording:
    if isinstance(source, _native.Recording):
        return source
    if isinstance(source, (str, os.PathLike)):
        if given.get("units") is not None:
            raise UsageError("units: a file says them itself, by its header or the names of its columns")
        return _native.read(os.fspath(source), options(given))
    if isinstance(source, tuple) and len(source) in (3, 4):
        current = source[3] if len(source) == 4 else None
        return of_arrays(*source[:3], current=current, name=name, **given)
    raise ArrayError(f"{type(source).__name__}: expected a file, a Recording, or a tuple of the arrays (t, u, x)")
