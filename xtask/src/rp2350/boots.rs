//! Whether the boot ROM starts an image, and whether it runs from RAM then (docs/board-pico2.md, "What starts it").

use anyhow::{Context, Result, bail, ensure};

use super::{FLASH, Image, RAM, RAM_END, SETTINGS};

/// The smallest image definition: a program for the Arm cores of an RP2350, in Secure state (RP2350, boot ROM, minimum
/// Arm IMAGE_DEF).
const DEFINITION: [u32; 5] = [0xffff_ded3, 0x1021_0142, 0x0000_01ff, 0, 0xab12_3579];
/// The boot ROM looks for it in so many bytes.
const LOOKED_AT: u32 = 4096;
/// Exceptions and interrupts of the RP2350.
const VECTORS: u32 = 16 + 52;
/// Vectors of exceptions that the architecture leaves out, and of the debugger's cross triggers, which the HAL does not
/// name and nothing enables.
const RESERVED: [u32; 6] = [8, 9, 10, 13, 16 + 40, 16 + 41];
/// Handlers that must be there, by their vectors: numbers of RP2350, interrupts, after the sixteen exceptions.
const HANDLED: [(&str, u32); 3] = [("HardFault", 3), ("PWM_IRQ_WRAP_0", 16 + 8), ("IO_IRQ_BANK0", 16 + 21)];
/// What runs before the program has been copied to RAM.
const BEFORE_THE_COPY: [&str; 3] = ["Reset", "DefaultPreInit", "__pre_init"];

/// Everything that the boot ROM and the start-up code need.
pub(super) fn check(image: &Image) -> Result<()> {
    stored(image)?;
    let stack = image.word(FLASH).context("nothing at the start of the flash")?;
    ensure!(stack > RAM && stack <= RAM_END && stack.is_multiple_of(8), "the stack starts at {stack:#x}");
    let first = image.word(FLASH + 4).context("no reset vector")?;
    let reset = image.function("Reset").context("no start-up code")?;
    ensure!(first == reset | 1, "the reset vector is {first:#x}, the start-up code is at {reset:#x}");
    let defined = (FLASH..FLASH + LOOKED_AT)
        .step_by(4)
        .any(|at| DEFINITION.iter().zip((at..).step_by(4)).all(|(word, at)| image.word(at) == Some(*word)));
    ensure!(defined, "the first {LOOKED_AT} bytes hold no image definition");
    for (name, at) in &image.functions {
        let early = BEFORE_THE_COPY.contains(&name.as_str()) || name.contains("Thunk");
        let right = if early { (FLASH..SETTINGS).contains(at) } else { (RAM..RAM_END).contains(at) };
        ensure!(right, "{name} runs at {at:#x}");
    }
    vectors(image, stack)
}

/// What is kept is kept in flash, before the settings, and does not overlap.
fn stored(image: &Image) -> Result<()> {
    let mut end = FLASH;
    for (start, bytes) in image.flash() {
        ensure!(start >= end, "{start:#x} is outside of the flash, or in what is before it");
        end = start + bytes.len() as u32;
        ensure!(end <= SETTINGS, "the program reaches {end:#x}, into the settings");
    }
    Ok(())
}

/// The vectors are in RAM, where the core may look for them, and lead to code.
fn vectors(image: &Image, stack: u32) -> Result<()> {
    let table = image.vectors.context("no vectors")?;
    let size = (4 * VECTORS).next_power_of_two();
    ensure!((RAM..RAM_END).contains(&table) && table.is_multiple_of(size), "the vectors are at {table:#x}");
    ensure!(image.word(table) == Some(stack), "the vectors start with another stack");
    for number in 2..VECTORS {
        let Some(vector) = image.word(table + 4 * number) else { bail!("vector {number} is not loaded") };
        if RESERVED.contains(&number) {
            continue;
        }
        let code = image.functions.iter().any(|(_, at)| vector == at | 1);
        ensure!(code, "vector {number} is {vector:#x}, which is no function");
    }
    let unhandled = image.function("DefaultHandler");
    for (name, number) in HANDLED {
        let handler = image.function(name).with_context(|| format!("no {name}"))?;
        ensure!(Some(handler) != unhandled, "{name} is not handled");
        ensure!(image.word(table + 4 * number) == Some(handler | 1), "vector {number} is not {name}");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rp2350::Segment;

    /// An image as the linker makes it: start-up code in flash, vectors and handlers in RAM.
    fn image() -> Image {
        let bytes = |words: &[u32]| words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>();
        let mut boot = vec![RAM_END, FLASH + 0x1d];
        boot.extend(DEFINITION);
        boot.resize(32, 0);
        let handler = |number: u32| RAM + 0x200 + 16 * HANDLED.iter().position(|row| row.1 == number).unwrap() as u32;
        let mut program = vec![RAM + 0x301; VECTORS as usize];
        program[0] = RAM_END;
        for (_, number) in HANDLED {
            program[number as usize] = handler(number) | 1;
        }
        program.resize(0x400 / 4, 0);
        let mut functions = vec![("Reset".to_owned(), FLASH + 0x1c), ("DefaultHandler".to_owned(), RAM + 0x300)];
        functions.extend(HANDLED.map(|(name, number)| (name.to_owned(), handler(number))));
        let segments = vec![
            Segment { stored: FLASH, runs: FLASH, bytes: bytes(&boot) },
            Segment { stored: FLASH + 0x200, runs: RAM, bytes: bytes(&program) },
        ];
        Image { segments, functions, vectors: Some(RAM) }
    }

    #[test]
    fn an_image_that_the_boot_rom_would_not_start_is_told() {
        check(&image()).unwrap();
        let wrong = |what: &str, spoil: &dyn Fn(&mut Image)| {
            let mut image = image();
            spoil(&mut image);
            let said = check(&image).expect_err(what).to_string();
            assert!(said.contains(what), "{said}: not {what}");
        };
        wrong("the stack starts at", &|image| image.segments[0].bytes[3] = 0);
        wrong("the reset vector is", &|image| image.segments[0].bytes[4] ^= 1);
        for byte in 8..28 {
            wrong("no image definition", &move |image| image.segments[0].bytes[byte] ^= 4);
        }
        wrong("main runs at 0x10000020", &|image| image.functions.push(("main".into(), FLASH + 0x20)));
        wrong("Reset runs at", &|image| {
            image.functions[0].1 = RAM;
            image.segments[0].bytes[4..8].copy_from_slice(&(RAM | 1).to_le_bytes());
        });
        wrong("into the settings", &|image| image.segments[1].stored = SETTINGS - 4);
        wrong("is outside of the flash", &|image| image.segments[1].stored = FLASH + 4);
        wrong("the vectors are at", &|image| image.vectors = Some(RAM + 128));
        wrong("which is no function", &|image| image.segments[1].bytes[4 * 20] ^= 8);
        wrong("vector 37 is not IO_IRQ_BANK0", &|image| {
            image.segments[1].bytes.copy_within(4 * 20..4 * 21, 4 * 37);
        });
        wrong("HardFault is not handled", &|image| {
            image.functions[2].1 = RAM + 0x300;
            image.segments[1].bytes[12..16].copy_from_slice(&(RAM + 0x301).to_le_bytes());
        });
    }
}
