"""The result of a discovery."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Mapping, Optional, Tuple

from ._html import framed
from ._model import Model
from ._native import write_text
from ._results import Quantity, Remark


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
