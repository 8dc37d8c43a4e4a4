//! The reader on damaged files: an error or a recording that keeps its promises, never a panic.
//!
//! `BREAKAWAY_FUZZ_ITERATIONS` sets the number of files (`cargo xtask fuzz` runs more).

use breakaway::recording::{ReadOptions, Recording, RecordingError, Signal};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

const ITERATIONS: u64 = 20_000;

const SEEDS: [&str; 4] = [
    "# tick: 0.001 s\n# units: u=V, x=rad\n# encoder step: 1e-3 rad\n# gaps: 4\nt,u,x\n0,1,0\n1,1,1\n2,-1,2\n3,1,4\n4,1,5\n5,-1,6\n6,1,7\n7,1,9\n8,1,8\n9,1,7\n",
    "t;u;x;on\r\n0;1;0;1\r\n1;1;1;1\r\n2;-1;2;0\r\n3;1;4;1\r\n4;1;5;1\r\n5;-1;6;1\r\n6;1;7;1\r\n7;1;9;1\r\n8;1;8;1\r\n",
    "\u{feff}t,u,x,\"a \"\"note\"\"\"\n0.5,1,0,\"x\ny\"\n1.5,1,1,\n2.5,-1,2,\n3.5,1,4,\n4.5,1,5,\n5.5,-1,6,\n6.5,1,7,\n7.5,1,9,\n8.5,1,8,\n",
    "# remark\n\nu\tx\tt\n1\t0\t0\n1\t1\t1e-3\n-1\t2\t2e-3\n1\t4\t3e-3\n1\t5\t4e-3\n-1\t6\t5e-3\n1\t7\t6e-3\n1\t9\t7e-3\n",
];

const PIECES: [&[u8]; 24] = [
    b"NaN",
    b"inf",
    b"-inf",
    b"\"",
    b"\"\"",
    b",",
    b"\n",
    b"\r",
    b"\r\n",
    b"1e308",
    b"-1e308",
    b"1e-320",
    b"1e999",
    b"999999999999999999999999",
    b"\xff\xfe",
    b"\xc3",
    b"\0",
    b"#",
    b"# gaps: 18446744073709551615\n",
    b"# tick: 1e-320\n",
    b"# encoder step: 1e308\n",
    b"# units: =\n",
    b";",
    b"-0.0",
];

fn below(rng: &mut ChaCha8Rng, limit: usize) -> usize {
    (rng.next_u64() % limit.max(1) as u64) as usize
}

fn mutate(rng: &mut ChaCha8Rng) -> Vec<u8> {
    let mut bytes = SEEDS[below(rng, SEEDS.len())].as_bytes().to_vec();
    for _ in 0..=below(rng, 6) {
        let at = below(rng, bytes.len() + 1);
        match below(rng, 6) {
            0 => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << below(rng, 8);
                }
            }
            1 => bytes.truncate(at),
            2 | 3 => {
                let piece = PIECES[below(rng, PIECES.len())];
                bytes.splice(at..at, piece.iter().copied());
            }
            4 => {
                let end = (at + below(rng, 12)).min(bytes.len());
                bytes.drain(at..end);
            }
            _ => {
                let end = (at + below(rng, 40)).min(bytes.len());
                let copy = bytes[at..end].to_vec();
                bytes.splice(at..at, copy);
            }
        }
    }
    bytes
}

/// What every reader of a [`Recording`] may rely on.
fn check(recording: &Recording) {
    let Recording { t, u, x, gaps, .. } = recording;
    assert!(t.len() >= 8 && t.len() == u.len() && t.len() == x.len());
    assert!(t.windows(2).all(|w| w[0] < w[1]));
    assert!([t, u, x].into_iter().flatten().all(|v| v.is_finite()));
    assert!(gaps.windows(2).all(|w| w[0] < w[1]) && gaps.iter().all(|&k| 0 < k && k < t.len()));
    assert!(recording.encoder_step.is_none_or(|step| step.is_finite() && step > 0.0));
    let _ = (recording.timing(), recording.warnings());
    assert!(recording.segments().iter().all(|s| s.t.len() >= 2 && s.t.len() == s.x.len()));
    let mut bytes = Vec::new();
    recording.write_to(&mut bytes).unwrap();
    Recording::read_from("again.csv", bytes.as_slice(), &ReadOptions::default()).unwrap();
}

#[test]
fn a_damaged_file_never_makes_the_reader_panic() {
    let iterations = std::env::var("BREAKAWAY_FUZZ_ITERATIONS")
        .map_or(ITERATIONS, |n| n.parse().expect("BREAKAWAY_FUZZ_ITERATIONS is a number"));
    let options = [
        ReadOptions::default(),
        ReadOptions { fs_hz: Some(1e3), ..ReadOptions::default() },
        ReadOptions { select: vec!["on=1".parse().unwrap()], ..ReadOptions::default() },
    ];
    let (mut good, mut bad) = (0_u64, 0_u64);
    for iteration in 0..iterations {
        let mut rng = ChaCha8Rng::seed_from_u64(iteration);
        let bytes = mutate(&mut rng);
        let outcome = std::panic::catch_unwind(|| {
            let mut any = false;
            for options in &options {
                match Recording::read_from("fuzz.csv", bytes.as_slice(), options) {
                    Ok(recording) => {
                        check(&recording);
                        any = true;
                    }
                    Err(RecordingError::Read { .. } | RecordingError::Write { .. }) => {
                        panic!("an error of the system from bytes in memory")
                    }
                    Err(error) => assert!(!error.to_string().is_empty()),
                }
                let signal = Signal::read_from("fuzz.csv", bytes.as_slice(), Some("u"), options);
                if let Ok(signal) = signal {
                    // An answer or a refusal; what the fit says of eight damaged rows does not matter.
                    let _ = breakaway::sine::fit(&signal, f64::NEG_INFINITY..=f64::INFINITY, None);
                }
            }
            any
        });
        match outcome {
            Ok(true) => good += 1,
            Ok(false) => bad += 1,
            Err(payload) => panic!(
                "iteration {iteration}: {:?}: {:?}",
                payload.downcast_ref::<String>(),
                String::from_utf8_lossy(&bytes)
            ),
        }
    }
    // The damage must be such that both happen often, or the test tests nothing.
    assert!(10 * good > iterations && 10 * bad > iterations, "{good} good, {bad} bad");
}
