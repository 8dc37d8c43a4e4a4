//! The image on the emulated board: exceptions, resets, the passing of time.

mod exceptions;

use std::collections::BTreeSet;
use std::path::Path;

use breakaway::device::virtual_board::{Machine as Axis, SimulatedMachine};
use object::{Object as _, ObjectSegment as _, ObjectSymbol as _};

use crate::bus::{Broken, Bus};
use crate::flash::{Cells, Flash, PAGES};
use crate::rcc::{PIN_RESET, POWER_RESET, SOFTWARE_RESET, WATCHDOG_RESET};
use crate::timers::Timers;
use crate::unicorn::{Access, NoUnicorn, Processor, Register, Stopped};
use exceptions::THUMB;

/// Unicorn's number of a branch to an `EXC_RETURN`.
const RETURNS: u32 = 8;
/// `WFI`.
const WAIT: [u8; 2] = [0x30, 0xbf];

/// A rule that the image has broken, with the place.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{register}: {rule}; at {pc:#010x} in {function}", register = broken.register, rule = broken.rule)]
pub struct Violation {
    /// The register and the rule.
    pub broken: Broken,
    /// Address of the instruction.
    pub pc: u32,
    /// Function that it is in, or the last one before.
    pub function: String,
}

/// What one tick took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TickCost {
    /// Instructions, from the exception's entry to its end.
    pub instructions: u64,
    /// Those of them in flash.
    pub from_flash: u64,
    /// Cycles, an estimate from above (`cost.rs`).
    pub cycles: u64,
    /// When it began, cycles.
    pub began: u64,
}

/// The emulated board.
pub struct Machine {
    processor: Processor<Bus>,
    image: Vec<u8>,
    /// Exceptions under way, the innermost last.
    active: Vec<u32>,
    symbols: Vec<(u32, String)>,
    /// What each tick took, since it was last emptied.
    pub ticks: Vec<TickCost>,
    began: TickCost,
    /// The next tick comes by so many cycles too late.
    pub late: u64,
    /// Resets since power-on.
    pub resets: u32,
}

impl Machine {
    /// Power-on, with an image, an axis and what is in the flash's settings pages.
    ///
    /// # Errors
    /// [`NoUnicorn`].
    ///
    /// # Panics
    /// If the image is no ELF file for this board.
    pub fn power_on(image: &Path, axis: &Axis, cells: Cells) -> Result<Self, NoUnicorn> {
        let file = std::fs::read(image).unwrap_or_else(|error| panic!("{}: {error}", image.display()));
        let elf = object::File::parse(&*file).unwrap_or_else(|error| panic!("{}: {error}", image.display()));
        let processor = Processor::new(Bus::new(SimulatedMachine::new(axis), Flash::new(cells)))?;
        processor.map(0x0800_0000, PAGES.start - 0x0800_0000, Access::Code);
        processor.map_device::<0x0807_f000>(0x1000);
        processor.map(0x1000_0000, 0x8000, Access::All);
        processor.map(0x2000_0000, 0x1_8000, Access::Data);
        processor.map_device::<0x4000_0000>(0x3_0000);
        processor.map_device::<0x4800_0000>(0x2000);
        processor.map_device::<0x5000_0000>(0x2000);
        processor.map_device::<0xe000_e000>(0x1000);
        processor.map_device::<0xe004_2000>(0x1000);
        let mut flash = Vec::new();
        // Where a loader puts it: the physical addresses.
        for segment in elf.segments() {
            let data = segment.data().unwrap_or_default();
            if data.is_empty() {
                continue;
            }
            let at = physical(&elf, segment.address()).unwrap_or_else(|| segment.address()) as usize - 0x0800_0000;
            flash.resize(flash.len().max(at + data.len()), 0xff);
            flash[at..at + data.len()].copy_from_slice(data);
        }
        let symbols = elf.symbols().filter(|symbol| symbol.kind() == object::SymbolKind::Text);
        let symbols = symbols.filter_map(|symbol| Some((symbol.address() as u32 & !1, symbol.name().ok()?.to_owned())));
        let mut symbols: Vec<(u32, String)> = symbols.collect();
        symbols.sort();
        let mut machine = Self {
            processor,
            image: flash,
            active: Vec::new(),
            symbols,
            ticks: Vec::new(),
            began: TickCost::default(),
            late: 0,
            resets: 0,
        };
        machine.processor.cpu.write(0x0800_0000, &machine.image);
        // RAM holds anything after power-on.
        let mut state = 0x1234_5678_u32;
        let noise: Vec<u8> = (0..0x1_8000)
            .map(|_| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (state >> 24) as u8
            })
            .collect();
        machine.processor.cpu.write(0x2000_0000, &noise);
        machine.start(POWER_RESET | PIN_RESET);
        Ok(machine)
    }

    /// What is around the core.
    pub fn bus(&mut self) -> &mut Bus {
        self.processor.around()
    }

    /// Constants in flash cost their wait states from now on. Slow.
    pub fn count_constants(&self) {
        self.processor.watch_constants(0x0800_0000, PAGES.start - 1);
    }

    /// The core starts from its vectors.
    fn start(&mut self, flags: u32) {
        self.active.clear();
        self.bus().in_exception = false;
        self.bus().reset(flags);
        let cpu = self.processor.cpu;
        for register in 0..=12 {
            cpu.set(Register::R0, register, 0xdead_0000 | register as u32);
        }
        cpu.set(Register::Xpsr, 0, THUMB);
        cpu.set(Register::PriMask, 0, 0);
        cpu.set(Register::Lr, 0, u32::MAX);
        cpu.set(Register::Sp, 0, cpu.word(0x0800_0000).unwrap_or(0));
        cpu.set(Register::Pc, 0, cpu.word(0x0800_0004).unwrap_or(0));
    }

    /// The reset pin.
    pub fn reset(&mut self) {
        self.resets += 1;
        self.start(PIN_RESET);
    }

    /// A write as if the program made it here.
    ///
    /// # Errors
    /// The rule that it breaks.
    pub fn poke(&mut self, address: u32, bytes: u32, value: u32) -> Result<(), Broken> {
        let cpu = self.processor.cpu;
        self.bus().save(cpu, address, bytes, value)?;
        self.bus().broken.take().map_or(Ok(()), Err)
    }

    /// Changes memory, as a stray pointer would.
    pub fn write_memory(&mut self, address: u32, bytes: &[u8]) {
        self.processor.cpu.write(address, bytes);
    }

    /// A read as if the program made it here.
    ///
    /// # Errors
    /// The rule that it breaks.
    pub fn peek(&mut self, address: u32, bytes: u32) -> Result<u32, Broken> {
        let cpu = self.processor.cpu;
        self.bus().load(cpu, address, bytes)
    }

    /// Runs until this time, cycles since power-on.
    ///
    /// # Errors
    /// The rule that the image has broken.
    pub fn run_until(&mut self, end: u64) -> Result<(), Violation> {
        while self.bus().time < end {
            self.advance(end)?;
        }
        Ok(())
    }

    fn advance(&mut self, end: u64) -> Result<(), Violation> {
        let cpu = self.processor.cpu;
        let bus = self.processor.around();
        let now = bus.time;
        bus.timers.overflow(now, &mut bus.store);
        bus.step();
        bus.pass(cpu);
        if std::mem::take(&mut bus.core.reset) {
            self.resets += 1;
            self.start(SOFTWARE_RESET);
            return Ok(());
        }
        let bites = bus.watchdog.bites_at(&bus.store);
        if bites.is_some_and(|at| at <= now) {
            self.resets += 1;
            self.start(WATCHDOG_RESET | PIN_RESET);
            return Ok(());
        }
        self.rules()?;
        self.take_exception();
        let bus = self.processor.around();
        let tick = bus.timers.tick_at.unwrap_or(u64::MAX);
        bus.next = end.min(tick).min(bites.unwrap_or(u64::MAX));
        bus.stopped = false;
        let pc = cpu.get(Register::Pc, 0);
        match self.processor.run(pc) {
            Stopped::Exception(RETURNS) => {
                self.rules()?;
                self.leave();
            }
            Stopped::Fine if self.bus().stopped || self.bus().broken.is_some() => {}
            Stopped::Fine => self.wait(end)?,
            Stopped::Exception(number) => self.broken("the core", &format!("exception {number} of the processor")),
            Stopped::Error(code) => {
                self.broken("the core", &format!("Unicorn's error {code}: no such memory, or instruction"));
            }
        }
        self.rules()
    }

    /// `WFI`: nothing happens until the next event.
    fn wait(&mut self, end: u64) -> Result<(), Violation> {
        let pc = self.processor.cpu.get(Register::Pc, 0);
        let mut code = [0; 2];
        self.processor.cpu.read(pc.wrapping_sub(2), &mut code);
        if code != WAIT {
            self.broken("the core", "it has stopped for no reason");
            return self.rules();
        }
        let bus = self.bus();
        let events = [bus.timers.tick_at, bus.watchdog.bites_at(&bus.store), Some(end)];
        let next = events.into_iter().flatten().min().unwrap_or(end);
        if bus.core.urgent.is_none() && !Timers::asks(&bus.store) {
            bus.time = bus.time.max(next);
        }
        Ok(())
    }

    fn broken(&mut self, what: &str, rule: &str) {
        let broken = Broken { register: what.to_owned(), rule: rule.to_owned() };
        self.bus().broken.get_or_insert(broken);
    }

    fn rules(&mut self) -> Result<(), Violation> {
        let Some(broken) = self.bus().broken.clone() else { return Ok(()) };
        let (pc, function) = self.place();
        Err(Violation { broken, pc, function })
    }

    /// Where the program is: the address, and the function that is there.
    pub fn place(&self) -> (u32, String) {
        let pc = self.processor.cpu.get(Register::Pc, 0);
        (pc, self.function(pc))
    }

    fn function(&self, address: u32) -> String {
        let before = self.symbols.partition_point(|(start, _)| *start <= address);
        before.checked_sub(1).map_or("?", |i| self.symbols[i].1.as_str()).to_owned()
    }

    /// Functions in flash that exceptions have executed, sorted.
    pub fn slow_functions(&mut self) -> BTreeSet<String> {
        let places = self.bus().slow_code.clone();
        places.into_iter().map(|address| self.function(address)).collect()
    }
}

/// Where the loader puts the segment at a virtual address.
fn physical(elf: &object::File<'_>, address: u64) -> Option<u64> {
    let object::File::Elf32(elf) = elf else { return None };
    let endian = elf.endian();
    elf.elf_program_headers().iter().find_map(|header| {
        let load = header.p_type.get(endian) == object::elf::PT_LOAD && header.p_filesz.get(endian) > 0;
        (load && u64::from(header.p_vaddr.get(endian)) == address).then(|| u64::from(header.p_paddr.get(endian)))
    })
}
