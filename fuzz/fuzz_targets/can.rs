#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    breakaway_tests::fuzz::target("can").take(bytes);
});
