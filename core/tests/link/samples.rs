//! Batches of samples.

use breakaway_core::link::*;
use proptest::prelude::*;

use crate::examples;

fn read(batch: &Batch) -> Vec<Sample> {
    batch.samples().map(Result::unwrap).collect()
}

#[test]
fn extremes_come_back() {
    assert_eq!(read(&examples::batch()), examples::samples());
    let samples = examples::samples_with_current();
    assert_eq!(read(&examples::batch_of(samples)), samples);
}

#[test]
fn a_gap_begins_a_new_batch() {
    let mut writer = BatchWriter::new(1);
    let sample = |tick| Sample { tick, count: 5, ..Sample::default() };
    assert_eq!(writer.push(sample(u32::MAX), 0), None);
    // The tick wraps without a gap; then three are missing.
    assert_eq!(writer.push(sample(0), 0), None);
    let first = writer.push(sample(4), 3).unwrap();
    assert_eq!((first.sequence, first.first_tick, read(&first).len()), (0, u32::MAX, 2));
    let second = writer.flush(3).unwrap();
    assert_eq!((second.sequence, second.first_tick, second.dropped), (1, 4, 3));
    assert_eq!(read(&second), [sample(4)]);
    assert_eq!(writer.flush(3), None);
}

/// Every sample of a batch has a current, or none has.
#[test]
fn a_current_that_comes_or_goes_begins_a_new_batch() {
    let mut writer = BatchWriter::new(1);
    let sample = |tick, current_ma| Sample { tick, current_ma, ..Sample::default() };
    assert_eq!(writer.push(sample(0, None), 0), None);
    let before = writer.push(sample(1, Some(-5)), 0).unwrap();
    assert_eq!((before.currents, read(&before)), (false, vec![sample(0, None)]));
    let measured = writer.push(sample(2, None), 0).unwrap();
    assert_eq!((measured.currents, read(&measured)), (true, vec![sample(1, Some(-5))]));
    assert_eq!(read(&writer.flush(0).unwrap()), [sample(2, None)]);
}

/// A current that moves by less than 64 mA from one sample to the next costs one byte: 5 of a batch's 224, where 4 were before.
#[test]
fn a_current_costs_a_byte() {
    let mut writer = BatchWriter::new(1);
    let samples = (0..).map(|tick| {
        let current_ma = Some(if tick % 2 == 0 { 1_000 } else { 1_063 });
        Sample { tick, count: tick as i32, mode: Mode::Track, current_ma, ..Sample::default() }
    });
    let full = samples.map(|sample| writer.push(sample, 0)).find_map(|batch| batch).unwrap();
    assert!(read(&full).len() >= 41, "{}", read(&full).len());
}

#[test]
fn damaged_steps_are_an_error_and_end_the_batch() {
    let mut batch = examples::batch();
    batch.steps.truncate(batch.steps.len() - 1);
    let read: Vec<_> = batch.samples().collect();
    assert_eq!(read.len(), 4);
    assert_eq!(read[3], Err(BatchError));
}

fn any_sample() -> impl Strategy<Value = (i32, i16, i32, u8, Option<i32>)> {
    (any::<i32>(), any::<i16>(), any::<i32>(), 0u8..6, any::<Option<i32>>())
}

proptest! {
    /// Whatever is pushed comes out, once and in order, and every batch fits a frame.
    #[test]
    fn nothing_is_lost(
        rows in prop::collection::vec((any_sample(), 0u32..20), 0..200),
        decimation in 1u16..5,
        start in any::<u32>(),
    ) {
        let modes = [Mode::Idle, Mode::Relay, Mode::Drive, Mode::Track, Mode::Hold, Mode::Fault];
        let mut writer = BatchWriter::new(decimation);
        let (mut sent, mut batches, mut tick) = (Vec::new(), Vec::new(), start);
        for ((count, drive_code, reference, mode, current_ma), gap) in rows {
            // One in twenty follows a gap.
            tick = tick.wrapping_add(u32::from(decimation) * if gap == 0 { 3 } else { 1 });
            let sample = Sample { tick, count, drive_code, reference, mode: modes[usize::from(mode)], current_ma };
            sent.push(sample);
            batches.extend(writer.push(sample, 9));
        }
        batches.extend(writer.flush(9));
        let mut frame = [0; MAX_FRAME];
        for (i, batch) in batches.iter().enumerate() {
            prop_assert_eq!(batch.sequence, i as u32);
            prop_assert_eq!(batch.decimation, decimation);
            prop_assert!(encode(&Message::Samples(batch.clone()), &mut frame).is_ok());
        }
        let received: Vec<Sample> = batches.iter().flat_map(read).collect();
        prop_assert_eq!(received, sent);
    }

    /// Reading arbitrary bytes ends, without a panic.
    #[test]
    fn arbitrary_steps_are_read(bytes in prop::collection::vec(any::<u8>(), 0..BATCH_BYTES), decimation: u16) {
        let steps = bytes.iter().copied().collect();
        let batch = Batch { decimation, steps, ..examples::batch() };
        prop_assert!(batch.samples().count() <= bytes.len());
    }
}
