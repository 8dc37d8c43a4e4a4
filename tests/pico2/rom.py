"""The boot ROM's functions, as far as the image calls them: each is a return in the ROM, found by its place."""

import struct

import unicorn
from unicorn import arm_const as arm

FLASH, SECTOR, PAGE = 0x1000_0000, 4096, 256
# An erase of a sector takes 45 ms, typically: so many ticks.
ERASE_TICKS = 450


class Rom:
    def __init__(self, board):
        self.board, self.uc = board, board.uc
        self.ticks_during_erase = 0
        functions = {
            "IF": None, "EX": self.exit_xip, "RE": self.erase, "RP": self.program, "FC": None, "CX": self.enter_xip,
            "GS": self.system_info,
        }
        self.places = {tag: 0x440 + 16 * number for number, tag in enumerate(functions)}
        self.functions = {self.places[tag]: function for tag, function in functions.items()} | {0x400: self.look_up}
        self.uc.mem_map(0, 0x8000)
        # Whatever else is run here stops the emulation.
        self.uc.mem_write(0, b"\x00\xbe" * 0x4000)
        self.uc.mem_write(0x13, struct.pack("<BHH", 2, 0, 0x401))
        for at in self.functions:
            self.uc.mem_write(at, b"\x70\x47")
        self.uc.hook_add(unicorn.UC_HOOK_CODE, self.called, begin=0x400, end=0x600)
        self.enter_xip()

    def called(self, uc, address, size, _):
        function = self.functions.get(address)
        if function:
            function(*(uc.reg_read(register) for register in (arm.UC_ARM_REG_R0, arm.UC_ARM_REG_R1, arm.UC_ARM_REG_R2)))

    def look_up(self, tag, mask, _):
        self.uc.reg_write(arm.UC_ARM_REG_R0, self.places[struct.pack("<H", tag & 0xFFFF).decode()] | 1)

    def system_info(self, buffer, words, flags):
        self.uc.mem_write(buffer, struct.pack("<4I", flags, 1, 0x89AB_CDEF, 0x0123_4567))
        self.uc.reg_write(arm.UC_ARM_REG_R0, 4)

    def exit_xip(self, *_):
        """From here on the flash is not to be read: whoever does so meets nothing."""
        self.uc.mem_unmap(FLASH, len(self.board.flash))

    def enter_xip(self, *_):
        self.uc.mem_map(FLASH, len(self.board.flash))
        self.uc.mem_write(FLASH, bytes(self.board.flash))

    def erase(self, at, length, _):
        assert at % SECTOR == 0 and length % SECTOR == 0, f"erase of {length} at {at:#x}"
        self.board.flash[at : at + length] = b"\xff" * length
        # Ticks go on meanwhile, with the flash out of reach.
        for _ in range(ERASE_TICKS):
            self.board.tick()
        self.ticks_during_erase += ERASE_TICKS

    def program(self, at, data, length):
        assert at % PAGE == 0 and length % PAGE == 0, f"program of {length} at {at:#x}"
        for place, byte in enumerate(self.uc.mem_read(data, length), at):
            self.board.flash[place] &= byte
