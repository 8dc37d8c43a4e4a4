//! The decoder takes anything.

use breakaway_core::link::*;
use proptest::prelude::*;

use crate::examples;

type Received = Vec<Result<Vec<u8>, FrameError>>;

fn receive(decoder: &mut Decoder, bytes: &[u8]) -> Received {
    bytes.iter().filter_map(|byte| decoder.push(*byte).map(|frame| frame.map(<[u8]>::to_vec))).collect()
}

fn frame(message: &Message) -> Vec<u8> {
    let mut frame = [0; MAX_FRAME];
    let used = encode(message, &mut frame).unwrap();
    frame[..used].to_vec()
}

fn messages() -> Vec<Message> {
    examples::messages().into_iter().map(|(_, message)| message).collect()
}

#[test]
fn zeros_between_frames_are_nothing() {
    let mut decoder = Decoder::new();
    assert_eq!(receive(&mut decoder, &[0, 0, 0]), []);
    assert_eq!((decoder.good_frames(), decoder.bad_frames()), (0, 0));
}

#[test]
fn a_frame_that_is_too_long_is_dropped_whole_and_the_next_one_is_read() {
    let mut decoder = Decoder::new();
    let mut bytes = vec![1; 10 * MAX_FRAME];
    bytes.push(0);
    let message = Message::Event(Event::Started);
    bytes.extend(frame(&message));
    let received = receive(&mut decoder, &bytes);
    assert_eq!(received.len(), 2);
    assert_eq!(received[0], Err(FrameError::TooLong));
    assert_eq!(Message::decode(received[1].as_ref().unwrap()), Some(message));
    assert_eq!((decoder.good_frames(), decoder.bad_frames()), (1, 1));
}

#[test]
fn each_kind_of_damage_has_its_name() {
    let mut decoder = Decoder::new();
    // COBS that points past its end; a block shorter than a CRC; a CRC that does not match.
    assert_eq!(receive(&mut decoder, &[9, 1, 0]), [Err(FrameError::Damaged)]);
    assert_eq!(receive(&mut decoder, &[3, 1, 2, 0]), [Err(FrameError::Damaged)]);
    assert_eq!(receive(&mut decoder, &[6, 1, 2, 3, 4, 5, 0]), [Err(FrameError::Crc)]);
    assert_eq!(decoder.bad_frames(), 3);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 4 } else { 2000 }))]

    /// Arbitrary bytes: no panic, and no more frames than zeros.
    #[test]
    fn arbitrary_bytes(bytes in prop::collection::vec(any::<u8>(), 0..3 * MAX_FRAME)) {
        let mut decoder = Decoder::new();
        let received = receive(&mut decoder, &bytes);
        prop_assert!(received.len() < bytes.split(|b| *b == 0).count());
        for message in received.into_iter().flatten() {
            let _ = Message::decode(&message);
            let _ = Request::decode(&message);
        }
    }

    /// Arbitrary bytes without the frame around them: no panic in the messages either.
    #[test]
    fn arbitrary_messages(bytes in prop::collection::vec(any::<u8>(), 0..MAX_MESSAGE)) {
        let _ = peer_version(&bytes);
        if let Ok(request) = Request::decode(&bytes) {
            let _ = request.command.validate();
        }
        if let Some(Message::Samples(batch)) = Message::decode(&bytes) {
            let _ = batch.samples().count();
        }
    }

    /// However the stream is cut into reads, the same messages come out.
    #[test]
    fn splits_do_not_matter(order in prop::collection::vec(any::<prop::sample::Index>(), 1..8), cuts: prop::sample::Index) {
        let all = messages();
        let chosen: Vec<Message> = order.iter().map(|i| i.get(&all).clone()).collect();
        let bytes: Vec<u8> = chosen.iter().flat_map(frame).collect();
        let (head, tail) = bytes.split_at(cuts.index(bytes.len()));
        let mut decoder = Decoder::new();
        let mut received = receive(&mut decoder, head);
        received.extend(receive(&mut decoder, tail));
        let decoded: Vec<Message> = received.iter().map(|m| Message::decode(m.as_ref().unwrap()).unwrap()).collect();
        prop_assert_eq!(decoded, chosen);
        prop_assert_eq!(decoder.bad_frames(), 0);
    }

    /// Damage of bytes costs at most the frames it hits, and the one after where it hits the zero between them.
    #[test]
    fn damage_costs_only_the_frames_it_hits(
        count in 3usize..8,
        at in any::<prop::sample::Index>(),
        change in 1u8..,
        drop: bool,
    ) {
        let message = messages().pop().unwrap();
        let one = frame(&message);
        let mut bytes: Vec<u8> = std::iter::repeat_n(one.clone(), count).flatten().collect();
        let at = at.index(bytes.len());
        if drop {
            bytes.remove(at);
        } else {
            bytes[at] ^= change;
        }
        let mut decoder = Decoder::new();
        let received = receive(&mut decoder, &bytes);
        let good = received.iter().flatten().filter(|m| Message::decode(m) == Some(message.clone())).count();
        // A damaged zero joins two frames; at the very end there is no frame after it.
        prop_assert!(good + 2 >= count, "{good} of {count}");
        prop_assert!(good < count);
        // Nothing is read that was not sent: CRC-32 finds every burst of up to 32 bits.
        prop_assert_eq!(received.iter().flatten().count(), good);
    }
}
