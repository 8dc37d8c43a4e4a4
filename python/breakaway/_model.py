"""Models of an axis."""

from __future__ import annotations

import html
import json
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Mapping, Optional, Sequence, Tuple, Union

from . import _native


@dataclass(frozen=True)
class Effect:
    """An effect of a model: its name in the catalogue (``breakaway effects``), its parameters, their standard errors."""

    name: str
    parameters: Mapping[str, float]
    se: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Part:
    """What became of a part of a model in an export: ``kept``, ``approximated`` or ``lost``, and how."""

    what: str
    law: str
    fate: str
    how: str


@dataclass(frozen=True)
class Export:
    """A model for another program."""

    #: The file.
    text: str
    #: Its format.
    target: str
    #: What became of every parameter and effect.
    parts: Tuple[Part, ...]
    #: Names of the parts that the format cannot hold.
    lost: Tuple[str, ...]
    #: Inertia and friction in SI units, on both sides of the gear; None for C.
    si: Optional[Mapping[str, Any]]
    #: What else is to be known.
    remarks: Tuple[str, ...]

    def write(self, path: Union[str, "os.PathLike[str]"], force: bool = False) -> None:
        """Writes the file, whole or not at all.

        Raises :class:`FileError` where the file is there and is no export of breakaway's, unless ``force``.
        """
        _native.write_text(os.fspath(path), self.text, "export", force)


@dataclass(frozen=True)
class Model:
    """A model ``b·ẍ + c·ẋ + f1·sgn ẋ = u`` of an axis, with named effects.

    :meth:`read` takes a model file, :meth:`of` the numbers. Both check every value.
    """

    #: Inertia, drive units · s² / position unit, > 0.
    b: float
    #: Viscous friction, drive units · s / position unit, ≥ 0.
    c: float
    #: Coulomb friction, drive units, ≥ 0.
    f1: float
    #: Standard errors of b, c and f1, where they are known.
    se: Mapping[str, Optional[float]]
    #: Units of drive (``u``) and position (``x``).
    units: Mapping[str, str]
    effects: Tuple[Effect, ...]
    #: Where it comes from, a remark each.
    provenance: Tuple[str, ...] = field(repr=False)
    #: The same as a model file.
    toml: str = field(repr=False)

    @classmethod
    def read(cls, path: Union[str, "os.PathLike[str]"]) -> "Model":
        """Reads a model file. Raises :class:`ModelError` with file and line, or :class:`FileError`."""
        return cls._of(_native.read_model(os.fspath(path)))

    @classmethod
    def parse(cls, text: str, name: str = "the model") -> "Model":
        """Reads a model from TOML; ``name`` is its name in messages. Raises :class:`ModelError`."""
        return cls._of(_native.parse_model(name, text))

    @classmethod
    def of(
        cls,
        b: float,
        c: float = 0.0,
        f1: float = 0.0,
        *,
        effects: Sequence[Union[Effect, Mapping[str, Any]]] = (),
        units: Tuple[str, str] = ("u", "x"),
    ) -> "Model":
        """Makes a model.

        ``b`` > 0 in drive units · s² / position unit, ``c`` ≥ 0 in drive units · s / position unit, ``f1`` ≥ 0 in
        drive units. An effect is an :class:`Effect`, or a mapping such as ``{"name": "cogging", "A": 0.2, "n": 7.0}``.
        Raises :class:`ModelError` for a value out of range.
        """
        listed = [
            {"name": one.name, **one.parameters, **({"se": dict(one.se)} if one.se else {})}
            if isinstance(one, Effect)
            else dict(one)
            for one in effects
        ]
        tables = {
            "base": {"b": float(b), "c": float(c), "f1": float(f1)},
            "units": {"u": units[0], "x": units[1]},
            "effect": [{key: _plain(value) for key, value in one.items()} for one in listed],
        }
        return cls._of(_native.make_model(json.dumps(tables)))

    @classmethod
    def _of(cls, document: str) -> "Model":
        fields = json.loads(document)
        effects = tuple(Effect(**effect) for effect in fields.pop("effects"))
        return cls(effects=effects, provenance=tuple(fields.pop("provenance")), **fields)

    def write(self, path: Union[str, "os.PathLike[str]"], force: bool = False) -> None:
        """Writes a model file, whole or not at all.

        Raises :class:`FileError` where the file is there and is no model of breakaway's, unless ``force``.
        """
        _native.write_text(os.fspath(path), self.toml, "model", force)

    def export(
        self,
        to: str,
        *,
        name: str = "axis",
        timestep: float = 0.001,
        motor_constant: Optional[float] = None,
        resistance: Optional[float] = None,
        supply: Optional[float] = None,
        motor: Optional[str] = None,
        gear: Optional[float] = None,
        drive_gain: Optional[float] = None,
        drive: Optional[str] = None,
        encoder: Optional[str] = None,
        counts_per_turn: Optional[float] = None,
    ) -> Export:
        """Writes the model for another program.

        :param to: ``mjcf`` (MuJoCo), ``urdf``, ``sdf``, ``isaaclab``, ``modelica`` or ``c``.
        :param name: name of the axis in the file.
        :param timestep: time step of the simulator, s, > 0.
        :param motor_constant: torque constant, N·m/A, of a linear motor N/A, > 0.
        :param resistance: of the winding, Ω, > 0.
        :param supply: voltage of the supply, V, > 0, for a drive that is a duty.
        :param motor: a card of the motor library, by name or file, for what is not given here.
        :param gear: turns of the motor per turn of the load, > 0.
        :param drive_gain: force at the load per drive unit, N·m or N, > 0, in place of the motor's constants.
        :param drive: ``voltage``, ``current``, ``duty`` or ``effort``, where the drive's unit does not say it.
        :param encoder: where the position was measured: ``load`` or ``motor``.
        :param counts_per_turn: position units per turn, > 0, if the position is in counts.
        :raises ExportError: a constant that the format needs is not given.
        """
        about_motor = {
            "motor_constant": motor_constant,
            "resistance": resistance,
            "supply": supply,
            "motor": motor,
            "gear": gear,
            "drive_gain": drive_gain,
            "drive": drive,
            "encoder": encoder,
            "counts_per_turn": counts_per_turn,
        }
        fields = json.loads(_native.export(self.toml, to, name=name, timestep=float(timestep), motor=about_motor))
        return Export(
            text=fields["text"],
            target=fields["target"],
            parts=tuple(Part(**part) for part in fields["parts"]),
            lost=tuple(fields["lost"]),
            si=fields["si"],
            remarks=tuple(remark["text"] for remark in fields["remarks"]),
        )

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(self.toml)}</pre>"


def _plain(value: Any) -> Any:
    """A number of numpy's as Python's; parameters are floats."""
    if isinstance(value, str):
        return value
    if isinstance(value, Mapping):
        return {key: _plain(one) for key, one in value.items()}
    return float(value)


def toml_of(model: Any) -> str:
    """The TOML of a model, or of a model file."""
    return model.toml if isinstance(model, Model) else Model.read(Path(model)).toml
