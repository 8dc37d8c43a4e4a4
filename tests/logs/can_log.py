"""A recording as frames of CAN: python-can writes the log, cantools the description, and cantools decodes what it says.

Beside `can.log` and `can.dbc` lies `can.json`: of each signal the rows, the least and the greatest value.
"""

import json
from collections import defaultdict

import can
import numpy as np
from cantools.database import Database, Message, Signal
from cantools.database.conversion import BaseConversion


def number(name, start, length, unit, **more):
    """A signal that is a float."""
    return Signal(name, start, length, conversion=BaseConversion.factory(is_float=True), unit=unit, **more)


def scaled(name, start, length, scale, offset, unit, **more):
    """A signal that is an integer with a sign."""
    conversion = BaseConversion.factory(scale=scale, offset=offset)
    return Signal(name, start, length, is_signed=True, conversion=conversion, unit=unit, **more)


def description():
    """Doubles in a frame of CAN FD, and in a classical one integers of both orders of bytes behind a multiplexor."""
    axis = [number("voltage", 0, 64, "V"), number("position", 64, 64, "m")]
    of = {"multiplexer_signal": "page"}
    encoder = [
        Signal("page", 0, 8, is_multiplexer=True),
        # A motorola signal starts at its highest bit.
        scaled("counts", 15, 32, 1e-6, 0.0, "m", byte_order="big_endian", multiplexer_ids=[0], **of),
        scaled("temperature", 8, 16, 0.1, 40.0, "degC", multiplexer_ids=[1], **of),
        number("current", 32, 32, "A", multiplexer_ids=[1], **of),
    ]
    return Database(
        [
            Message(0x21, "axis", 16, axis, is_fd=True),
            Message(0x1ABCDE, "encoder", 8, encoder, is_extended_frame=True),
        ]
    )


def frames(database, t, u, x):
    """The messages of the bus: of each row one with doubles and one with integers, and some that nobody described."""
    axis, encoder = database.get_message_by_name("axis"), database.get_message_by_name("encoder")
    for k, stamp in enumerate(float(stamp) for stamp in t):
        values = {"voltage": float(u[k]), "position": float(x[k])}
        yield can.Message(stamp, axis.frame_id, is_extended_id=False, is_fd=True, data=axis.encode(values))
        page = {"page": 0, "counts": float(x[k])}
        if k % 10 == 9:
            page = {"page": 1, "temperature": 40.0 + 0.1 * (k % 300) - 10.0, "current": float(u[k])}
        yield can.Message(stamp, encoder.frame_id, data=encoder.encode(page))
        if k % 100 == 0:
            yield can.Message(stamp, 0x700, is_extended_id=False, data=b"\x05")
            yield can.Message(stamp, 0x21, is_extended_id=False, is_remote_frame=True)


def write(folder, t, u, x):
    database = description()
    (folder / "can.dbc").write_text(database.as_dbc_string(), encoding="latin-1")
    with can.CanutilsLogWriter(folder / "can.log") as log:
        for message in frames(database, t, u, x):
            log.on_message_received(message)
    # What is compared was read back from both files.
    database = Database()
    database.add_dbc_file(folder / "can.dbc", encoding="latin-1")
    found = defaultdict(list)
    for message in can.CanutilsLogReader(folder / "can.log"):
        if message.arbitration_id == 0x700 or message.is_remote_frame:
            continue
        kind = database.get_message_by_frame_id(message.arbitration_id)
        for name, value in kind.decode(bytes(message.data)).items():
            found[f"{kind.name}/{name}"].append(value)
    read = {name: [len(values), float(np.min(values)), float(np.max(values))] for name, values in found.items()}
    (folder / "can.json").write_text(json.dumps(read))
