//! The registers that there are: addresses, names, bits, and the clock that each needs. From the manufacturer's tables, as the
//! crate `stm32-metapac` carries them, with what they lack.

use std::collections::HashMap;
use std::sync::OnceLock;

use stm32_metapac::metadata::ir::{Array, BitOffset, Block, BlockItemInner, FieldSet, IR};
use stm32_metapac::metadata::{METADATA, Peripheral, ir};

/// A register.
#[derive(Clone, Debug)]
pub struct Register {
    /// `TIM1.BDTR`, `DMA1.CH[0].CR`.
    pub name: String,
    /// Bits that are implemented.
    pub bits: u32,
    /// Its width, bits.
    pub width: u32,
    /// Whether it may be read.
    pub readable: bool,
    /// Whether it may be written.
    pub writable: bool,
    /// Address and bit of the clock that it needs.
    pub clock: Option<(u32, u32)>,
}

/// Where the tables differ from RM0440.
const CORRECTED: [(&str, u32); 2] = [
    // R1MODE is bit 8 (RM0440, PWR_CR5); the tables have it at 0, where nothing is.
    ("PWR.CR5", 0x0000_0100),
    // The divider has 20 bits (RM0440, LPUART_BRR).
    ("LPUART1.BRR", 0x000f_ffff),
];
/// Registers of the core that the image may use, with the bits that it may write (PM0214).
const CORE: [(u32, &str, u32); 10] = [
    (0xe000_e100, "NVIC.ISER0", u32::MAX),
    (0xe000_e104, "NVIC.ISER1", u32::MAX),
    (0xe000_e108, "NVIC.ISER2", u32::MAX),
    (0xe000_e10c, "NVIC.ISER3", 0x3f),
    (0xe000_ed04, "SCB.ICSR", 0x9e00_0000),
    (0xe000_ed08, "SCB.VTOR", 0xffff_ff80),
    (0xe000_ed0c, "SCB.AIRCR", 0xffff_0707),
    (0xe000_ed10, "SCB.SCR", 0x16),
    (0xe000_ed88, "SCB.CPACR", 0x00f0_0000),
    (0xe000_edfc, "DCB.DEMCR", 0x010f_07f1),
];
/// Priorities of interrupts, four bits of a byte each.
const PRIORITIES: std::ops::Range<u32> = 0xe000_e400..0xe000_e468;

/// All of them, by address.
pub fn registers() -> &'static HashMap<u32, Register> {
    static TABLE: OnceLock<HashMap<u32, Register>> = OnceLock::new();
    TABLE.get_or_init(|| {
        let mut table = HashMap::new();
        for peripheral in METADATA.peripherals {
            let Some(registers) = &peripheral.registers else { continue };
            let walk = Walk { ir: registers.ir, clock: clock(peripheral) };
            walk.block(registers.block, peripheral.address as u32, peripheral.name, &mut table);
        }
        for (address, name, bits) in CORE {
            table.insert(address, core(name.to_owned(), bits, 32));
        }
        for address in PRIORITIES {
            table.insert(address, core(format!("NVIC.IPR[{}]", address - PRIORITIES.start), 0xf0, 8));
        }
        for register in table.values_mut() {
            if let Some((_, bits)) = CORRECTED.iter().find(|(name, _)| *name == register.name) {
                register.bits = *bits;
            }
        }
        table
    })
}

fn core(name: String, bits: u32, width: u32) -> Register {
    Register { name, bits, width, readable: true, writable: true, clock: None }
}

/// The address of a register.
///
/// # Panics
/// If there is none of that name: a mistake in the test.
pub fn address(name: &str) -> u32 {
    static NAMES: OnceLock<HashMap<&'static str, u32>> = OnceLock::new();
    let names = NAMES
        .get_or_init(|| registers().iter().map(|(address, register)| (register.name.as_str(), *address)).collect());
    *names.get(name).unwrap_or_else(|| panic!("no register {name}"))
}

/// Where the clock of a peripheral is switched on: register's address and bit.
fn clock(peripheral: &Peripheral) -> Option<(u32, u32)> {
    let enable = peripheral.rcc.as_ref()?.enable.as_ref()?;
    let rcc = METADATA.peripherals.iter().find(|other| other.name == "RCC")?;
    let ir = rcc.registers.as_ref()?.ir;
    let block = ir.blocks.iter().find(|block| same(block.name, "rcc"))?;
    let item = block.items.iter().find(|item| same(item.name, enable.register))?;
    let BlockItemInner::Register(register) = &item.inner else { return None };
    let fields = fieldset(ir, register.fieldset?)?;
    let field = fields.fields.iter().find(|field| same(field.name, enable.field))?;
    let BitOffset::Regular(offset) = &field.bit_offset else { return None };
    Some((rcc.address as u32 + item.byte_offset, offset.offset))
}

/// The tables write one name in several ways: `TIM_ADV`, `TimAdv`.
fn same(one: &str, other: &str) -> bool {
    let plain = |name: &str| name.chars().filter(|c| *c != '_').map(|c| c.to_ascii_lowercase()).collect::<String>();
    plain(one) == plain(other)
}

fn fieldset(ir: &'static IR, name: &str) -> Option<&'static FieldSet> {
    ir.fieldsets.iter().find(|set| same(set.name, name))
}

struct Walk {
    ir: &'static IR,
    clock: Option<(u32, u32)>,
}

impl Walk {
    fn block(&self, name: &str, base: u32, prefix: &str, table: &mut HashMap<u32, Register>) {
        let Some(block) = self.ir.blocks.iter().find(|block| same(block.name, name)) else { return };
        if let Some(parent) = block.extends {
            self.block(parent, base, prefix, table);
        }
        self.items(block, base, prefix, table);
    }

    fn items(&self, block: &'static Block, base: u32, prefix: &str, table: &mut HashMap<u32, Register>) {
        for item in block.items {
            let places: Vec<(u32, String)> = match &item.array {
                None => vec![(0, String::new())],
                Some(array) => offsets(array).into_iter().enumerate().map(|(i, at)| (at, format!("[{i}]"))).collect(),
            };
            for (offset, index) in places {
                let address = base + item.byte_offset + offset;
                let name = format!("{prefix}.{}{index}", item.name.to_uppercase());
                match &item.inner {
                    BlockItemInner::Block(inner) => self.block(inner.block, address, &name, table),
                    BlockItemInner::Register(register) => self.register(register, address, name, table),
                }
            }
        }
    }

    fn register(&self, register: &ir::Register, address: u32, name: String, table: &mut HashMap<u32, Register>) {
        let all = if register.bit_size >= 32 { u32::MAX } else { (1 << register.bit_size) - 1 };
        let bits = register.fieldset.map_or(all, |fields| self.bits(fields));
        // One address may have several forms (capture or compare).
        let entry = table.entry(address).or_insert_with(|| Register {
            name: name.clone(),
            bits: 0,
            width: register.bit_size,
            readable: false,
            writable: false,
            clock: self.clock,
        });
        entry.bits |= bits;
        entry.width = entry.width.max(register.bit_size);
        entry.readable |= !matches!(register.access, ir::Access::Write);
        entry.writable |= !matches!(register.access, ir::Access::Read);
        if entry.name.len() > name.len() {
            entry.name = name;
        }
    }

    fn bits(&self, name: &str) -> u32 {
        let Some(set) = fieldset(self.ir, name) else { return 0 };
        let own = set.fields.iter().flat_map(|field| {
            let shifts = field.array.as_ref().map_or_else(|| vec![0], offsets);
            let size = field.bit_size;
            shifts.into_iter().map(move |shift| match &field.bit_offset {
                BitOffset::Regular(at) => ones(at.offset + shift, size),
                BitOffset::Cursed(at) => at
                    .ranges
                    .iter()
                    .map(|bits| ones(bits.start() + shift, bits.end() - bits.start() + 1))
                    .fold(0, |a, b| a | b),
            })
        });
        own.fold(set.extends.map_or(0, |parent| self.bits(parent)), |all, bits| all | bits)
    }
}

fn ones(at: u32, size: u32) -> u32 {
    (((1_u64 << size) - 1) << at) as u32
}

fn offsets(array: &Array) -> Vec<u32> {
    match array {
        Array::Regular(array) => (0..array.len).map(|i| i * array.stride).collect(),
        Array::Cursed(array) => array.offsets.to_vec(),
    }
}
