"""The Pico 2's image on an emulated Cortex-M33, with the registers that it uses. What it does not use is refused.

The core is Unicorn's; it has no interrupts of its own. A handler is called between two instructions of the thread, where
the thread sleeps, with the registers put back afterwards. Time passes by ticks alone. The PIO's program is not run: its
count is put where the program would (firmware/src/board/pico2/program has a test of its own).
"""

import struct
from collections import defaultdict

import unicorn
from elftools.elf.elffile import ELFFile
from unicorn import arm_const as arm

from rom import Rom

FLASH, RAM, RAM_BYTES = 0x1000_0000, 0x2000_0000, 520 * 1024
CLOCKS, PSM, RESETS, IO, XOSC = 0x4001_0000, 0x4001_8000, 0x4002_0000, 0x4002_8000, 0x4004_8000
PLLS, PWM, TIMER, WATCHDOG = (0x4005_0000, 0x4005_8000), 0x400A_8000, 0x400B_0000, 0x400D_8000
DPRAM, USB, PIO, SIO, CORE = 0x5010_0000, 0x5011_0000, 0x5020_0000, 0xD000_0000, 0xE000_0000
IN1, IN2, STOP, LAMP = 2, 3, 8, 25
SLICE = PWM + 0x14 * 1
FULL = 3750
# Exceptions by their numbers.
HARD_FAULT, TICK, PRESSED = 3, 16 + 8, 16 + 21
# Where a handler returns to: a place in the ROM that nothing else uses.
RETURN = 0x7000
TICK_US = 100
# What is in RAM before the program writes to it, and where its stack starts.
UNTOUCHED, STACK = 0xA5, 0x2008_0000


class Broken(Exception):
    """The image did what it must not."""


class Board:
    """A board at its reset, with a flash and what its RAM holds."""

    def __init__(self, flash=None, elf=None, ram=None):
        self.uc = unicorn.Uc(
            unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS, cpu=arm.UC_CPU_ARM_CORTEX_M33
        )
        self.registers = defaultdict(int)
        self.flash = bytearray(flash if flash else b"\xff" * 4 * 1024 * 1024)
        self.microseconds, self.count, self.pressed = 0, 0, False
        self.transition_error, self.fed, self.reset = False, 0, False
        self.low_at_reset, self.handling, self.taken = None, False, []
        self.press_at_release, self.lock = False, None
        if elf:
            self.load(elf)
        self.uc.mem_map(RAM, RAM_BYTES)
        # What is in RAM after power-on is nothing to rely on.
        self.uc.mem_write(RAM, bytes(ram) if ram else bytes([UNTOUCHED]) * RAM_BYTES)
        self.uc.mem_map(DPRAM, 0x1000)
        for base, size in ((0x4000_0000, 0x20_0000), (USB, 0x20_0000), (SIO, 0x10_0000), (CORE, 0x10_0000)):
            self.uc.mmio_map(base, size, self.read, base, self.write, base)
        self.rom = Rom(self)
        self.uc.hook_add(unicorn.UC_HOOK_MEM_UNMAPPED, self.unmapped)

    def load(self, elf):
        with open(elf, "rb") as file:
            for segment in ELFFile(file).iter_segments():
                if segment["p_type"] == "PT_LOAD" and segment["p_filesz"]:
                    at = segment["p_paddr"] - FLASH
                    self.flash[at : at + segment["p_filesz"]] = segment.data()

    def unmapped(self, uc, access, address, size, value, _):
        raise Broken(f"{address:#x} is accessed from {uc.reg_read(arm.UC_ARM_REG_PC):#x}")

    def read(self, uc, offset, size, base):
        at = base + offset
        value = self.register(at & ~3)
        return value >> 8 * (at & 3) & (1 << 8 * size) - 1

    def register(self, at):
        if at == RESETS + 8:
            return ~self.registers[RESETS] & 0x1FFF_FFFF
        if at == XOSC + 4 or at in PLLS:
            return self.registers[at] | 1 << 31
        if CLOCKS <= at < CLOCKS + 0x84 and (at - CLOCKS) % 12 == 8:
            glitchless = at - 8 in (CLOCKS + 0x30, CLOCKS + 0x3C)
            return 1 << (self.registers[at - 8] & 3 if glitchless else 0)
        if at == TIMER + 0x28:
            return self.microseconds & 0xFFFF_FFFF
        if at == SIO + 4:
            return self.pressed << STOP
        if at == PIO + 0x30:
            return int(self.transition_error)
        if at == PIO + 0x128:
            return self.count & 0xFFFF_FFFF
        if at == USB + 0x98:
            status = self.registers[USB + 0x50]
            raised = (status >> 17 & 1) << 16 | (status >> 19 & 1) << 12 | bool(self.registers[USB + 0x58]) << 4
            return raised & self.registers[USB + 0x90]
        return self.registers[at]

    def write(self, uc, offset, size, value, base):
        at, alias = base + offset, 0
        if base not in (SIO, CORE):
            # Beside each register are three that change, set and clear its bits.
            alias, at = at >> 12 & 3, at & ~0x3000
        shift = 8 * (at & 3)
        at &= ~3
        before = self.registers[at]
        part = (1 << 8 * size) - 1 << shift
        value = before & ~part | value << shift & part
        value = (value, before ^ value, before | value, before & ~value)[alias] & 0xFFFF_FFFF
        if at in (USB + 0x50, USB + 0x58):
            self.registers[at] = before & ~value
        elif at == PIO + 0x30:
            self.transition_error &= not value & 1
        elif at == IO + 8 * IN1 + 4 and self.press_at_release and not value >> 12 & 3:
            self.registers[at], self.pressed = value, True
        elif at == CORE + 0xE100:
            # Enables interrupts, and never disables one.
            self.registers[at] |= value
        elif at == WATCHDOG and value >> 31:
            self.reset, self.low_at_reset = True, self.held_low()
            uc.emu_stop()
        else:
            self.fed += at == WATCHDOG + 4
            self.registers[at] = value

    def boot(self):
        """As the boot ROM: stack and first instruction are the first two words. To the first sleep."""
        stack, entry = struct.unpack("<2I", self.flash[:8])
        self.uc.reg_write(arm.UC_ARM_REG_SP, stack)
        self.run(entry)
        return self

    def run(self, entry):
        self.uc.emu_start(entry, RETURN, count=50_000_000)

    def interrupt(self, number):
        table = self.registers[CORE + 0xED08]
        (handler,) = struct.unpack("<I", self.uc.mem_read(table + 4 * number, 4))
        thread = self.uc.context_save()
        self.uc.reg_write(arm.UC_ARM_REG_LR, RETURN | 1)
        self.taken.append(0)
        self.handling = True
        self.run(handler)
        self.handling = False
        at = self.uc.reg_read(arm.UC_ARM_REG_PC)
        if not self.reset and at != RETURN:
            raise Broken(f"the handler of {number} stopped at {at:#x}")
        self.uc.context_restore(thread)

    def tick(self):
        self.microseconds += TICK_US
        self.interrupt(TICK)

    def advance(self, ticks=1):
        """Ticks, each of which wakes the thread."""
        for _ in range(ticks):
            if not self.reset:
                self.tick()
            if not self.reset:
                self.wake()

    def wake(self):
        """The thread, from one sleep to the next."""
        self.run(self.uc.reg_read(arm.UC_ARM_REG_PC) | 1)

    def press(self):
        self.pressed = True
        self.interrupt(PRESSED)

    def count_ticks(self):
        """From now on: the instructions of each tick."""
        self.taken = []
        self.uc.hook_add(unicorn.UC_HOOK_CODE, self.instruction)
        return self.taken

    def instruction(self, *_):
        if self.handling:
            self.taken[-1] += 1

    def count_locks(self):
        """From now on: the instructions of the thread with interrupts masked, lock by lock."""
        self.locks = []
        self.uc.hook_add(unicorn.UC_HOOK_CODE, self.masked)
        return self.locks

    def masked(self, uc, at, size, _):
        if self.handling:
            return
        code = bytes(uc.mem_read(at, size))
        if self.lock is not None:
            self.lock += 1
        # msr primask, rN ends what cpsid i has begun.
        if code == b"\x72\xb6" and self.lock is None:
            self.lock = 0
        elif code[1:] == b"\xf3\x10\x88" and code[0] >> 4 == 8 and self.lock is not None:
            self.locks.append(self.lock)
            self.lock = None

    def count_press(self):
        self.press()
        return self.taken[-1]

    def held_low(self):
        """Whether the bridge's inputs are low whatever the PWM says: all switches open."""
        return all(self.registers[IO + 8 * pin + 4] >> 12 & 3 == 2 for pin in (IN1, IN2))

    def drive(self):
        """The motor's mean voltage over the supply; None where it coasts."""
        word = self.registers[SLICE + 0x0C]
        return None if self.held_low() else ((word & 0xFFFF) - (word >> 16)) / FULL

    def stack_used(self):
        """Bytes down to the lowest that was written to, above a stretch of 64 KiB that nobody wrote to."""
        ram, untouched = self.ram()[: STACK - RAM], bytes([UNTOUCHED])
        free = ram.find(untouched * 64 * 1024)
        return len(ram[free:].lstrip(untouched))

    def ram(self):
        return self.uc.mem_read(RAM, RAM_BYTES)
