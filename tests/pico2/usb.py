"""The host's end of USB: what its controller does to the buffers and registers of the device's."""

import struct

from board import DPRAM, USB, Broken

IN, OUT = 0, 1
AVAILABLE, FULL, LENGTH = 1 << 10, 1 << 15, 0x3FF
SETUP, RESET = 1 << 17, 1 << 19
ADDRESS = 9


class Bus:
    def __init__(self, board):
        self.board, self.packet = board, 8
        self.raise_status(RESET)
        self.device = self.control(0x80, 6, 0x0100, 0, 18)
        self.packet = self.device[7]
        self.control(0, 5, ADDRESS, 0, 0)
        assert board.registers[USB] & 0x7F == ADDRESS, "the address is not taken"
        self.configuration = self.control(0x80, 6, 0x0200, 0, 255)
        self.serial = self.control(0x80, 6, 0x0300 | self.device[16], 0x0409, 255)[2:].decode("utf-16-le")
        self.control(0, 9, 1, 0, 0)
        # The port is opened.
        self.control(0x21, 0x22, 3, 0, 0)
        self.bulk = {address >> 7: address & 15 for address in self.endpoints(2)}

    def endpoints(self, kind):
        at = 0
        while at < len(self.configuration):
            length, what = self.configuration[at : at + 2]
            if what == 5 and self.configuration[at + 3] == kind:
                yield self.configuration[at + 2]
            at += length

    def word(self, at):
        return struct.unpack("<I", self.board.uc.mem_read(DPRAM + at, 4))[0]

    def set(self, at, word):
        self.board.uc.mem_write(DPRAM + at, struct.pack("<I", word))

    def wait(self, until):
        for _ in range(100):
            found = until()
            if found or found == b"":
                return found
            self.board.advance()
        raise Broken("the device does not answer for 10 ms")

    def raise_status(self, bit):
        self.board.registers[USB + 0x50] |= bit
        self.wait(lambda: not self.board.registers[USB + 0x50] & bit)

    def place(self, endpoint, direction):
        return 0x100 if endpoint == 0 else self.word(8 * endpoint + 4 * direction) & 0xFFFF

    def take(self, endpoint):
        """The packet that the device offers, if there is one."""
        at = 0x80 + 8 * endpoint
        control = self.word(at)
        if not (control & AVAILABLE and control & FULL):
            return None
        data = bytes(self.board.uc.mem_read(DPRAM + self.place(endpoint, IN), control & LENGTH))
        self.set(at, control & ~(AVAILABLE | FULL))
        self.board.registers[USB + 0x58] |= 1 << 2 * endpoint
        return data

    def give(self, endpoint, data):
        at = 0x84 + 8 * endpoint
        control = self.wait(lambda: self.word(at) & AVAILABLE and self.word(at))
        self.board.uc.mem_write(DPRAM + self.place(endpoint, OUT), data)
        self.set(at, control & ~(AVAILABLE | LENGTH) | FULL | len(data))
        self.board.registers[USB + 0x58] |= 2 << 2 * endpoint
        self.board.advance()

    def control(self, kind, request, value, index, length):
        self.board.uc.mem_write(DPRAM, struct.pack("<BBHHH", kind, request, value, index, length))
        self.raise_status(SETUP)
        data = b""
        while True:
            packet = self.wait(lambda: self.take(0))
            data += packet
            if len(packet) < self.packet or len(data) >= length:
                break
        if kind & 0x80:
            self.give(0, b"")
        self.board.advance(2)
        return data
