"""Breakaway for numpy: what an axis is made of, and what its model misses.

The base model of an axis is ``b·ẍ + c·ẋ + f1·sgn ẋ + load = u``. Here ``u`` is the applied drive and ``x`` the position::

    import breakaway as bk

    rec = bk.read("rec.csv", time="t_s", input="u_V", position="x_rad")
    found = bk.discover(rec)        # or bk.discover((t, u, x))
    print(found.sentence)
    found.model.write("improved.toml")

Time is in s. Drive and position have the units of the recording, and all parameters follow from them. Work runs without
the interpreter's lock, and Ctrl-C ends it. An error is an exception below :class:`Error`, with the text that the command
``breakaway`` prints. The flag ``--encoder-step`` of such a text is the keyword ``encoder_step`` here.
"""

from ._analysis import discover, identify, read, recording, simulate, sinefit
from ._discovery import (
    Candidate,
    Discovery,
    Force,
    FoundEffect,
    Input,
    NextExperiment,
    Provenance,
    Rival,
    Rung,
    Share,
    Unexplained,
    UnexplainedForce,
    Where,
)
from ._errors import (
    ArrayError,
    CardError,
    ControlError,
    DeviceError,
    DiscoverError,
    Error,
    ExportError,
    FileError,
    FitError,
    IdentifyError,
    ModelError,
    RecordingError,
    SimulateError,
    SineFitError,
    UsageError,
)
from ._identification import (
    Estimate,
    Gravity,
    HeldOut,
    Identification,
    Undetermined,
    Winding,
)
from ._model import Effect, Export, Model, Part
from ._native import Recording, __version__
from ._results import Quantity, Remark
from ._signals import Simulation, SineErrors, SineFit

__all__ = [
    "ArrayError",
    "Candidate",
    "CardError",
    "ControlError",
    "DeviceError",
    "DiscoverError",
    "Discovery",
    "Effect",
    "Error",
    "Estimate",
    "Export",
    "ExportError",
    "FileError",
    "FitError",
    "Force",
    "FoundEffect",
    "Gravity",
    "HeldOut",
    "Identification",
    "IdentifyError",
    "Input",
    "Model",
    "ModelError",
    "NextExperiment",
    "Part",
    "Provenance",
    "Quantity",
    "Recording",
    "RecordingError",
    "Remark",
    "Rival",
    "Rung",
    "Share",
    "SimulateError",
    "Simulation",
    "SineErrors",
    "SineFit",
    "SineFitError",
    "Undetermined",
    "Unexplained",
    "UnexplainedForce",
    "UsageError",
    "Where",
    "Winding",
    "__version__",
    "discover",
    "identify",
    "read",
    "recording",
    "simulate",
    "sinefit",
]
