"""The host's end of the link (docs/link.md), written after that page."""

import struct
import zlib

from board import Broken
from usb import Bus

REPLY, EVENT, SAMPLES = 0, 1, 2


class Link:
    def __init__(self, board):
        self.board, self.bus = board, Bus(board)
        self.bytes, self.id = b"", 0
        self.events, self.batches = [], []
        # What else happens in a tick: the axis moves.
        self.world = lambda: None

    def frame(self, number, content):
        self.id += 1
        request = varint(self.id) + bytes([number]) + content
        return b"\0" + cobs(request + struct.pack("<I", zlib.crc32(request))) + b"\0"

    def ask(self, number, content=b""):
        """The reply to a command: its number and its content."""
        frame = self.frame(number, content)
        for at in range(0, len(frame), 64):
            self.bus.give(self.bus.bulk[0], frame[at : at + 64])
        # A save erases meanwhile; by ticks of the thread it is one.
        for _ in range(500):
            for kind, message in self.advance():
                if kind == REPLY and message.startswith(varint(self.id)):
                    reply = message[len(varint(self.id)) :]
                    return reply[0], reply[1:]
        raise Broken(f"no reply to {frame.hex()}")

    def advance(self):
        """One tick; the messages that have arrived."""
        self.world()
        self.board.advance()
        self.bytes += (not self.board.reset and self.bus.take(self.bus.bulk[1])) or b""
        *frames, self.bytes = self.bytes.split(b"\0")
        messages = []
        for message in map(uncobs, filter(None, frames)):
            content, checksum = message[:-4], struct.unpack("<I", message[-4:])[0]
            assert zlib.crc32(content) == checksum, f"damaged: {message.hex()}"
            messages.append((content[0], content[1:]))
        self.events += [content for kind, content in messages if kind == EVENT]
        self.batches += [content for kind, content in messages if kind == SAMPLES]
        return messages


def varint(number):
    return bytes([number]) if number < 128 else bytes([number & 127 | 128]) + varint(number >> 7)


def signed(number):
    return varint(2 * number if number >= 0 else -2 * number - 1)


def bounds(ticks):
    return varint(ticks) + signed(0) + varint(0)


def relay(h1, h2, ticks):
    """Drive codes; around the start, with the settings' hysteresis."""
    return signed(h1) + signed(h2) + b"\0" + b"\0" + signed(0) + varint(0) + b"\0\0" + bounds(ticks)


def cobs(data):
    """For frames of less than 254 bytes."""
    return b"".join(bytes([len(block) + 1]) + block for block in data.split(b"\0"))


def uncobs(data):
    out, at = b"", 0
    while at < len(data):
        code = data[at]
        out += data[at + 1 : at + code]
        at += code
        if code < 255 and at < len(data):
            out += b"\0"
    return out
