//! Entering and leaving exceptions (PM0214, exception entry and return), which Unicorn leaves to others.

use super::{Machine, TickCost};
use crate::core::{Core, TICK};
use crate::cost::EXCEPTION;
use crate::timers::Timers;
use crate::unicorn::Register;

/// `EXC_RETURN`: main stack, with the floating-point unit's registers; to a handler, or to the thread.
const TO_HANDLER: u32 = 0xffff_ffe1;
const TO_THREAD: u32 = 0xffff_ffe9;
pub(super) const THUMB: u32 = 1 << 24;
/// The stacked status says by it that the stack was moved to a multiple of 8.
const MOVED: u32 = 1 << 9;
/// Words of a frame: eight, 16 of the floating-point unit, its status, and one that is reserved.
const FRAME: u32 = 26;
/// Halves of [`EXCEPTION`].
const ENTRY: u64 = EXCEPTION as u64 - 12;
const EXIT: u64 = 12;

impl Machine {
    /// Enters what is pending, if it may.
    pub(super) fn take_exception(&mut self) {
        let cpu = self.processor.cpu;
        let bus = self.processor.around();
        if let Some(urgent) = bus.core.urgent.take() {
            return self.enter(urgent);
        }
        let asked = Timers::asks(&bus.store) && Core::tick_enabled(&bus.store);
        if asked && self.active.is_empty() && cpu.get(Register::PriMask, 0) & 1 == 0 {
            let bus = self.processor.around();
            bus.time += std::mem::take(&mut self.late);
            self.began = TickCost {
                instructions: bus.instructions,
                from_flash: bus.from_flash,
                cycles: bus.time,
                began: bus.time,
            };
            self.enter(TICK);
        }
    }

    fn enter(&mut self, number: u32) {
        let cpu = self.processor.cpu;
        let (sp, xpsr) = (cpu.get(Register::Sp, 0), cpu.get(Register::Xpsr, 0));
        let moved = if sp & 4 == 0 { 0 } else { MOVED };
        let frame = (sp & !7) - 4 * FRAME;
        let mut words: Vec<u32> = (0..4).map(|i| cpu.get(Register::R0, i)).collect();
        words.extend([cpu.get(Register::R12, 0), cpu.get(Register::Lr, 0), cpu.get(Register::Pc, 0), xpsr | moved]);
        words.extend((0..16).map(|i| cpu.get(Register::S0, i)));
        words.extend([cpu.get(Register::Fpscr, 0), 0]);
        let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        if !cpu.write(frame, &bytes) {
            self.broken("SP", &format!("{frame:#010x} is no stack"));
        }
        let vectors = Core::vectors(&self.bus().store);
        cpu.set(Register::Lr, 0, if self.active.is_empty() { TO_THREAD } else { TO_HANDLER });
        cpu.set(Register::Xpsr, 0, THUMB | number);
        cpu.set(Register::Sp, 0, frame);
        cpu.set(Register::Pc, 0, cpu.word(vectors + 4 * number).unwrap_or(0) & !1);
        self.active.push(number);
        self.bus().in_exception = true;
        self.bus().time += ENTRY;
    }

    pub(super) fn leave(&mut self) {
        let cpu = self.processor.cpu;
        let frame = cpu.get(Register::Sp, 0);
        let words: Vec<u32> = (0..FRAME).map(|i| cpu.word(frame + 4 * i).unwrap_or(0)).collect();
        for (i, word) in words[..4].iter().enumerate() {
            cpu.set(Register::R0, i, *word);
        }
        for (i, word) in words[8..24].iter().enumerate() {
            cpu.set(Register::S0, i, *word);
        }
        cpu.set(Register::Fpscr, 0, words[24]);
        cpu.set(Register::R12, 0, words[4]);
        cpu.set(Register::Lr, 0, words[5]);
        cpu.set(Register::Xpsr, 0, words[7] & !MOVED | THUMB);
        cpu.set(Register::Sp, 0, frame + 4 * FRAME + if words[7] & MOVED == 0 { 0 } else { 4 });
        cpu.set(Register::Pc, 0, words[6]);
        let ended = self.active.pop();
        let bus = self.processor.around();
        bus.time += EXIT;
        bus.in_exception = !self.active.is_empty();
        if ended == Some(TICK) {
            let began = self.began;
            let bus = self.bus();
            let cost = TickCost {
                instructions: bus.instructions - began.instructions,
                from_flash: bus.from_flash - began.from_flash,
                cycles: bus.time - began.cycles,
                began: began.began,
            };
            self.ticks.push(cost);
        }
    }
}
