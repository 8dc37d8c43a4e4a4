//! The tick's code in CCM SRAM, where no wait states are (memory.x says which code it is). Copied from flash after each reset, before
//! anything of the program runs: cortex-m-rt calls `__pre_init` first. In assembly, as memory has no content yet.

core::arch::global_asm!(
    ".section .text.__pre_init, \"ax\", %progbits",
    ".global __pre_init",
    ".type __pre_init, %function",
    ".thumb_func",
    "__pre_init:",
    "ldr r0, =__stick",
    "ldr r1, =__etick",
    "ldr r2, =__sitick",
    "1: cmp r0, r1",
    "beq 2f",
    "ldr r3, [r2], #4",
    "str r3, [r0], #4",
    "b 1b",
    // The copy is complete before it is run.
    "2: dsb",
    "isb",
    "bx lr",
    ".ltorg",
    ".text",
);
