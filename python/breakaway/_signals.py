"""The results of a sine fit and of a simulation."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Mapping, Optional, Tuple

import numpy as np

from ._html import table
from ._native import Recording
from ._results import Quantity, Remark


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
