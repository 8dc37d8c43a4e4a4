"""What the image does between its pins, its USB and its flash. `cargo xtask pico2-test` runs it: IMAGE names the ELF."""

import gc
import os
import unittest

from board import CORE, HARD_FAULT, PSM, WATCHDOG, Board
from link import Link, relay, varint

gc.disable()
ELF = os.environ["IMAGE"]
HELLO, STATUS, GET_SETTINGS, SET_SETTINGS, SAVE, START_RELAY = 0, 1, 2, 3, 6, 7
STREAM_ON, GET_FAULT, CLEAR, REBOOT = 13, 15, 16, 17
INFO, DONE, ERROR, SETTINGS, FAULT = 0, 1, 2, 4, 6
ENCODER_ERROR, PANIC, RESET_WHILE_DRIVEN, EMERGENCY_STOP = 2, 9, 13, 15
FAULT_PERSISTS, FAULTED = 8, 4
# A tenth of the supply each: below the mean drive that the settings allow.
RELAY = (3276, 800)


class Axis:
    """Inertia and Coulomb friction behind an encoder, in supplies, counts and ticks."""

    def __init__(self, board):
        self.board, self.place, self.speed = board, 0.0, 0.0
        self.drives = []

    def __call__(self):
        drive = self.board.drive() or 0.0
        self.drives.append(self.board.drive())
        push = 0.05 * drive
        friction = 0.002
        if self.speed == 0.0 and abs(push) <= friction:
            return
        direction = self.speed or push
        speed = self.speed + push - (friction if direction > 0 else -friction)
        self.speed = 0.0 if self.speed * speed < 0 else speed
        self.place += self.speed
        self.board.count = round(self.place)


class Image(unittest.TestCase):
    def start(self, **board):
        self.board = Board(elf=ELF, **board).boot() if "flash" not in board else Board(**board).boot()
        self.link = Link(self.board)
        self.link.world = Axis(self.board)
        return self.link

    def tearDown(self):
        # An emulator is freed here, and not inside of a call of another one.
        self.board = self.link = None
        gc.collect()

    def fault(self):
        kind, content = self.link.ask(GET_FAULT)
        self.assertEqual(kind, FAULT)
        return content[1] if content[0] else None

    def run_relay(self, ticks=0):
        self.assertEqual(self.link.ask(START_RELAY, relay(*RELAY, ticks))[0], DONE)

    def advance(self, ticks):
        for _ in range(ticks):
            self.link.advance()

    def test_it_boots_to_its_ticks_with_the_bridge_off(self):
        board = Board(elf=ELF).boot()
        self.assertTrue(board.held_low())
        self.assertEqual(board.registers[CORE + 0xED08] & 0xE000_01FF, 0x2000_0000, "the vectors are in RAM")
        self.assertEqual(board.registers[WATCHDOG] >> 30 & 1, 1, "the watchdog runs")
        # Everything but the two oscillators.
        self.assertEqual(board.registers[PSM + 8], 0x01FF_FFFF & ~0b1100)
        # Both interrupts are enabled, the stop's above the tick's.
        self.assertEqual(board.registers[CORE + 0xE100], 1 << 8 | 1 << 21)
        priority = {irq: board.registers[CORE + 0xE400 + irq // 4 * 4] >> 8 * (irq % 4) & 255 for irq in (8, 21)}
        self.assertLess(priority[21], priority[8])
        fed = board.fed
        board.advance(50)
        self.assertEqual((board.fed - fed, board.reset), (50, False))
        self.assertTrue(board.held_low())

    def test_it_says_who_it_is_over_usb(self):
        link = self.start()
        self.assertEqual(link.bus.serial, "0123456789ABCDEF", "the chip's number")
        kind, info = link.ask(HELLO)
        self.assertEqual(kind, INFO)
        self.assertIn(b"\x05pico2" + varint(10_000), info)

    def test_a_relay_shakes_the_axis_and_ends_with_the_bridge_off(self):
        self.start()
        self.run_relay(ticks=2000)
        axis = self.link.world
        before = len(axis.drives)
        self.advance(500)
        self.assertIsNone(self.fault())
        # Both relays, both signs, less the dead time: (3276 ± 800) / 32767, to a PWM count.
        strongest = max(axis.drives[before:], key=abs)
        self.assertAlmostEqual(abs(strongest), sum(RELAY) / 32767, delta=1 / 3750)
        self.assertLess(min(drive for drive in axis.drives[before:] if drive), -0.07)
        self.assertGreater(max(drive for drive in axis.drives[before:] if drive), 0.07)
        self.assertEqual(self.board.registers[WATCHDOG] >> 24 & 7, 0, "a halted core is reset while driven")
        for _ in range(8):
            # The host lives.
            self.link.ask(STATUS)
            self.advance(250)
        self.assertTrue(self.board.held_low())
        self.assertEqual(self.board.registers[WATCHDOG] >> 24 & 7, 7)
        print(f"{self.board.stack_used()} bytes of stack", end=" ")
        # link.x leaves it 64 KiB at least.
        self.assertLess(self.board.stack_used(), 64 * 1024)
        self.assertIsNone(self.fault())
        self.assertTrue(any(event[0] == 2 for event in self.link.events), "the run's end is told")

    def test_a_tick_takes_less_than_half_of_its_period(self):
        """Counted in instructions, drivers included. 50 us are 7 500 clocks: two for each leave no doubt."""
        self.start()
        self.link.ask(STREAM_ON, varint(1))
        taken = self.board.count_ticks()
        self.run_relay()
        self.advance(300)
        print(f"relay tick {sum(taken[-300:]) / 300:.0f} instructions, worst {max(taken)}", end=" ")
        self.assertLess(max(taken), 3750)
        self.assertLess(self.board.count_press(), 30)

    def test_nothing_holds_the_emergency_stop_up_for_long(self):
        """The driver of USB masks interrupts: for 500 instructions at most, which is under 7 us."""
        self.start()
        longest = self.board.count_locks()
        self.link.ask(STREAM_ON, varint(1))
        self.run_relay()
        self.advance(150)
        print(f"{max(longest)} instructions", end=" ")
        self.assertTrue(50 < max(longest) < 500)

    def test_the_emergency_stop_acts_before_the_tick_and_stays(self):
        self.start()
        self.run_relay()
        self.advance(20)
        self.assertFalse(self.board.held_low())
        self.board.press()
        self.assertTrue(self.board.held_low(), "the interrupt alone")
        self.advance(1)
        self.assertTrue(self.board.held_low())
        self.assertEqual(self.fault(), EMERGENCY_STOP)
        self.assertEqual(self.link.ask(CLEAR), (ERROR, bytes([FAULT_PERSISTS])))
        self.board.pressed = False
        self.assertEqual(self.link.ask(CLEAR)[0], DONE)
        self.run_relay()
        self.advance(3)
        self.assertFalse(self.board.held_low())

    def test_a_stop_that_is_open_lets_nothing_start(self):
        self.start()
        self.board.pressed = True
        self.link.ask(START_RELAY, relay(*RELAY, 0))
        self.advance(5)
        self.assertTrue(self.board.held_low())
        self.assertEqual(self.fault(), EMERGENCY_STOP)

    def test_a_stop_that_opens_while_the_bridge_is_enabled_is_seen_at_once(self):
        """Between the look at the stop and the release of the inputs, and before its interrupt."""
        self.start()
        self.board.press_at_release = True
        self.link.bus.give(self.link.bus.bulk[0], self.link.frame(START_RELAY, relay(*RELAY, 0)))
        while not self.board.pressed:
            self.board.tick()
            self.assertTrue(self.board.held_low())
            self.board.wake()

    def test_both_channels_at_once_are_a_fault(self):
        self.start()
        self.run_relay()
        self.advance(20)
        self.board.transition_error = True
        self.advance(1)
        self.assertTrue(self.board.held_low())
        self.assertEqual(self.fault(), ENCODER_ERROR)

    def test_settings_are_kept_and_ticks_go_on_while_the_flash_is_erased(self):
        self.start()
        _, settings = self.link.ask(GET_SETTINGS)
        # Behind the brake are four numbers of 4 bytes. The brake is switched on.
        changed = settings[:-17] + b"\x01" + settings[-16:]
        self.assertNotEqual(settings, changed)
        self.assertEqual(self.link.ask(SET_SETTINGS, changed)[0], DONE)
        for _ in range(3):
            # From the second on a sector is not blank, and is erased.
            self.assertEqual(self.link.ask(SAVE)[0], DONE)
        self.assertGreater(self.board.rom.ticks_during_erase, 0)
        self.assertFalse(self.board.reset)
        self.start(flash=self.board.flash)
        self.assertEqual(self.link.ask(GET_SETTINGS), (SETTINGS, changed))
        self.assertIsNone(self.fault())

    def test_a_broken_program_is_off_at_once_and_told_after_the_reset(self):
        self.start()
        self.run_relay()
        self.advance(20)
        self.board.interrupt(HARD_FAULT)
        self.assertTrue(self.board.reset)
        self.assertTrue(self.board.low_at_reset)
        self.start(flash=self.board.flash, ram=self.board.ram())
        self.assertEqual(self.fault(), PANIC)
        self.assertEqual(self.link.ask(START_RELAY, relay(*RELAY, 0)), (ERROR, bytes([FAULTED])))

    def test_a_reset_during_a_run_is_told(self):
        self.start()
        self.run_relay()
        self.advance(20)
        self.start(flash=self.board.flash, ram=self.board.ram())
        self.assertEqual(self.fault(), RESET_WHILE_DRIVEN)

    def test_a_reboot_is_answered_before_it(self):
        self.start()
        self.assertEqual(self.link.ask(REBOOT)[0], DONE)
        self.advance(200)
        self.assertTrue(self.board.reset and self.board.low_at_reset)


if __name__ == "__main__":
    unittest.main(verbosity=2)
