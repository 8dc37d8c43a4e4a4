//! What goes wrong on a board, as its hardware shows it.

use crate::core::{HARD_FAULT, NMI};
use crate::machine::Machine;
use crate::registers::address;

/// `RCC.CR`: clock security system; the crystal.
const CSSON: u32 = 1 << 19;
const HSEON: u32 = 1 << 16;
/// `PWR.CR2`: the detector is on.
const PVDE: u32 = 1;
/// `SYSCFG.CFGR2`: lock-up and supply switch TIM1 off.
const CLL: u32 = 1;
const PVDL: u32 = 1 << 2;
/// `DBGMCU.APB1LFZR` and `APB2FZR`: the watchdog and TIM1 stand still while the core is halted.
const FREEZES_WATCHDOG: u32 = 1 << 12;
const FREEZES_TIM1: u32 = 1 << 11;

impl Machine {
    /// The emergency stop opens, or closes.
    pub fn emergency_stop(&mut self, open: bool) {
        let bus = self.bus();
        bus.step();
        bus.bridge.pin_active = open;
        bus.bridge.breaks(&mut bus.store);
    }

    fn system_break(&mut self, lasts: bool) {
        let bus = self.bus();
        bus.step();
        bus.bridge.system_active = true;
        bus.bridge.breaks(&mut bus.store);
        bus.bridge.system_active = lasts;
    }

    /// The controller's supply dips. Without the detector, nothing notices.
    pub fn supply_dips(&mut self) {
        let store = &self.bus().store;
        if store.get(address("PWR.CR2")) & PVDE != 0 && store.get(address("SYSCFG.CFGR2")) & PVDL != 0 {
            self.system_break(false);
        }
    }

    /// The core locks up. Without its break, the outputs stay as they are.
    pub fn locks_up(&mut self) {
        if self.bus().store.get(address("SYSCFG.CFGR2")) & CLL != 0 {
            self.system_break(false);
        }
    }

    /// The crystal stops, and starts again with the next reset. Without the clock security system, the core would stand still.
    ///
    /// # Panics
    /// If it is off.
    pub fn crystal_stops(&mut self) {
        let control = self.bus().store.get(address("RCC.CR"));
        assert!(control & CSSON != 0, "the clock security system is off: the core stands still");
        self.bus().store.set(address("RCC.CR"), control & !HSEON);
        self.system_break(true);
        self.bus().core.urgent = Some(NMI);
    }

    /// A broken program: a hard fault.
    pub fn hard_fault(&mut self) {
        self.bus().core.urgent = Some(HARD_FAULT);
    }

    /// A debugger halts the core for so many cycles. What it is told to stop stands still.
    pub fn halt(&mut self, cycles: u64) {
        let bus = self.bus();
        bus.step();
        bus.bridge.frozen = bus.store.get(address("DBGMCU.APB2FZR")) & FREEZES_TIM1 != 0;
        let watchdog = bus.store.get(address("DBGMCU.APB1LFZR")) & FREEZES_WATCHDOG != 0;
        bus.time += cycles;
        bus.step();
        if watchdog {
            bus.watchdog.resume(cycles);
        }
        if bus.bridge.frozen {
            bus.bridge.frozen = false;
            bus.bridge.resume(cycles);
        }
    }

    /// The ticks' timer stands still.
    pub fn ticks_stop(&mut self) {
        self.bus().timers.stuck = true;
    }
}
