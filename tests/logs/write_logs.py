"""Writes a recording in every format that `breakaway` reads, by the format's own package.

Usage: write_logs.py RECORDING.csv FOLDER. The recording has the columns t, u and x.
"""

import csv
import ctypes
import json
import shutil
import sqlite3
import struct
import sys
from pathlib import Path

import can_log
import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import scipy.io
from mcap.writer import CompressionType, Writer
from mcap_protobuf.writer import Writer as ProtobufWriter
from mcap_ros2.writer import Writer as Ros2Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as BagWriter
from rosbags.typesys import Stores, get_typestore

JOINT_STATE = """\
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""


def read(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return tuple(np.array([float(row[name]) for row in rows]) for name in ("t", "u", "x"))


def nanoseconds(t):
    return np.rint(t * 1e9).astype(np.int64)


def numpy_files(folder, t, u, x):
    np.savez(folder / "plain.npz", t=t, u=u, x=x)
    np.savez_compressed(folder / "packed.npz", t=t, u=u, x=x, joints=np.stack([x, -x]), rate=np.array(1.0))
    records = np.zeros(len(t), dtype=[("t", "<f8"), ("u", ">f8"), ("x", "<f8")])
    records["t"], records["u"], records["x"] = t, u, x
    np.save(folder / "records.npy", records)


def matlab_files(folder, t, u, x):
    scipy.io.savemat(folder / "v5.mat", {"t": t, "u": u, "x": x}, oned_as="column")
    scipy.io.savemat(folder / "v7.mat", {"log": {"t": t, "u": u, "x": x, "note": "a bench"}}, do_compression=True)


def matlab_73(folder, t, u, x):
    """As MATLAB's `save -v7.3` lays it out: 512 bytes that name the version, then HDF5. MATLAB itself could not be had."""
    path = folder / "v73.mat"
    with h5py.File(path, "w", userblock_size=512, libver="earliest") as file:
        log = file.create_group("log")
        log.attrs["MATLAB_class"] = np.bytes_("struct")
        for name, values in {"t": t, "u": u, "x": x}.items():
            packed = {"compression": "gzip", "chunks": (1, len(t))} if name == "u" else {}
            array = log.create_dataset(name, data=values.reshape(1, -1), **packed)
            array.attrs["MATLAB_class"] = np.bytes_("double")
        note = log.create_dataset("note", data=np.frombuffer("a bench".encode("utf-16-le"), "<u2").reshape(-1, 1))
        note.attrs["MATLAB_class"] = np.bytes_("char")
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116) + bytes(8) + b"\x00\x02IM"
    with open(path, "r+b") as file:
        file.write(head)


def bag(folder, t, u, x):
    """A bag of ROS 2 in SQLite. The second is as ROS 2 Humble writes it, without definitions."""
    types = get_typestore(Stores.ROS2_HUMBLE)
    State, Header, Time = (
        types.types[name] for name in ("sensor_msgs/msg/JointState", "std_msgs/msg/Header", "builtin_interfaces/msg/Time")
    )
    for name, version in (("bag", 9), ("humble", 8)):
        place = folder / f"{name}-folder"
        with BagWriter(place, version=version, storage_plugin=StoragePlugin.SQLITE3) as writer:
            topic = writer.add_connection("/joint_states", State.__msgtype__, typestore=types)
            for k, ns in enumerate(int(ns) for ns in nanoseconds(t)):
                header = Header(stamp=Time(sec=ns // 10**9, nanosec=ns % 10**9), frame_id="base")
                message = State(
                    header=header,
                    name=["other", "axis"],
                    position=np.array([0.5, x[k]]),
                    velocity=np.array([]),
                    effort=np.array([0.25, u[k]]),
                )
                late = 2_000_000 + k * 7919 % 1_000_000
                writer.write(topic, ns + late, types.serialize_cdr(message, State.__msgtype__))
        path = folder / f"{name}.db3"
        next(place.glob("*.db3")).rename(path)
        shutil.rmtree(place)
        if version == 8:
            file = sqlite3.connect(path)
            file.executescript("DROP TABLE message_definitions; VACUUM;")
            file.close()


def parquet_files(folder, t, u, x):
    table = pa.table({"t": t, "u": u, "x": x, "state": ["on"] * len(t), "list": [[1.0]] * len(t)})
    pq.write_table(table, folder / "snappy.parquet", row_group_size=700)
    pq.write_table(table, folder / "gzip.parquet", compression="gzip")
    pq.write_table(table, folder / "zstd.parquet", compression="zstd")
    stamps = pa.array(nanoseconds(t), pa.timestamp("ns"))
    pq.write_table(pa.table({"time": stamps, "u": u, "x": x}), folder / "stamps.parquet")


class Text(ctypes.Structure):
    """WPI_String."""

    _fields_ = [("text", ctypes.c_char_p), ("length", ctypes.c_size_t)]


def text(value):
    return ctypes.byref(Text(value.encode(), len(value.encode())))


def wpilog(folder, t, u, x):
    """As SysId's routine logs it: the state of the test, then voltage, position and velocity of each loop.

    The package binds no writer to Python, so that WPILib's own is called in its library.
    """
    import native.wpiutil

    place = Path(next(iter(native.wpiutil.__path__))) / "lib"
    library = ctypes.CDLL(str(next(place.glob("*wpiutil*"))))
    create, start = library.WPI_DataLog_CreateWriter, library.WPI_DataLog_Start
    create.restype = ctypes.c_void_p
    number, append_text = library.WPI_DataLog_AppendDouble, library.WPI_DataLog_AppendString
    error = ctypes.c_int(0)
    log = ctypes.c_void_p(create(text(str(folder / "sysid.wpilog")), ctypes.byref(error), text("")))
    assert error.value == 0

    def entry(name, kind):
        return start(log, text(name), text(kind), text(""), ctypes.c_int64(1))

    state = entry("sysid-test-state-drive", "string")
    names = ("voltage-motor-drive", "position-motor-drive", "velocity-motor-drive")
    entries = [entry(name, "double") for name in names]
    # WPILib takes 0 for "now".
    stamps = [max(int(stamp), 1) for stamp in np.rint(t * 1e6)]
    append_text(log, state, text("quasistatic-forward"), ctypes.c_int64(stamps[0]))
    for k, values in enumerate(zip(u, x, np.gradient(x, t))):
        for place, value in zip(entries, values):
            number(log, place, ctypes.c_double(value), ctypes.c_int64(stamps[k]))
    append_text(log, state, text("none"), ctypes.c_int64(stamps[-1] + 1))
    library.WPI_DataLog_Flush(log)
    library.WPI_DataLog_Release(log)


def mcap_cdr(path, t, u, x, compression):
    with open(path, "wb") as file:
        writer = Ros2Writer(file, compression=compression)
        schema = writer.register_msgdef("sensor_msgs/msg/JointState", JOINT_STATE)
        for k, ns in enumerate(int(ns) for ns in nanoseconds(t)):
            message = {
                "header": {"stamp": {"sec": ns // 10**9, "nanosec": ns % 10**9}, "frame_id": "base"},
                "name": ["other", "axis"],
                "position": [0.5, float(x[k])],
                "velocity": [],
                "effort": [0.25, float(u[k])],
            }
            # A recorder stamps a message when it comes, here 2 to 3 ms later.
            late = 2_000_000 + k * 7919 % 1_000_000
            writer.write_message("/joint_states", schema, message, log_time=ns + late, publish_time=ns + late)
        writer.finish()


def mcap_json(path, t, u, x):
    """Drive and position as scalars of topics of their own."""
    with open(path, "wb") as file:
        writer = Writer(file, compression=CompressionType.NONE)
        writer.start()
        schema = writer.register_schema("number", "jsonschema", json.dumps({"type": "object"}).encode())
        channels = [writer.register_channel(name, "json", schema) for name in ("/drive", "/encoder")]
        writer.register_channel("/unknown", "flatbuffer", schema)
        for k, ns in enumerate(int(ns) for ns in nanoseconds(t)):
            for channel, data in zip(channels, ({"voltage": float(u[k])}, {"position": float(x[k])})):
                writer.add_message(channel, ns, json.dumps(data).encode(), ns)
        writer.finish()


def protobuf_class():
    """A message with a stamp, and a drive and a position as its axis' fields, without a compiler of protobuf."""
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory, timestamp_pb2

    file = descriptor_pb2.FileDescriptorProto(name="bench.proto", package="bench", syntax="proto3")
    file.dependency.append("google/protobuf/timestamp.proto")
    axis = file.message_type.add(name="Axis")
    axis.field.add(name="voltage", number=1, type=1, label=1)
    axis.field.add(name="position", number=2, type=1, label=1)
    state = file.message_type.add(name="State")
    state.field.add(name="stamp", number=1, type=11, label=1, type_name=".google.protobuf.Timestamp")
    state.field.add(name="axis", number=2, type=11, label=1, type_name=".bench.Axis")
    state.field.add(name="currents", number=3, type=2, label=3)
    pool = descriptor_pool.DescriptorPool()
    pool.AddSerializedFile(timestamp_pb2.DESCRIPTOR.serialized_pb)
    pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName("bench.State"))


def mcap_protobuf(path, t, u, x):
    kind = protobuf_class()
    with open(path, "wb") as file, ProtobufWriter(file) as writer:
        for k, ns in enumerate(int(ns) for ns in nanoseconds(t)):
            message = kind(currents=[1.0, 2.0])
            message.stamp.seconds, message.stamp.nanos = divmod(ns, 10**9)
            message.axis.voltage, message.axis.position = float(u[k]), float(x[k])
            writer.write_message("/state", message, log_time=ns, publish_time=ns)


def ulog(folder, t, u, x):
    """pyulog only reads; this is the format's description, and pyulog reads it back."""

    def message(kind, content):
        return struct.pack("<HB", len(content), ord(kind)) + content

    out = bytearray(b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0))
    out += message("B", bytes(40))
    out += message("F", b"motor:uint64_t timestamp;float[2] spare;double u;double x;uint8_t[4] _padding0;")
    out += message("A", struct.pack("<BH", 0, 0) + b"motor")
    for k, stamp in enumerate(np.rint(t * 1e6).astype(int)):
        out += message("D", struct.pack("<HQffdd", 0, int(stamp), 1.0, 2.0, u[k], x[k]))
    (folder / "motor.ulg").write_bytes(out)
    from pyulog import ULog

    assert np.array_equal(ULog(str(folder / "motor.ulg")).data_list[0].data["x"], x)


def csv_files(folder, t, u, x):
    ns = nanoseconds(t)
    with open(folder / "split.csv", "w") as file:
        file.write("header.stamp.sec,header.stamp.nanosec,position,effort\n")
        for k, stamp in enumerate(int(stamp) for stamp in ns):
            cells = f'"[0.5, {float(x[k])!r}]","[{float(u[k])!r}]"'
            file.write(f"{stamp // 10**9},{stamp % 10**9},{cells}\n")
    with open(folder / "comma.csv", "w") as file:
        file.write("Zeit_ms;u;x\n")
        for row in zip(t * 1e3, u, x):
            file.write(";".join(repr(float(value)).replace(".", ",") for value in row) + "\n")
    with open(folder / "dates.csv", "w") as file:
        file.write("time,u,x\n")
        for stamp, drive, position in zip(ns, u, x):
            text = np.datetime_as_string(np.datetime64(1_700_000_000 * 10**9 + int(stamp), "ns"))
            file.write(f"{text}Z,{float(drive)!r},{float(position)!r}\n")


def main():
    (t, u, x), folder = read(sys.argv[1]), Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    numpy_files(folder, t, u, x)
    matlab_files(folder, t, u, x)
    matlab_73(folder, t, u, x)
    bag(folder, t, u, x)
    parquet_files(folder, t, u, x)
    wpilog(folder, t, u, x)
    mcap_cdr(folder / "zstd.mcap", t, u, x, CompressionType.ZSTD)
    mcap_cdr(folder / "lz4.mcap", t, u, x, CompressionType.LZ4)
    mcap_json(folder / "json.mcap", t, u, x)
    mcap_protobuf(folder / "protobuf.mcap", t, u, x)
    ulog(folder, t, u, x)
    can_log.write(folder, t, u, x)
    csv_files(folder, t, u, x)


main()
