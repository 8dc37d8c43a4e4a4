//! Bytes of a link, in both directions: no panic, no more frames than zeros, and what is read is what would be written.

use breakaway::device::stream::Stream;
use breakaway_core::link::{Decoder, MAX_FRAME, Message, Request, encode, peer_version};
use serde::Serialize;

/// Takes the bytes as a stream of frames; and, from the first on, as one message without its frame.
pub fn run(bytes: &[u8]) -> bool {
    let mut decoder = Decoder::new();
    let mut stream = Stream::default();
    let mut rows = Vec::new();
    let (mut frames, mut accepted) = (0, false);
    for byte in bytes {
        let Some(received) = decoder.push(*byte) else { continue };
        frames += 1;
        if let Ok(message) = received {
            accepted |= judge(message, &mut stream, &mut rows);
        }
    }
    assert!(frames < bytes.split(|byte| *byte == 0).count());
    assert_eq!(decoder.good_frames() + decoder.bad_frames(), frames as u32);
    accepted | judge(bytes, &mut stream, &mut rows)
}

fn judge(bytes: &[u8], stream: &mut Stream, rows: &mut Vec<breakaway::device::stream::Row>) -> bool {
    let _ = peer_version(bytes);
    let request = Request::decode(bytes);
    if let Ok(request) = &request {
        let _ = request.command.validate();
        same(request, |bytes| Request::decode(bytes).ok());
    }
    let message = Message::decode(bytes);
    if let Some(message) = &message {
        same(message, Message::decode);
        if let Message::Samples(batch) = message {
            let before = rows.len();
            if stream.take(batch, rows).is_ok() {
                assert_eq!(rows.len() - before, batch.samples().map_while(Result::ok).count());
            }
            assert!(rows.windows(2).all(|pair| pair[0].tick < pair[1].tick));
        }
    }
    request.is_ok() || message.is_some()
}

/// What was read, sent on and read again is the same. Bytes are compared: a NaN is not equal to itself.
fn same<T: Serialize>(value: &T, decode: impl Fn(&[u8]) -> Option<T>) {
    let mut frame = [0; MAX_FRAME];
    // Bytes that are longer than a message can decode to one that is.
    let Ok(used) = encode(value, &mut frame) else { return };
    let mut decoder = Decoder::new();
    let mut again = None;
    for byte in &frame[..used] {
        if let Some(message) = decoder.push(*byte) {
            assert!(again.is_none(), "two frames of one message");
            again = Some(decode(message.unwrap()).unwrap());
        }
    }
    let mut second = [0; MAX_FRAME];
    assert_eq!(encode(&again.unwrap(), &mut second), Ok(used));
    assert_eq!(frame, second);
}
