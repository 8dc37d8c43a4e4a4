"""The result of an identification."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Mapping, Optional, Tuple

from ._html import table
from ._model import Model
from ._results import Quantity, Remark


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
