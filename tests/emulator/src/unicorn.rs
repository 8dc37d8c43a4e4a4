//! Unicorn's library, loaded when a test runs: a processor without anything around it. `cargo xtask test` fetches it.

mod library;

use std::ffi::{c_int, c_void};

use library::{Functions, functions};
pub use library::{NoUnicorn, available, in_images};

type Engine = *mut c_void;
type Code = c_int;

const ARCH_ARM: c_int = 1;
/// Thumb, M profile.
const MODE: c_int = 16 | 32;
/// `uc_ctl_set_cpu_model(UC_CPU_ARM_CORTEX_M4)`: number 7 of the controls, one argument, written.
const SET_MODEL: c_int = 7 | 1 << 26 | 1 << 30;
const CORTEX_M4: c_int = 9;
const HOOK_INTERRUPT: c_int = 1;
const HOOK_BLOCK: c_int = 1 << 3;
const HOOK_READ: c_int = 1 << 10;

/// Numbers of the registers (unicorn/arm.h).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Register {
    /// Status of the floating-point unit.
    Fpscr = 6,
    /// State of an if-then block.
    ItState = 9,
    /// Link register.
    Lr = 10,
    /// Program counter.
    Pc = 11,
    /// Stack pointer.
    Sp = 12,
    /// First of the general registers.
    R0 = 66,
    /// The last that is stacked.
    R12 = 78,
    /// First of the registers of the floating-point unit.
    S0 = 79,
    /// Number of the active exception.
    Ipsr = 114,
    /// Program status.
    Xpsr = 120,
    /// Whether interrupts are masked.
    PriMask = 123,
}

/// What may be done with the memory of a range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Access {
    /// Read and execute.
    Code = 1 | 4,
    /// Read and write.
    Data = 1 | 2,
    /// Everything.
    All = 7,
}

/// What the processor asks of what is around it.
pub trait Around {
    /// A block of instructions is about to be executed; whether to stop before it.
    fn block(&mut self, cpu: Cpu, address: u32, bytes: u32) -> bool;
    /// A read of a peripheral. `None` stops at this instruction.
    fn read(&mut self, cpu: Cpu, address: u32, bytes: u32) -> Option<u32>;
    /// A write to a peripheral; whether it goes on.
    fn write(&mut self, cpu: Cpu, address: u32, bytes: u32, value: u32) -> bool;
    /// Constants are read from flash.
    fn constant(&mut self);
}

/// Why the processor has stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stopped {
    /// As it was asked, or it waits for an interrupt.
    Fine,
    /// It has branched to an `EXC_RETURN`, or met an exception of its own; Unicorn's number.
    Exception(u32),
    /// Unicorn's error.
    Error(i32),
}

/// A processor, as its surroundings see it while it runs.
#[derive(Clone, Copy)]
pub struct Cpu {
    engine: Engine,
    functions: &'static Functions,
}

/// A processor with what is around it.
pub struct Processor<A> {
    /// The processor alone.
    pub cpu: Cpu,
    /// What is around it. Boxed, as the library keeps its address.
    around: *mut Surroundings<A>,
}

struct Surroundings<A> {
    around: A,
    cpu: Cpu,
    exception: Option<u32>,
}

impl Cpu {
    fn checked(code: Code, what: &str) {
        assert!(code == 0, "Unicorn: {what}: error {code}");
    }

    /// A register's value.
    pub fn get(self, register: Register, beyond: usize) -> u32 {
        let mut value = 0_u32;
        // SAFETY: the register has 32 bits.
        let code =
            unsafe { (self.functions.get)(self.engine, register as i32 + beyond as i32, (&raw mut value).cast()) };
        Self::checked(code, "a register is read");
        value
    }

    /// Sets a register.
    pub fn set(self, register: Register, beyond: usize, value: u32) {
        // SAFETY: the register has 32 bits.
        let code =
            unsafe { (self.functions.set)(self.engine, register as i32 + beyond as i32, (&raw const value).cast()) };
        Self::checked(code, "a register is written");
    }

    /// Copies memory, whatever its protection; whether it is there.
    pub fn read(self, address: u32, bytes: &mut [u8]) -> bool {
        // SAFETY: the buffer has that length.
        unsafe {
            (self.functions.read)(self.engine, address.into(), bytes.as_mut_ptr().cast(), bytes.len() as u64) == 0
        }
    }

    /// Copies to memory, whatever its protection; whether it is there.
    pub fn write(self, address: u32, bytes: &[u8]) -> bool {
        // SAFETY: the buffer has that length.
        unsafe { (self.functions.write)(self.engine, address.into(), bytes.as_ptr().cast(), bytes.len() as u64) == 0 }
    }

    /// A word of memory.
    pub fn word(self, address: u32) -> Option<u32> {
        let mut bytes = [0; 4];
        self.read(address, &mut bytes).then(|| u32::from_le_bytes(bytes))
    }

    fn stop(self) {
        // SAFETY: the engine lives.
        unsafe { (self.functions.stop)(self.engine) };
    }
}

impl<A: Around> Processor<A> {
    /// A Cortex-M4F.
    ///
    /// # Errors
    /// [`NoUnicorn`].
    pub fn new(around: A) -> Result<Self, NoUnicorn> {
        let functions = functions()?;
        let mut engine = std::ptr::null_mut();
        // SAFETY: as unicorn.h has it; the hooks' user data outlives the engine (see `drop`).
        unsafe {
            Cpu::checked((functions.open)(ARCH_ARM, MODE, &raw mut engine), "it opens");
            Cpu::checked((functions.control)(engine, SET_MODEL, CORTEX_M4), "the model is chosen");
        }
        let cpu = Cpu { engine, functions };
        let around = Box::into_raw(Box::new(Surroundings { around, cpu, exception: None }));
        let processor = Self { cpu, around };
        processor.hook(HOOK_BLOCK, on_block::<A> as *const c_void, 1, 0);
        processor.hook(HOOK_INTERRUPT, on_interrupt::<A> as *const c_void, 1, 0);
        Ok(processor)
    }

    fn hook(&self, kind: c_int, callback: *const c_void, begin: u32, end: u32) {
        let mut handle = 0;
        // SAFETY: the callback has the signature of its kind.
        let code = unsafe {
            let engine = self.cpu.engine;
            (self.cpu.functions.hook)(
                engine,
                &raw mut handle,
                kind,
                callback,
                self.around.cast(),
                begin.into(),
                end.into(),
            )
        };
        Cpu::checked(code, "a hook is set");
    }

    /// Tells of every constant that is read in a range. Slow.
    pub fn watch_constants(&self, begin: u32, end: u32) {
        self.hook(HOOK_READ, on_constant::<A> as *const c_void, begin, end);
    }

    /// Memory.
    pub fn map(&self, address: u32, bytes: u32, access: Access) {
        // SAFETY: the engine lives.
        let code = unsafe { (self.cpu.functions.map)(self.cpu.engine, address.into(), bytes.into(), access as u32) };
        Cpu::checked(code, "memory is mapped");
    }

    /// Addresses behind which are peripherals. `BASE` is added to the offset that the library gives.
    pub fn map_device<const BASE: u32>(&self, bytes: u32) {
        let (read, write) = (on_read::<A, BASE> as *const c_void, on_write::<A, BASE> as *const c_void);
        let user = self.around.cast();
        // SAFETY: the callbacks have the signatures of unicorn.h.
        let code = unsafe {
            (self.cpu.functions.map_device)(self.cpu.engine, BASE.into(), bytes.into(), read, user, write, user)
        };
        Cpu::checked(code, "peripherals are mapped");
    }

    /// Runs from `pc` until something stops it.
    pub fn run(&mut self, pc: u32) -> Stopped {
        self.surroundings().exception = None;
        // SAFETY: the engine lives. While it runs, its surroundings are used by the callbacks only. No instruction lies at 0.
        let code = unsafe { (self.cpu.functions.start)(self.cpu.engine, u64::from(pc | 1), 0, 0, 0) };
        match self.surroundings().exception {
            Some(number) => Stopped::Exception(number),
            None if code != 0 => Stopped::Error(code),
            None => Stopped::Fine,
        }
    }

    fn surroundings(&mut self) -> &mut Surroundings<A> {
        // SAFETY: from `Box::into_raw`, and nobody else uses it while the processor stands still.
        unsafe { &mut *self.around }
    }

    /// What is around it.
    pub fn around(&mut self) -> &mut A {
        &mut self.surroundings().around
    }
}

impl<A> Drop for Processor<A> {
    fn drop(&mut self) {
        // SAFETY: nothing runs; after the engine nobody has the surroundings' address.
        unsafe {
            (self.cpu.functions.close)(self.cpu.engine);
            drop(Box::from_raw(self.around));
        }
    }
}

extern "C" fn on_block<A: Around>(_: Engine, address: u64, bytes: u32, user: *mut c_void) {
    // SAFETY: the user data of `Processor::new`.
    let surroundings = unsafe { &mut *user.cast::<Surroundings<A>>() };
    if surroundings.around.block(surroundings.cpu, address as u32, bytes) {
        surroundings.cpu.stop();
    }
}

extern "C" fn on_interrupt<A>(_: Engine, number: u32, user: *mut c_void) {
    // SAFETY: as above.
    let surroundings = unsafe { &mut *user.cast::<Surroundings<A>>() };
    surroundings.exception = Some(number);
    surroundings.cpu.stop();
}

extern "C" fn on_constant<A: Around>(_: Engine, _: c_int, _: u64, _: c_int, _: i64, user: *mut c_void) {
    // SAFETY: as above.
    unsafe { &mut *user.cast::<Surroundings<A>>() }.around.constant();
}

extern "C" fn on_read<A: Around, const BASE: u32>(_: Engine, offset: u64, bytes: u32, user: *mut c_void) -> u64 {
    // SAFETY: as above.
    let surroundings = unsafe { &mut *user.cast::<Surroundings<A>>() };
    let cpu = surroundings.cpu;
    surroundings.around.read(cpu, BASE + offset as u32, bytes).map_or_else(
        || {
            cpu.stop();
            0
        },
        u64::from,
    )
}

extern "C" fn on_write<A: Around, const BASE: u32>(_: Engine, offset: u64, bytes: u32, value: u64, user: *mut c_void) {
    // SAFETY: as above.
    let surroundings = unsafe { &mut *user.cast::<Surroundings<A>>() };
    let cpu = surroundings.cpu;
    if !surroundings.around.write(cpu, BASE + offset as u32, bytes, value as u32) {
        cpu.stop();
    }
}
