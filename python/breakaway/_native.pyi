"""The extension module. Only :class:`Recording` is seen outside the package."""

import os
from typing import Any, Callable, Mapping, final

import numpy as np
import numpy.typing as npt

__all__ = ["discover", "identify", "sinefit", "export", "make_model", "parse_model", "read_model", "write_text", "Recording", "read", "simulate", "simulate_drive", "__version__"]
__version__: str

@final
class Recording:
    """One recording of an axis, checked and mended, evenly sampled or not.

    ``u[k]`` is the drive applied from ``t[k]`` to ``t[k + 1]``, and ``x[k]`` the position read at ``t[k]``. The columns
    have one length, at least 8, hold finite numbers, and ``t`` increases strictly. They are read-only arrays of float64.
    :func:`breakaway.read` makes one of a file, and :func:`breakaway.recording` of arrays.
    """

    def __new__(
        cls,
        t: npt.NDArray[np.float64],
        u: npt.NDArray[np.float64],
        x: npt.NDArray[np.float64],
        *,
        current: npt.NDArray[np.float64] | None,
        units: tuple[str | None, str | None],
        name: str,
        options: Mapping[str, Any],
    ) -> "Recording": ...
    def __len__(self) -> int: ...
    @property
    def t(self) -> npt.NDArray[np.float64]:
        """Time, s, strictly increasing."""
    @property
    def u(self) -> npt.NDArray[np.float64]:
        """Applied drive, in ``units[0]``."""
    @property
    def x(self) -> npt.NDArray[np.float64]:
        """Measured position, in ``units[1]``."""
    @property
    def current(self) -> npt.NDArray[np.float64] | None:
        """Motor current, A, where it was measured."""
    @property
    def name(self) -> str:
        """What reports call it: the file's name without folder and ending."""
    @property
    def units(self) -> tuple[str, str]:
        """Units of drive and position; ``("u", "x")`` where they are not known."""
    @property
    def encoder_step(self) -> float | None:
        """Encoder step in position units, > 0, where it is known or was inferred."""
    @property
    def counts_per_turn(self) -> float | None:
        """Position units per turn of the axis, > 0, where the position is in counts and it is known."""
    @property
    def gaps(self) -> list[int]:
        """Rows at which a new piece begins because samples before it are missing."""
    @property
    def meta(self) -> dict[str, str]:
        """Where it comes from: experiment, firmware build, seed and the like."""
    @property
    def warnings(self) -> list[str]:
        """What is doubtful about it, and what was mended, one sentence each."""
    @property
    def sha256(self) -> str:
        """SHA-256, in hex, of the file's bytes, or of the arrays; empty for a simulated recording."""
    def write(self, path: str | os.PathLike[str], force: bool = False) -> None:
        """Writes it as CSV, whole or not at all; every number has the same bits when it is read again."""

def read(path: str, options: Mapping[str, Any]) -> Recording: ...
def identify(recordings: list[Recording], *, back_emf: float | None, threads: int | None) -> tuple[str, str]: ...
def discover(
    recordings: list[Recording],
    holdout: list[Recording],
    *,
    model: tuple[str, str] | None,
    command: str,
    threads: int | None,
    progress: Callable[[str], object] | None,
) -> tuple[str, str, str]: ...
def sinefit(t: npt.NDArray[np.float64], x: npt.NDArray[np.float64], *, period: float | None, name: str) -> str: ...
def simulate(model: str, form: str, text: str) -> tuple[Recording, npt.NDArray[np.float64], float | None]: ...
def simulate_drive(
    model: str, u: npt.NDArray[np.float64], text: str
) -> tuple[Recording, npt.NDArray[np.float64], float | None]: ...
def parse_model(name: str, text: str) -> str: ...
def read_model(path: str) -> str: ...
def make_model(tables: str) -> str: ...
def export(model: str, target: str, *, name: str, timestep: float, motor: Mapping[str, Any]) -> str: ...
def write_text(path: str, text: str, kind: str, force: bool) -> None: ...
