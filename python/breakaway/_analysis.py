"""The functions of the package."""

from __future__ import annotations

import json
import os
from typing import Any, Callable, Iterable, Mapping, Optional, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _native
from ._discovery import Discovery
from ._errors import UsageError
from ._identification import Identification
from ._input import Source, of_arrays, of_one_length, recordings
from ._model import Model, toml_of
from ._native import Recording
from ._results import of
from ._signals import Simulation, SineFit

#: What stands for a model: itself, or a model file.
AnyModel = Union[Model, str, "os.PathLike[str]"]


def read(
    path: Union[str, "os.PathLike[str]"],
    *,
    time: Optional[str] = None,
    time_unit: Optional[str] = None,
    input: Optional[str] = None,
    position: Optional[str] = None,
    current: Optional[str] = None,
    fs: Optional[float] = None,
    encoder_step: Optional[float] = None,
    wrap: Union[float, str, None] = None,
    counts_per_turn: Optional[float] = None,
    where: Union[str, Iterable[str], Mapping[str, Any], None] = None,
    from_s: Optional[float] = None,
    to_s: Optional[float] = None,
    dbc: Union[str, "os.PathLike[str]", None] = None,
) -> Recording:
    """Reads a recording: CSV, or a log in MCAP, WPILOG, ULog, npz, MAT, Parquet, of ROS 2, or of CAN frames.

    The keywords are the flags of the command ``breakaway identify``.

    :param time: column of time; ``t`` if not given.
    :param time_unit: ``s``, ``ms``, ``us``, ``ns``, ``min`` or ``h``; else what the column's name ends in, else s.
    :param input: column of the applied drive; ``u`` if not given.
    :param position: column of the position; ``x`` if not given.
    :param current: column of the motor's current, A (or mA, if its name ends so).
    :param fs: sampling rate, Hz, > 0; time is then counted from the rows.
    :param encoder_step: position units, > 0; else the file's, else inferred.
    :param wrap: position units after which the position starts anew, such as 4096, or ``"none"``.
    :param counts_per_turn: position units per turn of the axis, > 0, if the position is in counts.
    :param where: only rows whose column has this value: ``"mode=2"``, several of them, or ``{"mode": 2}``.
    :param from_s: only rows from this time on, s by the file's clock.
    :param to_s: only rows up to this time, s.
    :param dbc: the file in DBC that describes the frames of a CAN log.
    :raises RecordingError: with file, line and column.
    :raises FileError: a file that cannot be read, or is no recording.
    """
    given = {
        "time": time,
        "time_unit": time_unit,
        "input": input,
        "position": position,
        "current": current,
        "fs": fs,
        "encoder_step": encoder_step,
        "wrap": wrap,
        "counts_per_turn": counts_per_turn,
        "where": where,
        "from_s": from_s,
        "to_s": to_s,
        "dbc": dbc,
    }
    return recordings(os.fspath(path), given)[0]


def recording(
    t: npt.ArrayLike,
    u: npt.ArrayLike,
    x: npt.ArrayLike,
    *,
    current: Optional[npt.ArrayLike] = None,
    units: Optional[Tuple[str, str]] = None,
    name: str = "arrays",
    encoder_step: Optional[float] = None,
    wrap: Union[float, str, None] = None,
    counts_per_turn: Optional[float] = None,
) -> Recording:
    """Makes a recording of arrays. It is checked and mended as a file is; a row with a NaN is left out, as in a log.

    :param t: time, s, increasing; at least 8 samples.
    :param u: drive applied from each time to the next, in ``units[0]``.
    :param x: position read at each time, in ``units[1]``.
    :param current: motor current, A.
    :param units: of drive and position, such as ``("V", "rad")``.
    :param name: what messages and reports call it.
    :param encoder_step: position units, > 0; inferred if not given.
    :param wrap: position units after which the position starts anew, or ``"none"``.
    :param counts_per_turn: position units per turn of the axis, > 0, if the position is in counts.
    :raises ArrayError: no columns of real numbers of one length.
    :raises RecordingError: a clock that runs backwards, too few samples, and the like.
    """
    return of_arrays(
        t,
        u,
        x,
        current=current,
        units=units,
        name=name,
        encoder_step=encoder_step,
        wrap=wrap,
        counts_per_turn=counts_per_turn,
    )


def identify(
    t: Union[npt.ArrayLike, Source, Iterable[Source]],
    u: Optional[npt.ArrayLike] = None,
    x: Optional[npt.ArrayLike] = None,
    *,
    back_emf: Optional[float] = None,
    threads: Optional[int] = None,
    **reading: Any,
) -> Identification:
    """Identifies inertia, viscous and Coulomb friction, with standard errors.

    :param t: time, s, strictly increasing. Without ``u`` and ``x``: a recording, or several of one session. Each is a
        file, a :class:`Recording`, or a tuple of arrays ``(t, u, x)`` or ``(t, u, x, current)``.
    :param u: drive applied from each time to the next.
    :param x: position read at each time.
    :param back_emf: constant of the name plate, V per position unit and second, > 0. It parts c into back-EMF and
        viscous friction where no current is recorded.
    :param threads: number of threads, ≥ 1; all cores if not given.
    :param reading: the keywords of :func:`read` for files, and of :func:`recording` for arrays.
    :raises RecordingError: a recording that cannot be used.
    :raises IdentifyError: recordings that determine no model.
    """
    if (u is None) != (x is None):
        raise UsageError("u and x: give both, or neither of them and recordings in place of t")
    if u is not None:
        taken = [of_arrays(t, u, x, **reading)]
    else:
        taken = recordings(t, reading)  # type: ignore[arg-type]
    document, model = _native.identify(taken, back_emf=back_emf, threads=_threads(threads))
    return of(Identification, document, model=Model.parse(model))


def discover(
    recs: Union[Source, Iterable[Source]],
    *,
    holdout: Union[Source, Iterable[Source]] = (),
    model: Optional[AnyModel] = None,
    threads: Optional[int] = None,
    progress: Optional[Callable[[str], object]] = None,
    **reading: Any,
) -> Discovery:
    """Finds where simulation and recordings disagree, names the missing effect, and adds it to the model.

    :param recs: recordings of one session, in the order in which they were made. Each is a file, a
        :class:`Recording`, or a tuple of arrays ``(t, u, x)`` or ``(t, u, x, current)``.
    :param holdout: recordings to judge by, to which the model is not fitted; else the last third of each.
    :param model: the model so far, or its file; identified if not given.
    :param threads: number of threads, ≥ 1; all cores if not given.
    :param progress: called with each step, a sentence, on the calling thread. What it raises ends the work.
    :param reading: the keywords of :func:`read` for files, and of :func:`recording` for arrays.
    :raises RecordingError: a recording that cannot be used, or that is also held out.
    :raises IdentifyError: recordings that determine no base model.
    :raises DiscoverError: recordings from which nothing can be discovered.
    """
    fit, score = recordings(recs, reading), recordings(holdout, reading, "held-out arrays")
    # A file keeps its name in messages, as it does for the command.
    start = None
    if model is not None:
        start = ("the model", model.toml) if isinstance(model, Model) else (os.fspath(model), toml_of(model))
    document, improved, page = _native.discover(
        fit,
        score,
        model=start,
        command="breakaway.discover (Python)",
        threads=_threads(threads),
        progress=progress,
    )
    return of(Discovery, document, model=Model.parse(improved), html=page)


def simulate(
    model: AnyModel,
    drive: Union[npt.ArrayLike, str, "os.PathLike[str]", Mapping[str, Any]],
    *,
    tick_s: float = 1e-3,
    encoder_step: float = 0.0,
    noise: float = 0.0,
    seed: int = 0,
    name: str = "simulated",
) -> Simulation:
    """Moves a model, which starts at rest.

    :param model: the model, or its file.
    :param drive: the drive in each tick, drive units, at least 8 of them; or an experiment, as its file, its TOML or
        its tables, such as ``{"name": "relay", "duration_s": 15.0, "excitation": {"kind": "relay", "h1": 2.0, "h2": 1.5}}``.
    :param tick_s: interval of the drive, s, > 0. This and what follows are for an array; an experiment has its own.
    :param encoder_step: position units, ≥ 0; 0 for none.
    :param noise: standard deviation of the sensor's noise, position units, ≥ 0.
    :param seed: of the noise, ≥ 0; the same seed gives the same numbers.
    :param name: what to call the recording.
    :raises SimulateError: an experiment out of range, or a simulation that diverges.
    """
    toml = toml_of(model)
    if isinstance(drive, Mapping):
        made = _native.simulate(toml, "json", json.dumps(drive))
    elif isinstance(drive, str) and "\n" in drive:
        made = _native.simulate(toml, "toml", drive)
    elif isinstance(drive, (str, os.PathLike)):
        made = _native.simulate(toml, "file", os.fspath(drive))
    else:
        (u,) = of_one_length(u=drive)
        experiment = {
            "name": name,
            "tick_s": float(tick_s),
            "duration_s": float(tick_s) * len(u),
            "seed": int(seed),
            # The drive takes its place.
            "excitation": {"kind": "sine", "amplitude": 1.0, "frequency_hz": 0.1 / float(tick_s)},
            "sensor": {"encoder_step": float(encoder_step), "noise": float(noise)},
        }
        made = _native.simulate_drive(toml, u, json.dumps(experiment))
    return Simulation(*made)


def sinefit(t: npt.ArrayLike, x: npt.ArrayLike, *, period: Optional[float] = None, name: str = "arrays") -> SineFit:
    """Fits ``A·sin(ω(t − t0) + θ) + d`` to a signal, t0 being the first time. The clock may jitter and have gaps.

    :param t: time, s, increasing; at least 8 samples.
    :param x: the signal, in units of its own.
    :param period: about how long a period is, s, > 0, right within a factor of two; found in the data if not given.
    :param name: what messages call the signal.
    :raises ArrayError: no columns of real numbers of one length.
    :raises SineFitError: no sine can be fitted.
    """
    t, x = of_one_length(t=t, x=x)
    if period is not None and not (np.isfinite(period) and period > 0):
        raise UsageError("period: expected a positive number")
    return of(SineFit, _native.sinefit(t, x, period=period, name=name))


def _threads(threads: Optional[int]) -> Optional[int]:
    if threads is not None and threads < 1:
        raise UsageError("threads: expected 1 or more")
    return threads
