"""What all results share: frozen dataclasses of the documents that the command prints with ``--json``.

A number that is not known is ``None``. Parameters are in the units that stand beside them.
"""

from __future__ import annotations

import dataclasses
import json
import typing
from dataclasses import dataclass
from typing import Any, Mapping, Optional

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


Kind = typing.TypeVar("Kind")


def of(kind: typing.Callable[..., Kind], document: str, **more: Any) -> Kind:
    """A result of the command's document."""
    fields = json.loads(document)
    return kind(**_fields(kind, fields), document=fields, **more)


def _fields(kind: Any, document: Mapping[str, Any]) -> dict[str, Any]:
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
    if isinstance(hint, type) and dataclasses.is_dataclass(hint):
        return hint(**_fields(hint, value))
    if isinstance(value, dict):
        return {key: _value(inner[1], one) for key, one in value.items()}
    return value
