//! The noise against the decoder, and the cable between two pseudo-terminals.

use breakaway_core::link::{Decoder, MAX_FRAME, encode};

use super::*;

/// Every frame that was not hit arrives, and nothing that was not sent.
#[test]
fn what_is_not_hit_arrives() {
    for ppm in [0, 100, 2_000, 50_000] {
        let (mut noise, mut decoder) = (Noise::new(u64::from(ppm)), Decoder::new());
        let (mut arrived, mut bytes) = (Vec::new(), Vec::new());
        for number in 0..20_000_u32 {
            let mut frame = [0; MAX_FRAME];
            let used = encode(&(number, [7_u8; 20]), &mut frame).unwrap();
            bytes.clear();
            noise.transmit(&frame[..used], ppm, &mut bytes);
            for &byte in &bytes {
                if let Some(Ok(message)) = decoder.push(byte) {
                    let (number, _): (u32, [u8; 20]) = postcard::from_bytes(message).unwrap();
                    arrived.push(number);
                }
            }
        }
        let counts = noise.counts;
        assert_eq!(counts.frames, 20_000);
        let lost = counts.frames - arrived.len() as u64;
        assert!(lost <= counts.hit && arrived.is_sorted(), "{lost} lost, {counts:?}");
        // A hit frame survives where the garbage before it ends in a zero, or held nothing else: rarely.
        assert!(lost * 10 >= counts.hit * 8, "{lost} lost, {counts:?}");
        let hits = counts.flipped + counts.dropped + counts.inserted;
        let expected = counts.bytes as f64 * f64::from(ppm) * 1e-6;
        assert!((hits as f64 - expected).abs() <= 5.0 * expected.sqrt(), "{hits} hits where {expected} were to be");
    }
}

fn read_some(from: &mut File, length: usize) -> Vec<u8> {
    let mut got = Vec::new();
    let end = std::time::Instant::now() + Duration::from_secs(10);
    while got.len() < length && std::time::Instant::now() < end {
        let mut bytes = [0; 256];
        match from.read(&mut bytes) {
            Ok(count) => got.extend(&bytes[..count]),
            Err(_) => std::thread::sleep(Duration::from_millis(1)),
        }
    }
    got
}

fn open(port: &str) -> File {
    let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
    rustix::fs::open(port, flags, Mode::empty()).unwrap().into()
}

#[test]
fn a_cable_is_whole_cut_and_whole_again() {
    let (qemu, board) = pseudo_terminal().unwrap();
    let mut qemu = File::from(qemu);
    let relay = Relay::start(&board, 1).unwrap();
    let mut host = open(&relay.port);
    for round in 0..2_u8 {
        host.write_all(&[1, 2, round]).unwrap();
        assert_eq!(read_some(&mut qemu, 3), [1, 2, round]);
        qemu.write_all(&[3, 0, 4, round]).unwrap();
        assert_eq!(read_some(&mut host, 4), [3, 0, 4, round]);
        relay.cut(true);
        // What was on its way before has long arrived.
        host.write_all(b"lost").unwrap();
        qemu.write_all(b"lost").unwrap();
        let until = relay.handle();
        let sent = |traffic: Traffic| (traffic.to_board.bytes, traffic.from_board.bytes);
        let all = (7 * (u64::from(round) + 1), 8 * (u64::from(round) + 1));
        while sent(until.traffic()) != all {
            std::thread::sleep(Duration::from_millis(1));
        }
        relay.cut(false);
    }
    // Nobody at the port: what is sent meanwhile is lost, what comes later is not.
    drop(host);
    std::thread::sleep(Duration::from_millis(50));
    qemu.write_all(b"nobody").unwrap();
    while relay.handle().traffic().from_board.bytes < 22 {
        std::thread::sleep(Duration::from_millis(1));
    }
    let mut host = open(&relay.port);
    qemu.write_all(b"back").unwrap();
    assert_eq!(read_some(&mut host, 4), b"back");
}
