//! The encoder's step, read off the positions.

/// Differences looked at; the smallest ones of the first [`ROWS`] rows tell the step best.
const DIFFERENCES: usize = 4096;
/// Rows looked at.
const ROWS: usize = 200_000;
/// Different sizes of difference tried as the step, smallest first, and whole fractions of each.
const CANDIDATES: usize = 200;
const FRACTIONS: u32 = 3;
/// Largest rms distance of a difference from a whole number of steps, in steps. Unquantised positions have 1/√12 = 0.29;
/// an encoder printed with 30 digits per step 0.014.
const WHOLE_WITHIN: f64 = 0.12;
/// A finer step than this fraction of the range is the number format's, not an encoder's.
const FINEST: f64 = 1.0 / 4_294_967_296.0;

/// The greatest step that divides all position differences, position units; `None` if the positions are not visibly
/// quantised. A repeated value of a `held` position shows no step. Only the smallest difference can be a single step.
pub(super) fn infer_step(x: &[f64], held: bool) -> Option<f64> {
    let x = x.get(..ROWS).unwrap_or(x);
    let (low, high) = x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)));
    let floor = (high - low) * FINEST;
    if !(floor.is_finite() && floor > 0.0) {
        return None;
    }
    let mut still = 0;
    let mut sizes: Vec<f64> = Vec::with_capacity(x.len());
    for w in x.windows(2) {
        let size = (w[1] - w[0]).abs();
        if size > floor {
            sizes.push(size);
        } else if !held {
            still += 1;
        }
    }
    if sizes.len() < 16 {
        return None;
    }
    sizes.sort_unstable_by(f64::total_cmp);
    sizes.truncate(DIFFERENCES);

    let mut candidates: Vec<f64> = Vec::new();
    for &size in &sizes {
        if candidates.last().is_none_or(|&last| size > 1.01 * last) {
            candidates.push(size);
        }
        if candidates.len() == CANDIDATES {
            break;
        }
    }
    if held {
        candidates.truncate(1);
    }
    candidates
        .iter()
        .flat_map(|size| (1..=FRACTIONS).map(move |part| size / f64::from(part)))
        .filter(|&step| step > floor)
        .filter_map(|step| refine(&sizes, step))
        .filter(|&step| distinct(&sizes, step, still))
        .max_by(f64::total_cmp)
        .map(rounded)
}

/// Least-squares step over ever larger differences; `None` where they are not whole multiples.
fn refine(sizes: &[f64], candidate: f64) -> Option<f64> {
    let mut step = candidate;
    let largest = sizes.last()?;
    let mut reach = 8.0;
    loop {
        let within = sizes.partition_point(|&size| size <= reach * step);
        let (mut cross, mut square, mut wrong) = (0.0, 0.0, 0.0);
        for &size in sizes.get(..within)? {
            // At least one step: a change much smaller than the step refutes it.
            let count = (size / step).round().max(1.0);
            let off = size / step - count;
            cross += size * count;
            square += count * count;
            wrong += off * off;
        }
        if within > 0 && wrong > WHOLE_WITHIN * WHOLE_WITHIN * within as f64 {
            return None;
        }
        if square > 0.0 {
            step = cross / square;
        }
        if reach * step > *largest {
            return (step > 0.0).then_some(step);
        }
        reach *= 2.0;
    }
}

/// A single size of difference is a step only if the position also rests in between: a constant speed has one size too.
fn distinct(sizes: &[f64], step: f64, still: usize) -> bool {
    let mut counts: Vec<u64> = sizes.iter().map(|size| (size / step).round() as u64).collect();
    counts.dedup();
    counts.len() >= 3 || still * 10 >= sizes.len()
}

/// The least-squares step without the digits it does not have.
fn rounded(step: f64) -> f64 {
    format!("{step:.5e}").parse().unwrap_or(step)
}

#[cfg(test)]
mod tests {
    use super::infer_step;

    fn sine(step: f64, decimals: i32) -> Vec<f64> {
        let unit = 10_f64.powi(decimals);
        (0..5000)
            .map(|k| (0.01 * f64::from(k)).sin() + 0.3 * (0.0037 * f64::from(k)).sin())
            .map(|x| if step > 0.0 { (x / step).round() * step } else { x })
            .map(|x| (x * unit).round() / unit)
            .collect()
    }

    #[test]
    fn finds_the_step_of_an_encoder_printed_with_few_decimals() {
        // As in the LAAS files: 20 000 counts per turn printed to 1e-5 rad. The print's 0.03 steps average out over 4096 differences.
        let step = infer_step(&sine(std::f64::consts::TAU / 20_000.0, 5), false).unwrap();
        assert!((step / (std::f64::consts::TAU / 20_000.0) - 1.0).abs() < 1e-3, "{step}");
        let exact = infer_step(&sine(0.001, 12), false).unwrap();
        assert!((exact - 0.001).abs() < 1e-8, "{exact}");
    }

    #[test]
    fn whole_counts_have_step_one() {
        let counts: Vec<f64> = sine(0.001, 12).iter().map(|x| (x * 1000.0).round()).collect();
        assert_eq!(infer_step(&counts, false), Some(1.0));
    }

    #[test]
    fn unquantised_constant_and_constant_speed_have_none() {
        assert_eq!(infer_step(&sine(0.0, 15), false), None);
        assert_eq!(infer_step(&[1.0; 100], false), None);
        let ramp: Vec<f64> = (0..1000).map(|k| 0.1 * f64::from(k)).collect();
        assert_eq!(infer_step(&ramp, false), None);
        assert_eq!(infer_step(&[], false), None);
    }

    /// Ramps of 0.13 ± 1 % per refresh, repeated four times: the size of a change is the speed, and no step.
    #[test]
    fn a_held_position_at_one_speed_has_none() {
        let mut x = vec![0.0];
        for k in 0..250 {
            let next = x[x.len() - 1] + 0.13 + 0.001 * f64::from(k).sin();
            x.extend([next; 4]);
        }
        assert_eq!(infer_step(&x, true), None);
    }

    /// A few large changes are whole multiples of the largest one to a tenth, if the many small ones count for nothing.
    #[test]
    fn small_changes_refute_a_large_step() {
        let x: Vec<f64> = (0..3000).map(|k| if k % 50 == 0 { 3.0 } else { 0.001 * f64::from(k % 7) }).collect();
        assert_eq!(infer_step(&x, false), Some(0.001));
    }
}
