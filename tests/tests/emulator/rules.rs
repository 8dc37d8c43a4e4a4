//! Each rule of the models is broken once: it ends the run, and the message names the register.

use breakaway_core::link::Command;
use breakaway_emulator::bench::{Bench, MS};
use breakaway_emulator::bridge::Leg;
use breakaway_emulator::flash::PAGES;
use breakaway_emulator::registers::address;

use crate::machine::{axis, board, relay};

/// A write that must be refused, for this reason.
fn refused(bench: &mut Bench, register: &str, value: u32, rule: &str) {
    let broken = bench.machine.poke(address(register), 4, value).expect_err(register);
    assert_eq!(broken.register.split('.').next(), register.split('.').next(), "{broken:?}");
    assert!(broken.rule.contains(rule), "{register}: {broken:?}");
}

#[test]
fn a_register_is_used_as_it_may_be() {
    needs_unicorn!();
    let mut bench = board();
    refused(&mut bench, "TIM3.CR1", 1, "no model");
    refused(&mut bench, "TIM1.SR", u32::MAX, "reserved bits (0xff0cc000)");
    refused(&mut bench, "PWR.CR5", 0x101, "reserved bits (0x00000001)");
    refused(&mut bench, "GPIOA.IDR", 0, "for reading only");
    let read = bench.machine.peek(address("TIM1.EGR"), 2).unwrap_err();
    assert!(read.rule.contains("for writing only"), "{read:?}");
    let half = bench.machine.poke(address("RCC.CR"), 2, 0).unwrap_err();
    assert!(half.rule.contains("parts of 2 bytes"), "{half:?}");
    let nowhere = bench.machine.poke(0x4000_00fc, 4, 0).unwrap_err();
    assert!(nowhere.rule.contains("no register is there"), "{nowhere:?}");
    let clocks = bench.machine.peek(address("RCC.APB2ENR"), 4).unwrap();
    bench.machine.poke(address("RCC.APB2ENR"), 4, clocks & !(1 << 11)).unwrap();
    refused(&mut bench, "TIM1.CCR[0]", 5, "clock is off");
}

#[test]
fn clocks_in_their_order() {
    needs_unicorn!();
    let mut bench = board();
    let (control, config) = (address("RCC.CR"), address("RCC.CFGR"));
    let (on, set) = (bench.machine.peek(control, 4).unwrap(), bench.machine.peek(config, 4).unwrap());
    refused(&mut bench, "RCC.CR", on & !(1 << 24), "the clock that the core runs on is switched off");
    refused(&mut bench, "RCC.PLLCFGR", 0x0100_1033, "while it runs");
    bench.machine.poke(control, 4, on & !(1 << 8)).unwrap();
    refused(&mut bench, "RCC.CFGR", set & !3 | 1, "not ready");
    // To the crystal and back in one step; and without the boost.
    bench.machine.poke(config, 4, set & !3 | 2).unwrap();
    refused(&mut bench, "RCC.CFGR", set, "in one step");
    bench.machine.poke(address("PWR.CR5"), 4, 0x100).unwrap();
    refused(&mut bench, "RCC.CFGR", set | 0x80, "boost");
    bench.machine.poke(address("FLASH.ACR"), 4, 0x0004_0600).unwrap();
    refused(&mut bench, "RCC.CFGR", set | 0x80, "wait states");
}

#[test]
fn the_flash_is_programmed_as_it_may_be() {
    needs_unicorn!();
    let mut bench = board();
    let at = PAGES.start;
    let machine = &mut bench.machine;
    let refused = |result: Result<(), breakaway_emulator::bus::Broken>, rule: &str| {
        let broken = result.expect_err(rule);
        assert!(broken.rule.contains(rule), "{broken:?}");
    };
    let (control, key) = (address("FLASH.CR"), address("FLASH.KEYR"));
    refused(machine.poke(at, 4, 0), "without unlocking");
    refused(machine.poke(control, 4, 1), "locked");
    refused(machine.poke(key, 4, 1), "wrong key");
    machine.poke(key, 4, 0x4567_0123).unwrap();
    machine.poke(key, 4, 0xcdef_89ab).unwrap();
    machine.poke(control, 4, 1).unwrap();
    refused(machine.poke(at, 4, 0), "data cache is on");
    machine.poke(address("FLASH.ACR"), 4, 0x0004_0304).unwrap();
    refused(machine.poke(at + 4, 4, 0), "second half");
    refused(machine.poke(at, 1, 0), "other parts than words");
    machine.poke(at, 4, 1).unwrap();
    machine.poke(at + 4, 4, 2).unwrap();
    refused(machine.poke(at + 8, 4, 0), "busy");
    refused(machine.peek(at, 4).map(|_| ()), "busy");
    bench.run(MS);
    let machine = &mut bench.machine;
    assert_eq!(machine.peek(at, 4), Ok(1));
    machine.poke(at, 4, 1).unwrap();
    refused(machine.poke(at + 4, 4, 2), "programmed twice");
    refused(machine.poke(control, 4, 1 << 16 | 1 << 11 | 126 << 3), "without PER");
    refused(machine.poke(control, 4, 1 << 16 | 2 | 126 << 3), "not one of the settings'");
}

/// Outputs are not switched on before everything is in place; and the power stage not before TIM1 holds its inputs.
#[test]
fn outputs_come_on_in_their_order() {
    needs_unicorn!();
    let on = 1 << 15;
    let mut bench = board();
    let bdtr = bench.machine.peek(address("TIM1.BDTR"), 4).unwrap();
    for (register, value, rule) in [
        ("TIM1.CCER", 0x11, "both outputs of both legs"),
        ("TIM1.CR2", 0x100, "off would be on"),
        ("TIM1.AF1", 0, "without the break input"),
        ("GPIOB.MODER", 0xffff_ffff, "PB0 is not given to TIM1"),
    ] {
        let before = bench.machine.peek(address(register), 4).unwrap();
        bench.machine.poke(address(register), 4, value).unwrap();
        refused(&mut bench, "TIM1.BDTR", bdtr | on, rule);
        bench.machine.poke(address(register), 4, before).unwrap();
    }
    refused(&mut bench, "TIM1.BDTR", bdtr & !0xff | on, "without a dead time");
    refused(&mut bench, "TIM1.BDTR", bdtr & !(1 << 10) | on, "floating");
    refused(&mut bench, "TIM1.BDTR", bdtr & !(1 << 12) | on, "without the break input");
    refused(&mut bench, "TIM1.BDTR", bdtr | 1 << 14 | on, "come on again by themselves");
    // With all of it in place, and the dead time no longer to be changed.
    bench.machine.poke(address("TIM1.BDTR"), 4, bdtr | on).unwrap();
    refused(&mut bench, "TIM1.BDTR", (bdtr + 1) | on, "while the outputs are on");
    bench.machine.poke(address("TIM1.BDTR"), 4, 0).unwrap_err();
    let mut bench = board();
    bench.machine.poke(address("TIM1.BDTR"), 4, 0).unwrap();
    refused(&mut bench, "GPIOB.BSRR", 1 << 5, "before TIM1 holds its inputs");
}

/// Inverted, the low side is on while the high side is: in the running machine, and for every duty.
#[test]
fn both_switches_of_a_leg_are_never_on() {
    needs_unicorn!();
    let mut bench = axis();
    bench.done(relay(2.0, 1.5, 0));
    bench.run(20 * MS);
    refused(&mut bench, "TIM1.CCER", 0x5d, "both switches of leg A are on");
    for compare in 0..=200 {
        let leg = Leg { compare, half_period: 200, dead: 9, bits: 0b0101 };
        assert_eq!(leg.shoot_through(), None, "{leg:?}");
        let high = (0..400).filter(|clock| leg.levels(*clock).0).count() as u32;
        assert!(high == (2 * compare).saturating_sub(9) || compare == 200 && high == 400, "{leg:?}: {high}");
        let overlaps = |leg: Leg| leg.shoot_through().is_some();
        // Without a dead time one comes on when the other goes off; inverted, both are on.
        assert_eq!(overlaps(Leg { dead: 0, ..leg }), (1..200).contains(&compare), "{leg:?}");
        assert!(overlaps(Leg { bits: 0b1101, ..leg }) || compare <= 4, "{leg:?}");
    }
}

#[test]
fn the_link_and_the_watchdog_are_set_up_in_their_order() {
    needs_unicorn!();
    let mut bench = board();
    refused(&mut bench, "LPUART1.BRR", 0x4000, "while the LPUART is on");
    refused(&mut bench, "DMA1.CH[1].NDTR", 5, "while channel 2 is on");
    refused(&mut bench, "IWDG.RLR", 5, "without the key");
    refused(&mut bench, "IWDG.KR", 5, "no key");
    refused(&mut bench, "TIM2.SMCR", 1, "while it counts");
    refused(&mut bench, "SCB.AIRCR", 4, "key");
    // A burst that is changed while DMA sends it.
    let burst = bench.machine.peek(address("DMA1.CH[0].MAR"), 4).unwrap();
    bench.send(Command::Hello);
    while bench.machine.peek(address("LPUART1.ISR"), 4).unwrap() & 1 << 6 != 0 {
        bench.run(1000);
    }
    bench.machine.write_memory(burst, &[0xaa; 8]);
    let violation = bench.try_run(5 * MS).unwrap_err();
    assert!(violation.to_string().contains("changed while DMA sends them"), "{violation}");
}
