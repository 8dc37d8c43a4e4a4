//! Blocks, folds and the paired test.

use super::*;

fn track(samples: usize, gap_at: Option<usize>) -> MeasuredMotion {
    let t: Vec<f64> = (0..samples).map(|k| k as f64 * 1e-3).collect();
    let x = t.iter().map(|t| (6.0 * t).sin()).collect();
    let gaps = gap_at.into_iter().collect();
    let recording = crate::recording::Recording { u: vec![0.0; samples], x, t, gaps, ..Default::default() };
    MeasuredMotion::new(&recording)
}

/// Blocks lie within pieces, cover them without overlap, and are about 1.2 s; a piece of 1 s has none.
#[test]
fn blocks_tile_the_pieces() {
    let tracks = [track(5_000, Some(1_000)), track(2_400, None)];
    let blocks = blocks(&tracks);
    let ends: Vec<(usize, usize, usize)> = blocks.iter().map(|b| (b.track, b.start, b.end)).collect();
    assert_eq!(ends, [(0, 1_000, 2_333), (0, 2_333, 3_666), (0, 3_666, 5_000), (1, 0, 1_200), (1, 1_200, 2_400)]);
}

/// What is fitted of one fold shares no sample with the other fold's blocks, which it predicts.
#[test]
fn a_fold_holds_no_sample_of_the_other() {
    let tracks = [track(9_600, None)];
    let blocks = blocks(&tracks);
    let windows = crate::identify::weak::windows(&tracks);
    for i in 0..2 {
        let own = fold(&tracks, &blocks, &windows, 0.4, i);
        assert!(own.windows.len() > 100 && own.segments.len() == 12, "{}", own.segments.len());
        let spans = own.windows.iter().map(|w| (w.first, w.first + w.weights.len() + 1));
        for (start, end) in spans.chain(own.segments.iter().map(|s| (s.start, s.start + s.len))) {
            assert!(members(&blocks, 1 - i).all(|other| end <= other.start || start >= other.end), "{start} {end}");
        }
    }
}

/// Student's t of eight, sixteen and thirty differences at 1 %: 3.499, 2.947, 2.756 from the table, to 2 %.
#[test]
fn the_paired_test_is_students() {
    for (n, table) in [(8, 3.499), (16, 2.947), (30, 2.756)] {
        // Half at a + 1 and half at a − 1: the mean is a, the standard error √(1/(n − 1)).
        let t_of = |t: f64| {
            let a = t / f64::from(n - 1).sqrt();
            let d: Vec<f64> = (0..n).map(|i| a + if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
            Comparison::of(&d).unwrap()
        };
        assert!((t_of(2.0).t() - 2.0).abs() < 1e-9, "{}", t_of(2.0).t());
        assert!(t_of(1.02 * table).second_is_better() && !t_of(0.98 * table).second_is_better(), "{n}");
        assert!(t_of(-1.02 * table).first_is_better() && !t_of(-0.98 * table).first_is_better(), "{n}");
    }
    assert_eq!(Comparison::of(&[1.0; 7]), None);
}
