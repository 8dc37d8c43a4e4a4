//! The watch over the model's validity while a trajectory is followed.
//!
//! It runs on the samples here in the thread, outside the tick. Each run sets it anew. The first stroke and a half of
//! either direction show what the model leaves out along this reference. Later ones are compared with them
//! ([`breakaway_core::control::DriftWatch`]).

use breakaway_core::control::{DriftSettings, DriftState, DriftWatch, ModelMismatch, Motion};
use breakaway_core::link::{FULL_SCALE_CODE, Mismatch, Mode, Model, Sample, Settings, Track};
use breakaway_core::plant::{Base, Effect, MAX_EFFECTS};

use super::plan::path;

/// Bins of speed.
const SPEED_BINS: f32 = 16.0;

/// The watch over the run under way, if there is one that it can watch.
pub(super) struct Drift {
    active: Option<Active>,
}

struct Active {
    watch: DriftWatch<f32>,
    state: DriftState<f32>,
    position_per_count: f32,
    drive_per_code: f32,
    bins_per_speed: f32,
    last: Option<(u32, i16)>,
}

impl Drift {
    pub(super) const fn new() -> Self {
        Self { active: None }
    }

    /// A run has started. One that cannot be watched is not: a reference at rest, a motion too slow for the encoder.
    #[inline(never)]
    pub(super) fn start(&mut self, track: &Track, model: Option<&Model>, settings: &Settings, tick_hz: u32) {
        self.active = model.and_then(|model| Active::new(track, model, settings, tick_hz));
    }

    /// Takes a sample, of any mode.
    pub(super) fn push(&mut self, sample: &Sample) -> Option<Mismatch> {
        let active = self.active.as_mut().filter(|_| sample.mode == Mode::Track)?;
        active.push(sample)
    }

    /// The run is over.
    pub(super) fn ended(&mut self) {
        self.active = None;
    }
}

impl Active {
    fn new(track: &Track, model: &Model, settings: &Settings, tick_hz: u32) -> Option<Self> {
        let base: Base<f32> = model.base().ok()?;
        let mut effects: heapless::Vec<Effect<f32>, MAX_EFFECTS> = heapless::Vec::new();
        for index in 0..model.effects.len() {
            effects.push(model.effect(index)?.ok()?).ok()?;
        }
        let tick_s = 1.0 / tick_hz.max(1) as f32;
        let (_, speed, acceleration) = path::<f32>(&track.trajectory, tick_hz).ok()?;
        let motion = Motion { speed, acceleration, encoder_step: settings.position_per_count };
        let usual = DriftSettings::along(&motion, &base, tick_s).ok()?;
        let smallest_scale = usual.smallest_scale.max(1e-4 * settings.drive_full_scale);
        let usual = DriftSettings { smallest_scale, ..usual };
        Some(Self {
            watch: DriftWatch::new(&base, &effects, &usual, tick_s).ok()?,
            state: DriftState::default(),
            position_per_count: settings.position_per_count,
            drive_per_code: settings.drive_full_scale / f32::from(FULL_SCALE_CODE),
            bins_per_speed: SPEED_BINS / speed,
            last: None,
        })
    }

    #[inline(never)]
    fn push(&mut self, sample: &Sample) -> Option<Mismatch> {
        let last = self.last.replace((sample.tick, sample.drive_code));
        let code = match last {
            Some((tick, code)) if sample.tick.wrapping_sub(tick) == 1 => code,
            // Nothing is known of what was driven meanwhile.
            Some(_) | None => {
                self.state.interrupt();
                0
            }
        };
        let (u, x) = (f32::from(code) * self.drive_per_code, sample.count as f32 * self.position_per_count);
        let ModelMismatch { speed_sign, bin, score, .. } = self.watch.tick(&mut self.state, u, x)?;
        let speed_bin = (self.state.velocity().abs() * self.bins_per_speed).min(SPEED_BINS - 1.0) as u8;
        // Counted along the motion: below 0 the axis moves harder than the model says.
        let score = score * f32::from(speed_sign);
        Some(Mismatch { direction: speed_sign, speed_bin, position_bin: bin as u8, score })
    }
}
