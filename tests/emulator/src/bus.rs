//! What the core reads and writes: each access is checked against the register's own rules, then given to its model.

mod rules;

use std::collections::BTreeSet;

use breakaway::device::virtual_board::SimulatedMachine;
use breakaway_core::link::FULL_SCALE_CODE;

use crate::analog::{ADC1, Analog, COMPARATORS, DAC1, DAC3};
use crate::bridge::{Bridge, TIM1};
use crate::core::{Core, NMI};
use crate::cost::{BRIDGE_WAIT, Cost, FLASH_WAIT, cost};
use crate::flash::{FLASH, Flash, PAGES};
use crate::gpio;
use crate::link::Link;
use crate::rcc::{self, RCC};
use crate::store::Store;
use crate::timers::{TIM2, TIM5, TIM6, Timers};
use crate::unicorn::{Around, Cpu};
use crate::watchdog::{IWDG, Watchdog};
use crate::winding::Winding;
pub use rules::Broken;

/// Core clocks per second, once it runs from the PLL.
pub const CORE_HZ: u64 = 170_000_000;
/// Cycles between two steps of the plant: half a period of the PWM.
pub const STEP_CYCLES: u64 = 4250;
const CODE: u32 = 0x0800_0000;
const CCM: u32 = 0x1000_0000;
const CODE_BYTES: u32 = 256 * 1024;
const CCM_BYTES: u32 = 32 * 1024;
/// Half words of code: where a block may start.
const HALVES: u32 = CODE_BYTES / 2 + CCM_BYTES / 2;

/// Everything around the core.
#[derive(Debug)]
pub struct Bus {
    /// Cycles since power-on.
    pub time: u64,
    /// When the core is to be stopped, cycles.
    pub next: u64,
    /// Whether it was.
    pub stopped: bool,
    /// Instructions since power-on.
    pub instructions: u64,
    /// Instructions of the present exception that were fetched from flash.
    pub from_flash: u64,
    /// An exception is under way.
    pub in_exception: bool,
    /// Where exceptions have executed code in flash.
    pub slow_code: BTreeSet<u32>,
    /// What the registers hold.
    pub store: Store,
    /// The flash's settings pages.
    pub flash: Flash,
    /// TIM1.
    pub bridge: Bridge,
    /// TIM2, TIM5, TIM6.
    pub timers: Timers,
    /// LPUART1 with its DMA.
    pub link: Link,
    /// IWDG.
    pub watchdog: Watchdog,
    /// NVIC and SCB.
    pub core: Core,
    /// The axis.
    pub plant: SimulatedMachine,
    /// The motor's winding with a shunt amplifier; `None`: the drive acts on the axis at once, and nothing measures.
    pub winding: Option<Winding>,
    /// ADC, DACs, comparators.
    pub analog: Analog,
    /// When the bridge last drove it, cycles.
    pub driven_at: u64,
    /// Drive of the last step, drive codes.
    pub drive_code: i16,
    /// The next accesses to TIM2 find a transition error.
    pub transition_error: bool,
    /// The first rule that was broken.
    pub broken: Option<Broken>,
    stepped_at: u64,
    /// Position at the last step.
    position: f64,
    /// What follows the last block where its branch is not taken, and the cycles less that it then takes.
    falls_to: (u32, u32),
    costs: Vec<Cost>,
}

impl Bus {
    /// After power-on.
    pub fn new(plant: SimulatedMachine, flash: Flash) -> Self {
        Self {
            time: 0,
            next: 0,
            stopped: false,
            instructions: 0,
            from_flash: 0,
            in_exception: false,
            slow_code: BTreeSet::new(),
            store: Store::new(),
            flash,
            bridge: Bridge::default(),
            timers: Timers::default(),
            link: Link::default(),
            watchdog: Watchdog::default(),
            core: Core::default(),
            plant,
            winding: None,
            analog: Analog::default(),
            driven_at: 0,
            drive_code: 0,
            transition_error: false,
            broken: None,
            stepped_at: 0,
            position: 0.0,
            falls_to: (0, 0),
            costs: vec![Cost::default(); HALVES as usize],
        }
    }

    /// A system reset, for the reasons of `flags` (`RCC.CSR`). The plant goes on.
    pub fn reset(&mut self, flags: u32) {
        let csr = rcc::RCC + 0x94;
        let causes = self.store.get(csr) | flags;
        self.store.reset();
        self.store.set(csr, causes);
        self.flash.reset();
        self.link.reset();
        let pin_active = self.bridge.pin_active;
        self.bridge = Bridge::default();
        self.bridge.pin_active = pin_active;
        self.analog.reset();
        (self.timers, self.watchdog, self.core) = Default::default();
    }

    /// Moves the plant on to now.
    pub fn step(&mut self) {
        while self.stepped_at + STEP_CYCLES <= self.time {
            self.stepped_at += STEP_CYCLES;
            let enabled = gpio::high(gpio::ENABLE, &self.store);
            let drive = if enabled { self.bridge.drive(&self.store) } else { 0.0 };
            self.drive_code = (drive * f64::from(FULL_SCALE_CODE)).round() as i16;
            if self.drive_code != 0 {
                self.driven_at = self.stepped_at;
            }
            let code = self.wind(enabled);
            self.plant.advance(code.unwrap_or(self.drive_code));
            if self.bridge.ends(&self.store).is_some_and(|end| end <= self.stepped_at) {
                let lowest = !self.bridge.rising;
                let next = self.bridge.next(&self.store);
                self.check("TIM1", next);
                if lowest && self.bridge.triggers(&self.store) && Analog::triggered(&self.store) {
                    let current = self.winding.map(|winding| winding.current);
                    let converted = self.analog.convert(current, &mut self.store);
                    self.check("ADC1", converted);
                }
            }
        }
    }

    /// The winding in this step. What then drives the axis is R·i, as a drive code of twice the supply: a reversal makes up
    /// to twice the current of the supply.
    fn wind(&mut self, enabled: bool) -> Option<i16> {
        let mut winding = self.winding?;
        let position = self.plant.position();
        let seconds = STEP_CYCLES as f64 / CORE_HZ as f64;
        let speed = (position - self.position) / seconds;
        self.position = position;
        let mut driven = 0.0;
        let pieces = if self.bridge.on(&self.store) { self.bridge.pieces(&self.store) } else { vec![] };
        let pieces = if pieces.is_empty() { vec![(0.0, STEP_CYCLES as u32)] } else { pieces };
        for (share, clocks) in pieces {
            let volts = (enabled && self.bridge.on(&self.store)).then_some(share * winding.supply);
            let part = f64::from(clocks) / CORE_HZ as f64;
            driven += winding.advance(volts, speed, part) * part / seconds;
            self.bridge.comparators = self.analog.comparators(Some(winding.current), &self.store);
            self.bridge.breaks(&mut self.store);
        }
        self.winding = Some(winding);
        let code = driven * winding.resistance / (2.0 * winding.supply) * f64::from(FULL_SCALE_CODE);
        Some(code.round() as i16)
    }

    fn check(&mut self, register: &str, result: Result<(), String>) {
        if let (Err(rule), None) = (result, &self.broken) {
            self.broken = Some(Broken { register: register.to_owned(), rule });
        }
    }

    /// Bytes of the link that have had their time.
    pub fn pass(&mut self, cpu: Cpu) {
        let passed = self.link.pass(cpu, self.time, &mut self.store);
        self.check("DMA1", passed);
    }

    pub(crate) fn load(&mut self, cpu: Cpu, address: u32, bytes: u32) -> Result<u32, Broken> {
        self.time += u64::from(BRIDGE_WAIT);
        if PAGES.contains(&address) {
            let fetched = self.flash.fetch(address, bytes, self.time, &mut self.store);
            let (value, wrong) = fetched.map_err(|rule| Broken { register: format!("{address:#010x}"), rule })?;
            if wrong {
                self.core.urgent = Some(NMI);
                self.next = 0;
            }
            return Ok(value);
        }
        self.allowed(address, bytes, None)?;
        let (base, offset) = (address & !0x3ff, address & 0x3ff);
        Ok(match base {
            RCC => rcc::read(offset, &self.store),
            FLASH => self.flash.read(offset, self.time, &self.store),
            TIM2 | TIM5 | TIM6 => {
                self.step();
                if self.transition_error && address == TIM2 + 0x10 {
                    return Ok(self.store.get(address) | crate::timers::TRANSITION_ERROR);
                }
                let plant = &mut self.plant;
                self.timers.read(base, offset, self.time, || plant.count(), &self.store)
            }
            0x4000_8000 | 0x4002_0000 => {
                self.pass(cpu);
                self.link.read(address, &self.store)
            }
            0x4800_0000..=0x4800_1fff => gpio::read(address, &self.store),
            ADC1 => {
                self.step();
                self.analog.read(offset, self.time, &self.store)
            }
            _ => self.store.get(address),
        })
    }

    pub(crate) fn save(&mut self, cpu: Cpu, address: u32, bytes: u32, value: u32) -> Result<(), Broken> {
        self.time += u64::from(BRIDGE_WAIT);
        if PAGES.contains(&address) {
            let programmed = self.flash.program(address, bytes, value, self.time, &self.store);
            return programmed.map_err(|rule| Broken { register: format!("{address:#010x}"), rule });
        }
        let register = self.allowed(address, bytes, Some(value))?;
        let (base, offset, now) = (address & !0x3ff, address & 0x3ff, self.time);
        let store = &mut self.store;
        let written = match base {
            RCC => rcc::write(offset, value, store),
            FLASH => self.flash.write(offset, value, now, store),
            TIM1 => {
                self.step();
                let running = self.bridge.ends(&self.store).is_some();
                let written = self.bridge.write(offset, value, now, &mut self.store);
                if !running && self.bridge.ends(&self.store).is_some() {
                    self.stepped_at = now;
                }
                written
            }
            TIM2 | TIM5 | TIM6 => self.timers.write(base, offset, value, now, store),
            0x4000_8000 | 0x4002_0000 | 0x4002_0800 => {
                self.pass(cpu);
                self.link.write(cpu, address, value, now, &mut self.store)
            }
            ADC1 => {
                self.step();
                self.analog.write(offset, value, now, &mut self.store)
            }
            DAC1 | DAC3 => Analog::write_dac(base, offset, value, store),
            _ if COMPARATORS.contains(&address) => Analog::write_comparator(address, value, store),
            IWDG => self.watchdog.write(offset, value, now, store),
            0x4800_0000..=0x4800_1fff => gpio::write(address, value, self.bridge.on(store), store),
            0xe000_e000.. => self.core.write(address, value, store),
            _ => {
                store.set(address, value);
                Ok(())
            }
        };
        // What comes next may have changed: an interrupt is asked for or let through, or a reset.
        if base >= 0xe000_e000 || base == TIM6 && offset != 0x10 {
            self.next = 0;
        }
        written.map_err(|rule| Broken { register: register.name.clone(), rule })
    }
}

impl Around for Bus {
    fn block(&mut self, cpu: Cpu, address: u32, bytes: u32) -> bool {
        if self.time >= self.next {
            self.stopped = true;
            return true;
        }
        let in_flash = (CODE..CODE + CODE_BYTES).contains(&address);
        let slot = if in_flash { address - CODE } else { address - CCM + CODE_BYTES } / 2;
        let Some(known) = self.costs.get_mut(slot as usize) else {
            self.check("PC", Err(format!("{address:#010x} is no place for code")));
            return true;
        };
        if known.bytes != bytes {
            let mut code = vec![0; bytes as usize];
            cpu.read(address, &mut code);
            *known = cost(address, &code, in_flash);
        }
        if address == self.falls_to.0 {
            self.time -= u64::from(self.falls_to.1);
        }
        self.falls_to = (address + bytes, known.not_taken);
        self.time += u64::from(known.cycles);
        self.instructions += u64::from(known.instructions);
        if in_flash {
            self.from_flash += u64::from(known.instructions);
            if self.in_exception {
                self.slow_code.insert(address);
            }
        }
        false
    }

    fn read(&mut self, cpu: Cpu, address: u32, bytes: u32) -> Option<u32> {
        match self.load(cpu, address, bytes) {
            Ok(value) => Some(value),
            Err(broken) => {
                self.broken.get_or_insert(broken);
                None
            }
        }
    }

    fn write(&mut self, cpu: Cpu, address: u32, bytes: u32, value: u32) -> bool {
        if let Err(broken) = self.save(cpu, address, bytes, value) {
            self.broken.get_or_insert(broken);
        }
        self.broken.is_none()
    }

    fn constant(&mut self) {
        self.time += u64::from(FLASH_WAIT);
    }
}
