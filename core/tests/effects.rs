//! Laws that hold for every effect of the catalogue.

use breakaway_core::plant::effect::{ActsIn, Held, Instant};
use breakaway_core::plant::{Base, Effect, Kind};

const BASE: Base<f64> = Base { b: 0.02685, c: 0.11, f1: 0.5 };
const H: f64 = 1e-3;

/// An effect has influence only through the hooks of the place where it says that it acts: the plant calls no others, so one
/// written for another place would be without effect and unnoticed. Exactly no influence is asked for, over motions of both
/// directions, at rest, and with a memory that has been moved.
#[test]
fn hooks_stand_where_the_effect_acts() {
    for &kind in Kind::ALL {
        let parameters: Vec<f64> = kind.definition().parameters.iter().map(|p| 0.3f64.clamp(p.min, p.max)).collect();
        let effect = Effect::new(kind, &parameters);
        let place = kind.acts_in();
        for (x, v, u) in [(0.4, 1.3, 0.9), (-2.0, -0.7, -1.1), (0.1, 0.0, 0.2), (3.0, 40.0, 5.0)] {
            let at = Instant { t: 2.5, x, v, u, over_s: H };
            let moved = [0.01, -0.02, 0.03];
            let mut memory = moved;
            let past = Held { u: &[0.3, -0.4, u], ts: H, from_s: 0.0 };
            if place != ActsIn::Drive {
                assert_eq!(effect.drive(&at, past, &mut memory, H), u, "{}", kind.name());
            }
            if place != ActsIn::Force {
                let forces = [effect.force(&at), effect.level(&BASE, &at), effect.breakaway()];
                assert_eq!(forces, [0.0; 3], "{}", kind.name());
            }
            if place != ActsIn::Mechanics {
                let (mut x_end, mut v_end) = (x, v);
                effect.impact(&mut x_end, &mut v_end, &mut memory, H);
                assert_eq!((x_end, v_end), (x, v), "{}", kind.name());
                let reactions = [effect.mechanics(&BASE, &at, &mut memory, H), effect.bristle(0.5, v, &mut memory, H)];
                assert_eq!(reactions, [0.0; 2], "{}", kind.name());
            }
            if place != ActsIn::Sensor {
                assert_eq!(effect.sensor(x), 0.0, "{}", kind.name());
            }
            if matches!(place, ActsIn::Sensor | ActsIn::Force) {
                assert_eq!(memory, moved, "{}", kind.name());
            }
        }
    }
}
