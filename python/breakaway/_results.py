"""The results: frozen dataclasses of the documents that the command prints with ``--json``.

A number that is not known is ``None``. Parameters are in the units that stand beside them.
"""

from __future__ import annotations

import dataclasses
import json
import typing
from dataclasses import dataclass, field
from typing import Any, Mapping, Optional, Tuple

import numpy as np

from ._html import framed, table
from ._model import Model
from ._native import Recording, write_text

#: Python's names for fields whose name in the document is a word of the language.
RENAMED = {"lambda_": "lambda"}


@dataclass(frozen=True)
class Quantity:
    """A number with its standard error and unit."""

    value: Optional[float]
    se: Optional[float]
    unit: str

    def __str__(self) -> str:
        error = "" if self.se is None else f" ± {self.se:.1e}"
        return f"{'unknown' if self.value is None else format(self.value, '.6g')}{error} {self.unit}"


@dataclass(frozen=True)
class Remark:
    """What is to be known beside a result: its kind in snake case, and a sentence."""

    kind: str
    text: str


@dataclass(frozen=True)
class Undetermined:
    """A parameter that the data cannot determine, and the experiment that would."""

    parameter: str
    advice: str


@dataclass(frozen=True)
class HeldOut:
    """Two models' prediction of held-out blocks: ratio of their errors, and its t statistic."""

    blocks: int
    error_ratio: Optional[float]
    t: Optional[float]


@dataclass(frozen=True)
class Estimate:
    """What one estimator says; ``holdout`` is its held-out error over that of the one that is reported."""

    name: str
    b: Quantity
    c: Quantity
    f1: Quantity
    load: Optional[Quantity]
    holdout: Optional[float]


@dataclass(frozen=True)
class Gravity:
    """Whether gravity helps, tried where the axis travels far enough (rad)."""

    travel_rad: Optional[float]
    blocks: int
    error_ratio: Optional[float]
    t: Optional[float]
    helps: bool


@dataclass(frozen=True)
class Winding:
    """Resistance and back-EMF constant from the current; ``viscous`` is what is left of c."""

    resistance: Quantity
    back_emf: Quantity
    inductance: Optional[Quantity]
    viscous: Quantity


@dataclass(frozen=True)
class Identification:
    """The base model ``b·ẍ + c·ẋ + f1·sgn ẋ + load = u`` of an axis, with standard errors."""

    #: Inertia, drive units · s² / position unit, > 0.
    b: Quantity
    #: Viscous friction, drive units · s / position unit.
    c: Quantity
    #: Coulomb friction, drive units.
    f1: Quantity
    #: Constant load, drive units; None where it is not significant.
    load: Optional[Quantity]
    #: What the data cannot determine.
    undetermined: Tuple[Undetermined, ...]
    #: Standard deviation of the position's noise, position units.
    noise: Optional[float]
    #: Which estimator is reported, and why.
    estimator: str
    chosen_because: str
    held_out: Optional[HeldOut]
    estimators: Tuple[Estimate, ...]
    gravity: Optional[Gravity]
    #: Whether what the model leaves is white.
    white: bool
    #: Simulation error over 0.4 s, position units.
    simulation_error: Optional[float]
    residual_correlation: Optional[float]
    winding: Optional[Winding]
    remarks: Tuple[Remark, ...]
    schema_version: int
    #: The same as a model, to simulate, to export or to write.
    model: Model = field(repr=False)
    #: The document as the command prints it.
    document: Mapping[str, Any] = field(repr=False, compare=False)

    def _repr_html_(self) -> str:
        named = {"b": self.b, "c": self.c, "f1": self.f1, "load": self.load}
        rows = [(name, quantity) for name, quantity in named.items() if quantity is not None]
        notes = [f"{missing.parameter}: {missing.advice}" for missing in self.undetermined]
        notes += [remark.text for remark in self.remarks]
        return table(rows, [f"reported: {self.chosen_because}", *notes])


@dataclass(frozen=True)
class Rival:
    """Another effect for the same gap; ``tied`` where these recordings cannot tell it from the named one."""

    name: str
    delta: Optional[float]
    z: Optional[float]
    tied: bool


@dataclass(frozen=True)
class FoundEffect:
    """An effect that was added: its law, its parameters by symbol, and its rivals."""

    name: str
    title: str
    law: str
    parameters: Mapping[str, Quantity]
    rivals: Tuple[Rival, ...]


@dataclass(frozen=True)
class Share:
    """Shares of the drive's rms, fitted and held out."""

    fit: Optional[float]
    holdout: Optional[float]


@dataclass(frozen=True)
class Rung:
    """A step of the ladder: the errors of the base with some effects, position units."""

    effects: Tuple[str, ...]
    fit_rmse: Optional[float]
    holdout_rmse: Optional[float]
    #: In open loop over 1 s.
    holdout_open_loop_rmse: Optional[float]
    force_residual: Optional[Share]
    drive_free_rmse: Optional[float]


@dataclass(frozen=True)
class Force:
    """Measured forces; shares are of the rms of the drive and of the acceleration."""

    drive_before: Optional[float]
    drive_after: Optional[float]
    acceleration_before: Optional[float]
    acceleration_after: Optional[float]
    coherence: Optional[float]
    random: Optional[float]
    random_share: Optional[float]
    bandwidth_hz: Optional[float]
    predictable: Optional[str]


@dataclass(frozen=True)
class UnexplainedForce:
    """A force that a model leaves unexplained below a frequency."""

    rms: Optional[float]
    unit: str
    percent_of_drive: Optional[float]
    bandwidth_hz: Optional[float]


@dataclass(frozen=True)
class BeforeAfter:
    """A share, 0 to 1, for the base and the final model."""

    before: Optional[float]
    after: Optional[float]


@dataclass(frozen=True)
class Unexplained:
    """What base and final model leave of the measured force, and how much of it one coordinate predicts."""

    before: UnexplainedForce
    after: UnexplainedForce
    predictable_share: BeforeAfter
    coordinate: Optional[str]


@dataclass(frozen=True)
class Where:
    """How the residual force depends on a coordinate; a row of a curve is centre, mean, standard error."""

    coordinate: str
    unit: str
    r2: Optional[float]
    r2_after: Optional[float]
    curve: Tuple[Tuple[Optional[float], ...], ...]
    curve_after: Tuple[Tuple[Optional[float], ...], ...]


@dataclass(frozen=True)
class Candidate:
    """An effect that was tried first, and its fate."""

    name: str
    delta: Optional[float]
    z: Optional[float]
    lambda_: Optional[float]
    fate: str


@dataclass(frozen=True)
class NextExperiment:
    """The experiment that would decide between tied effects; ``toml`` goes to :func:`breakaway.simulate`."""

    experiment: Mapping[str, Any]
    toml: Optional[str]
    separates: Tuple[str, ...]
    difference_over_noise: Optional[float]


@dataclass(frozen=True)
class Input:
    """A recording that went in."""

    file: str
    sha256: str


@dataclass(frozen=True)
class Provenance:
    """Where a discovery comes from."""

    inputs: Tuple[Input, ...]
    version: str
    command: str


@dataclass(frozen=True)
class Discovery:
    """What a model misses. In a notebook it shows itself as the command's HTML report."""

    #: ``explained``, ``partly_explained``, ``unknown`` or ``nothing_missing``.
    verdict: str
    #: The result in one sentence.
    sentence: str
    #: Effects that were added, in order.
    effects: Tuple[FoundEffect, ...]
    #: b, c and f1 of the final model.
    base: Mapping[str, Quantity]
    #: Errors of the base, then with one effect more each.
    ladder: Tuple[Rung, ...]
    #: Standard deviation of the position's noise, position units.
    noise_floor: Optional[float]
    force: Optional[Force]
    unexplained: Optional[Unexplained]
    where: Tuple[Where, ...]
    candidates: Tuple[Candidate, ...]
    next_experiment: Optional[NextExperiment]
    remarks: Tuple[Remark, ...]
    #: Segments simulated, and segments there are.
    segments: Tuple[int, ...]
    #: Time taken, s.
    seconds: Optional[float]
    provenance: Provenance
    schema_version: int
    #: The improved model.
    model: Model = field(repr=False)
    #: The report as one HTML file.
    html: str = field(repr=False, compare=False)
    #: The document as the command prints it.
    document: Mapping[str, Any] = field(repr=False, compare=False)

    def _repr_html_(self) -> str:
        return framed(self.html)

    def write_report(self, path: Any, force: bool = False) -> None:
        """Writes the report to an HTML file, whole or not at all.

        Raises :class:`FileError` where the file is there and is no report of breakaway's, unless ``force``.
        """
        write_text(path, self.html, "report", force)


@dataclass(frozen=True)
class SineErrors:
    """Standard errors, in the units of the values."""

    amplitude: Optional[float]
    omega: Optional[float]
    phase: Optional[float]
    phase_centre: Optional[float]
    offset: Optional[float]


@dataclass(frozen=True)
class SineFit:
    """``amplitude·sin(omega·(t − t0) + phase) + offset``, t0 being the first time."""

    #: In the signal's units, ≥ 0.
    amplitude: Optional[float]
    #: rad/s, > 0.
    omega: Optional[float]
    #: rad, at the first sample.
    phase: Optional[float]
    #: rad, at the middle.
    phase_centre: Optional[float]
    offset: Optional[float]
    #: Of the residual.
    rms: Optional[float]
    se: SineErrors
    #: Number of periods in the data.
    cycles: Optional[float]
    schema_version: int
    remarks: Tuple[Remark, ...] = ()
    #: The document as the command prints it.
    document: Mapping[str, Any] = field(default_factory=dict, repr=False, compare=False)

    def _repr_html_(self) -> str:
        values = ("amplitude", "omega", "phase", "phase_centre", "offset")
        units = {"omega": "rad/s", "phase": "rad", "phase_centre": "rad"}
        rows = [(name, Quantity(getattr(self, name), getattr(self.se, name), units.get(name, ""))) for name in values]
        return table(rows, [f"{self.cycles:.3g} cycles, rms of the residual {self.rms:.3g}"])


@dataclass(frozen=True, eq=False)
class Simulation:
    """A simulated recording."""

    #: As a sensor sees it.
    recording: Recording
    #: Position without noise and encoder steps, position units.
    true_x: np.ndarray = field(repr=False)
    #: Position, relative to the start, at which the travel limit ended it; None where it did not.
    tripped: Optional[float]


def of(kind: type, document: str, **more: Any) -> Any:
    """A result of the command's document."""
    fields = json.loads(document)
    return kind(**_fields(kind, fields), document=fields, **more)


def _fields(kind: type, document: Mapping[str, Any]) -> dict[str, Any]:
    hints = typing.get_type_hints(kind)
    made = {}
    for one in dataclasses.fields(kind):
        name = RENAMED.get(one.name, one.name)
        if name in document:
            made[one.name] = _value(hints[one.name], document[name])
    return made


def _value(hint: Any, value: Any) -> Any:
    """What a field of this type holds for a value of the document."""
    origin, inner = typing.get_origin(hint), typing.get_args(hint)
    if value is None or hint is Any:
        return value
    if origin is typing.Union:
        return _value(inner[0], value)
    if origin is tuple:
        return tuple(_value(inner[0], one) for one in value)
    if dataclasses.is_dataclass(hint):
        return hint(**_fields(hint, value))
    if isinstance(value, dict):
        return {key: _value(inner[1], one) for key, one in value.items()}
    return value
