//! The ranges from which an unkind world is drawn.

use super::{Encoder, Item, Jitter, Sag, Torque, World};
use crate::machine::{log_uniform, stream};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// First of the random streams of the items.
const FIRST_STREAM: u64 = 64;

/// The item's own random numbers.
fn numbers(seed: u64, item: Item) -> ChaCha8Rng {
    stream(seed, FIRST_STREAM + item.index() as u64)
}

/// Whether the item is in the world of that seed where all are asked for: what only some machines have, in every second.
pub fn is_present(seed: u64, item: Item) -> bool {
    match item {
        Item::Torque | Item::Jitter | Item::Rate | Item::Counts | Item::Zero => true,
        // From the item's second half of streams, so that its values are the same whether it was asked for by name or not.
        Item::Held | Item::Closed | Item::Delay | Item::Sag => {
            stream(seed, 2 * FIRST_STREAM + item.index() as u64).random_bool(0.5)
        }
    }
}

impl World {
    /// The kind world with these items.
    pub(crate) fn drawn(seed: u64, items: impl Iterator<Item = Item>) -> Self {
        let mut world = Self::default();
        let mut held = None;
        for item in items {
            let rng = &mut numbers(seed, item);
            match item {
                Item::Torque => {
                    world.torque = Some(Torque {
                        rms_percent: log_uniform(rng, 0.02, 1.0),
                        bandwidth_hz: log_uniform(rng, 5.0, 200.0),
                    });
                }
                Item::Jitter => {
                    world.jitter =
                        Some(Jitter { share: rng.random_range(0.02..=0.2), true_stamps: rng.random_bool(0.5) });
                }
                Item::Held => held = Some(rng.random_range(0.0..=1.0)),
                // Whole microseconds, as a timer would have it.
                Item::Rate => world.tick_s = (1e6 / log_uniform(rng, 100.0, 10_000.0)).round() / 1e6,
                Item::Counts => {
                    world.encoder = Some(Encoder {
                        counts: log_uniform(rng, 500.0, 65_536.0).round() as u32,
                        noise_steps: log_uniform(rng, 0.02, 0.5),
                    });
                }
                Item::Closed => world.closed = true,
                Item::Zero => world.zero = true,
                Item::Delay => world.sensor_delay_s = log_uniform(rng, 0.5e-3, 8e-3),
                Item::Sag => {
                    world.sag =
                        Some(Sag { share: log_uniform(rng, 0.005, 0.04), time_s: log_uniform(rng, 2e-3, 50e-3) });
                }
            }
        }
        // A sensor that is read twice a tick holds nothing.
        let least = (2.0 * world.tick_s).clamp(1e-3, 20e-3);
        world.held_s = held.map(|share: f64| least * (20e-3 / least).powf(share));
        world
    }
}
