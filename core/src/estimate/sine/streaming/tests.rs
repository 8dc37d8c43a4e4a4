use super::*;

/// A block is a quarter of the period, rounded, and no shorter than the shortest; exact in integers.
#[test]
fn a_block_is_a_quarter_period() {
    let block = |samples| StreamingSine::of_period(samples, 1e-3).map(|fit| fit.first_block);
    for (samples, quarter) in [(1000, 250), (1001, 250), (1003, 251), (10_007, 2502), (100_001, 25_000)] {
        assert_eq!(block(samples), Some(quarter), "{samples}");
    }
    assert_eq!(block(4), Some(SHORTEST_BLOCK));
    assert!(block(3).is_none());
}

/// What left the range of its integers is known ever after, whichever way the samples came.
#[test]
fn saturation_is_not_forgotten() {
    let fit = StreamingSine::of_period(40, 1e-3_f64).unwrap();
    let mut samples: [i32; 400] = core::array::from_fn(|k| k as i32 % 40);
    // The differences are taken from the first sample: this one is beyond i32.
    (samples[0], samples[1]) = (-2, i32::MAX);
    let (mut single, mut slice) = (BlockSums::<i32, 8>::new(), BlockSums::<i32, 8>::new());
    for sample in samples {
        fit.push(&mut single, sample);
    }
    fit.push_slice(&mut slice, &samples);
    assert_eq!(fit.fit(&single), Err(SineError::Saturated));
    assert_eq!(fit.fit(&slice), Err(SineError::Saturated));
}

/// Sums that leave their range where two blocks become one are known, too.
#[test]
fn blocks_that_saturate_when_they_are_paired_are_known() {
    // The largest sums that can be reached by doubling: twice them is too much.
    let (mut largest, mut power) = (<i32 as Sample>::Sums::default(), 0);
    i32::MAX.accumulate_one(0, 0, 0, &mut largest, &mut power);
    loop {
        let mut doubled = largest;
        if !i32::merge(&mut doubled, &largest) {
            break;
        }
        largest = doubled;
    }
    let paired = |at: usize| {
        let mut sums = BlockSums::<i32, 8> { full: 7, ..BlockSums::new() };
        sums.blocks[at] = largest;
        sums.blocks[at + 1] = largest;
        sums.close_block();
        (sums.full, sums.doublings, sums.in_range)
    };
    // The last block is the open one, which is empty here.
    assert_eq!([0, 2, 4].map(paired), [(4, 1, false); 3]);
    // Neighbours that are not paired with each other stay apart.
    assert_eq!([1, 3].map(paired), [(4, 1, true); 2]);
}
