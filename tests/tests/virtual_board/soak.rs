//! The soak of `cargo xtask soak`, for some seconds and with more noise.

use std::time::Duration;

use breakaway_tests::soak::soak;

#[test]
fn nothing_is_lost_but_the_frames_that_were_hit() {
    needs_qemu!();
    // 2000 hits of a million bytes: a third of the frames.
    let outcome = soak(Duration::from_secs(8), 2_000, 7).unwrap_or_else(|error| panic!("{error}"));
    let failures = outcome.failures();
    assert!(failures.is_empty(), "{failures:?}: {outcome:?}");
    // It was a soak: there was noise, and it did hit.
    assert!(outcome.lost() > 5 && outcome.stream.lost_batches > 5 && outcome.stream.gaps > 3, "{outcome:?}");
    assert!(outcome.damaged > 5 && outcome.stream.samples > 2_000, "{outcome:?}");
}
