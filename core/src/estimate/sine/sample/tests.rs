use super::*;

/// Q30 to Q10, to the nearest, halves upwards.
#[test]
fn products_are_rounded_to_the_nearest() {
    let half = 1 << (PRODUCT_SHIFT - 1);
    for (counts, q30, product) in
        [(1, half, 1), (1, half - 1, 0), (-1, half, 0), (-1, half + 1, -1), (3, 2 * half, 3), (-3, 2 * half, -3)]
    {
        assert_eq!(rounded_product(counts, q30), product, "{counts}·{q30}");
    }
}

/// One sum that leaves its range is enough, whichever it is.
#[test]
fn each_sum_has_its_range() {
    let full = |i: usize| {
        let at = |j: usize, value: i64| if i == j { value } else { 0 };
        let sums = |value| CountSums { cos_q10: at(0, value), sin_q10: at(1, value), sum: at(2, value) };
        let mut into = sums(i64::MAX);
        (i32::merge(&mut into, &sums(0)), i32::merge(&mut into, &sums(1)))
    };
    assert_eq!([0, 1, 2].map(full), [(true, false); 3]);
}

/// A power beyond 62 bits is read in two parts, both of them exactly.
#[test]
fn power_is_read_in_two_parts() {
    let read = |power: u128| <i32 as Sample>::read_power::<f64>(&power);
    assert_eq!(read(0), 0.0);
    assert_eq!(read(5), 5.0);
    assert_eq!(read((1 << 62) - (1 << 20)), 4_611_686_018_426_339_328.0);
    assert_eq!(read((5 << 62) + (3 << 20)), 5.0 * 4_611_686_018_427_387_904.0 + 3_145_728.0);
    assert_eq!(read(1 << 100), (1_u128 << 100) as f64);
}

/// One sample at a time or as a slice: the same sums, the same phase, the same verdict on the range.
#[test]
fn one_by_one_as_in_a_slice() {
    let samples = [-7, 123_456, i32::MAX, 5, -2_000_000_000, 0, 42];
    for reference in [0, -7, 900] {
        let (mut one, mut all) = (<i32 as Sample>::Sums::default(), <i32 as Sample>::Sums::default());
        let (mut one_power, mut all_power) = (0, 0);
        let (mut phase, mut in_range) = (77, true);
        for sample in samples {
            let (next, fits) = sample.accumulate_one(reference, phase, 1 << 20, &mut one, &mut one_power);
            phase = next;
            in_range &= fits;
        }
        let whole = i32::accumulate(&samples, reference, 77, 1 << 20, &mut all, &mut all_power);
        assert_eq!((phase, in_range), whole, "reference {reference}");
        assert_eq!(in_range, reference != -7, "MAX less −7 is beyond i32: {reference}");
        assert_eq!((one.cos_q10, one.sin_q10, one.sum), (all.cos_q10, all.sin_q10, all.sum));
        assert_eq!(one_power, all_power);
    }
}
