//! Damaged copies of inputs, for the bounded test: what a coverage-guided fuzzer does, without its feedback.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// What breaks parsers of text and of numbers.
const PIECES: [&[u8]; 36] = [
    b"nan",
    b"inf",
    b"-inf",
    b"1e308",
    b"-1e308",
    b"1e-320",
    b"1e999",
    b"99999999999999999999",
    b"0x1F",
    b"0",
    b"-0.0",
    b"-1",
    b"\"",
    b"'''",
    b"\"\"",
    b"[",
    b"]",
    b"[[",
    b"{",
    b"}",
    b"=",
    b",",
    b";",
    b"\n",
    b"\r\n",
    b"#",
    b"\xff\xfe",
    b"\xc3",
    b"\0",
    b"\xff\xff\xff\xff\x0f",
    b"# gaps: 18446744073709551615\n",
    b"# tick: 1e-320\n",
    b"# encoder step: 1e308\n",
    b"# units: =\n",
    b"[base]\n",
    b"1979-05-27",
];

fn below(rng: &mut ChaCha8Rng, limit: usize) -> usize {
    (rng.next_u64() % limit.max(1) as u64) as usize
}

/// The copy of number `number`: one of `seeds`, damaged in one to four places; at most `most_bytes` long.
pub fn damaged(seeds: &[Vec<u8>], number: u64, most_bytes: usize) -> Vec<u8> {
    let rng = &mut ChaCha8Rng::seed_from_u64(number);
    let mut bytes = seeds[below(rng, seeds.len())].clone();
    for _ in 0..=below(rng, 3) {
        let at = below(rng, bytes.len() + 1);
        let end = (at + below(rng, 24)).min(bytes.len());
        match below(rng, 7) {
            0 => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << below(rng, 8);
                }
            }
            1 => bytes.truncate(at.max(end)),
            2 | 3 => drop(bytes.splice(at..at, PIECES[below(rng, PIECES.len())].iter().copied())),
            4 => drop(bytes.drain(at..end)),
            // A digit for another keeps a text valid and changes what it says.
            5 => {
                for byte in bytes.iter_mut().filter(|byte| byte.is_ascii_digit()) {
                    if below(rng, 8) == 0 {
                        *byte = b'0' + below(rng, 10) as u8;
                    }
                }
            }
            _ => {
                let copy = bytes[at..end].to_vec();
                drop(bytes.splice(at..at, copy));
            }
        }
    }
    bytes.truncate(most_bytes);
    bytes
}
