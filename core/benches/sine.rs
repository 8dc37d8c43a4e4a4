//! `cargo bench -p breakaway-core --bench sine`: throughput of the streaming sine fit, and its efficiency against the
//! Cramér–Rao bound by Monte Carlo. `-- RUNS` sets the runs per cell (default 300, ±8 % per figure).

use breakaway_core::estimate::sine::{
    BlockSums, FrequencySearch, Sample, SineFit, SineModel, StreamingSine, even, fit_free,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal, Uniform};
use std::f64::consts::{PI, TAU};
use std::hint::black_box;
use std::time::Instant;

fn main() {
    // cargo bench passes flags of its own.
    let runs = std::env::args().filter_map(|argument| argument.parse::<usize>().ok()).next_back().unwrap_or(300);
    throughput();
    efficiency(runs);
}

/// The best of several repetitions over a record that fits the cache.
fn throughput() {
    const LENGTH: usize = 1 << 16;
    println!("Throughput on one core, Msamples/s (best of 40 × {LENGTH} samples)");
    println!("| samples | in slices | one by one |");
    println!("|---|---|---|");
    let wave = |i: usize| (TAU * i as f64 / 97.3).sin();
    measure::<f32>("f32", &(0..LENGTH).map(|i| wave(i) as f32).collect::<Vec<_>>());
    measure::<f64>("f64", &(0..LENGTH).map(wave).collect::<Vec<_>>());
    measure::<i32>("i32", &(0..LENGTH).map(|i| (wave(i) * 1e5) as i32).collect::<Vec<_>>());
    let config = StreamingSine::new(TAU * 10.0, 1e-3).expect("valid");
    let mut sums: BlockSums<f32> = BlockSums::new();
    for i in 0..31_000 {
        config.push(&mut sums, wave(i) as f32);
    }
    let start = Instant::now();
    for _ in 0..200 {
        let _ = black_box(config.fit(black_box(&sums)));
    }
    println!("final solution: {:.0} µs\n", start.elapsed().as_secs_f64() / 200.0 * 1e6);
}

fn measure<S: Sample>(name: &str, samples: &[S]) {
    let config = StreamingSine::new(TAU * 10.0, 1e-3).expect("valid");
    let best = |mut body: Box<dyn FnMut() + '_>| {
        (0..40)
            .map(|_| {
                let start = Instant::now();
                body();
                samples.len() as f64 / start.elapsed().as_secs_f64() * 1e-6
            })
            .fold(0.0, f64::max)
    };
    let mut sums: BlockSums<S> = BlockSums::new();
    let slices = best(Box::new(|| {
        config.push_slice(&mut sums, black_box(samples));
    }));
    let mut sums: BlockSums<S> = BlockSums::new();
    let single = best(Box::new(|| {
        for sample in black_box(samples) {
            config.push(&mut sums, *sample);
        }
    }));
    println!("| {name} | {slices:.0} | {single:.0} |");
}

/// Bound over mean square of A and ω. The bound is the full one of the record's own columns with offset, at the true
/// noise: that of the batch fit's standard errors rescaled.
fn efficiency(runs: usize) {
    println!(
        "Efficiency (Cramér–Rao bound / mean square error) of ω, and of A, by the block phasors in f32;\n\
         {runs} runs per cell, ω0 off by up to ±5 %, random phase; `-n` runs of it refused"
    );
    print!("| cycles | per cycle |");
    let levels = [0.0, 10.0, 20.0, 40.0, 60.0];
    for snr in levels {
        print!(" {snr} dB |");
    }
    println!("\n|---|---|---|---|---|---|---|");
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for cycles in [1, 2, 5, 10, 20] {
        for per_cycle in [10, 100, 1000] {
            print!("| {cycles} | {per_cycle} |");
            for snr in levels {
                print!(" {} |", cell(cycles, per_cycle, snr, runs, &mut rng));
            }
            println!();
        }
    }
}

fn cell(cycles: usize, per_cycle: usize, snr: f64, runs: usize, rng: &mut ChaCha8Rng) -> String {
    let (mut omega_sum, mut amplitude_sum, mut refused) = (0.0, 0.0, 0);
    let sigma = (0.5 * 10.0_f64.powf(-snr / 10.0)).sqrt();
    let noise = Normal::new(0.0, sigma).expect("valid");
    let phases = Uniform::new(-PI, PI).expect("valid");
    let errors = Uniform::new(-0.05, 0.05).expect("valid");
    let ts = 1.0 / per_cycle as f64;
    for _ in 0..runs {
        let phase = phases.sample(rng);
        let clean: Vec<f64> = (0..cycles * per_cycle).map(|i| (TAU * i as f64 * ts + phase).sin()).collect();
        let noisy: Vec<f32> = clean.iter().map(|y| (y + noise.sample(rng)) as f32).collect();
        let config = StreamingSine::new(TAU * (1.0 + errors.sample(rng)), ts).expect("valid");
        let mut sums: BlockSums<f32> = BlockSums::new();
        config.push_slice(&mut sums, &noisy);
        match config.fit(&sums) {
            Ok(fit) => {
                let (amplitude, omega) = bound(&clean, ts);
                omega_sum += ((fit.omega_rad_s - TAU) / (omega * sigma)).powi(2);
                amplitude_sum += ((fit.amplitude - 1.0) / (amplitude * sigma)).powi(2);
            }
            Err(_) => refused += 1,
        }
    }
    let fitted = (runs - refused) as f64;
    let refusals = if refused > 0 { format!(" -{refused}") } else { String::new() };
    format!("{:.2}, {:.2}{refusals}", fitted / omega_sum, fitted / amplitude_sum)
}

/// The bound for unit noise: the batch fit's standard errors over its residual, on the clean record with a disturbance
/// too small to move it.
fn bound(clean: &[f64], ts: f64) -> (f64, f64) {
    let y: Vec<f64> = clean.iter().enumerate().map(|(i, y)| y + if i % 2 == 0 { 1e-7 } else { -1e-7 }).collect();
    let search = FrequencySearch::between(TAU * 0.8, TAU * 1.25);
    let fit: SineFit = fit_free(even(&y, 0.0, ts), search, SineModel::default()).expect("a sine");
    (fit.se.amplitude / fit.rms, fit.se.omega_rad_s / fit.rms)
}
