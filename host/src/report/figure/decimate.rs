//! Long signals for short widths.

/// Indices of at most about `most` samples of `y` that keep every peak. They are the smallest and the largest of each
/// bucket, in order of time, and the two ends.
pub fn peaks(y: &[f64], most: usize) -> Vec<usize> {
    if y.len() <= most.max(4) {
        return (0..y.len()).collect();
    }
    let buckets = most.max(4) / 2;
    let mut kept = vec![0];
    for bucket in 0..buckets {
        let range = bucket * y.len() / buckets..(bucket + 1) * y.len() / buckets;
        let least = range.clone().min_by(|a, b| y[*a].total_cmp(&y[*b]));
        let largest = range.max_by(|a, b| y[*a].total_cmp(&y[*b]));
        if let (Some(a), Some(b)) = (least, largest) {
            kept.extend([a.min(b), a.max(b)]);
        }
    }
    kept.push(y.len() - 1);
    kept.dedup();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_spike_survives() {
        let mut y = vec![0.0; 100_000];
        y[76_543] = 1.0;
        y[12_345] = -1.0;
        let kept = peaks(&y, 2000);
        assert!(kept.len() <= 2002 && kept.contains(&76_543) && kept.contains(&12_345));
        assert!(kept.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!((kept[0], kept[kept.len() - 1]), (0, 99_999));
    }
}
