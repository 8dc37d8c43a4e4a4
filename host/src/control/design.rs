//! A controller from a model: gains, compensator, starting values of the adaptive law.

use breakaway_core::control::{
    Adaptation, Adaptive, Compensator, Controller, Estimates, Fast, Gains, Margins, Pid, Resolution,
    encoder_bandwidth_hz, largest_bandwidth_hz, lead_s, least_delta, margins, tune_behind,
};
use breakaway_core::plant::{Base, Effect};

use super::ControlError;
use crate::model::Model;

/// What a controller is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// Control tick, s.
    pub tick_s: f64,
    /// Ticks from reading a position to applying the drive computed from it.
    pub delay_ticks: u32,
    /// Open-loop crossover, Hz; by default [`DEFAULT_SHARE`] of the largest, and no more than the encoder bears.
    pub bandwidth_hz: Option<f64>,
    /// Largest |drive|; infinite for none.
    pub drive_limit: f64,
    /// Encoder step, X; 0 where it is not known.
    pub encoder_step: f64,
    /// Largest speed of the references, X/s; by default that of [`usual_motion`].
    pub speed: Option<f64>,
    /// Largest acceleration of the references, X/s²; by default that of [`usual_motion`].
    pub acceleration: Option<f64>,
    /// How fast the adaptive law adapts, rad/s.
    pub adaptation_rate: f64,
}

/// The default bandwidth over the largest that tick and delay allow: room for a model that is a factor of two off.
pub const DEFAULT_SHARE: f64 = 0.25;

/// Less than this share of the largest is no bandwidth to control with: such an encoder's step is wrong, or in another unit.
const LEAST_SHARE: f64 = 1e-3;

/// How fast the adaptive law adapts by default, rad/s: a change of friction is learnt in a minute or two.
pub const DEFAULT_ADAPTATION_RATE: f64 = 5.0;

/// Share of the other rates with which b̂ adapts. Noise of ė makes b̂ rise (−u_c·s_Δ holds Kv·s·s_Δ), and heat and
/// wear do not change the inertia.
const RATE_OF_B: f64 = 0.1;

/// The motion in which inertia and damping each need as much drive as Coulomb friction. Its speed is f1/c, at most
/// what f1 gives the inertia in a second; its acceleration is f1/b. Without friction 10 X/s and 100 X/s².
pub fn usual_motion(base: &Base<f64>) -> (f64, f64) {
    let Base { b, c, f1 } = *base;
    if f1 > 0.0 { ((f1 / c).min(f1 / b), f1 / b) } else { (10.0, 100.0) }
}

/// What one count may make of the drive: twice what the expected motion needs, within these shares of the drive's
/// limit. Counts come one after the other, not at once. The rms of the drive that they make is then about a seventh
/// of that. It adds less than a tenth to the drive's rms (docs/control.md, section "The encoder").
const DRIVE_OF_COUNT: f64 = 2.0;
/// Least and most of the drive's limit: what is less is no harm, whatever the friction; what is more would saturate.
const SHARE_OF_LIMIT: [f64; 2] = [0.125, 0.5];

impl Request {
    /// The largest speed and acceleration that are expected on this plant.
    fn motion(&self, base: &Base<f64>) -> (f64, f64) {
        let (speed, acceleration) = usual_motion(base);
        (self.speed.unwrap_or(speed), self.acceleration.unwrap_or(acceleration))
    }

    /// The encoder, and the most that one count of it may make of the drive.
    pub fn resolution(&self, base: &Base<f64>) -> Resolution {
        let (speed, acceleration) = self.motion(base);
        let drive = DRIVE_OF_COUNT * (base.b * acceleration + base.c * speed + base.f1);
        let [least, most] = SHARE_OF_LIMIT.map(|share| share * self.drive_limit);
        let drive = if most.is_finite() { drive.clamp(least, most) } else { drive };
        Resolution { step: self.encoder_step, drive }
    }

    /// A quarter of what tick and delay allow, and no more than the encoder bears, Hz.
    fn default_bandwidth_hz(&self, base: &Base<f64>) -> Result<f64, ControlError> {
        let largest = largest_bandwidth_hz(base.b, base.c, self.tick_s, self.delay_ticks);
        let for_encoder = self.encoder_bandwidth_hz(base);
        if for_encoder < LEAST_SHARE * largest {
            return Err(ControlError::Encoder { step: self.encoder_step, bandwidth_hz: for_encoder });
        }
        Ok((DEFAULT_SHARE * largest).min(for_encoder))
    }

    /// The largest bandwidth that the encoder bears, Hz.
    pub fn encoder_bandwidth_hz(&self, base: &Base<f64>) -> f64 {
        encoder_bandwidth_hz(base.b, base.c, self.tick_s, self.delay_ticks, &self.resolution(base))
    }
}

/// A controller, all of it: what `breakaway tune` writes.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    /// Control tick, s.
    pub tick_s: f64,
    /// Ticks of delay.
    pub delay_ticks: u32,
    /// Largest |drive|.
    pub drive_limit: f64,
    /// Error within which the PID's integral rests at standstill, X.
    pub rest_band: f64,
    /// Gains of the PID and of the adaptive law.
    pub gains: Gains,
    /// How far ahead the compensator looks, s.
    pub lead_s: f64,
    /// Speed up to which a reference counts as resting, X/s.
    pub rest_speed: f64,
    /// Whether the compensator is on.
    pub compensate: bool,
    /// Start of the adaptive law.
    pub start: Estimates<f64>,
    /// Its gains.
    pub adaptation: Adaptation,
    /// Whether the adaptive law is used in place of the PID.
    pub adaptive: bool,
    /// The model behind it.
    pub model: Model,
}

impl Design {
    /// Tunes a controller for a model. The compensator is off until it is switched on.
    ///
    /// # Errors
    /// A bandwidth or an adaptation rate past what tick and delay allow, with the largest that is not.
    pub fn new(model: &Model, request: &Request) -> Result<Self, ControlError> {
        let Base { b, c, f1 } = model.base;
        let Request { tick_s, delay_ticks, drive_limit, encoder_step, .. } = *request;
        let (speed, acceleration) = request.motion(&model.base);
        let bandwidth_hz = match request.bandwidth_hz {
            Some(bandwidth_hz) => bandwidth_hz,
            None => request.default_bandwidth_hz(&model.base)?,
        };
        let encoder = request.resolution(&model.base);
        let gains = tune_behind(b, c, bandwidth_hz, tick_s, delay_ticks, &encoder)?;
        let start = Estimates { b, c, f1, f: 0.0 };
        let delta = least_delta(encoder_step, &gains, tick_s).max(1e-3 * speed).max(1e-12);
        let adaptation = Adaptation::normalised(&start, request.adaptation_rate, speed, acceleration, delta);
        let slow = Estimates { b: adaptation.gains.b * RATE_OF_B * RATE_OF_B, ..adaptation.gains };
        let design = Self {
            tick_s,
            delay_ticks,
            drive_limit,
            rest_band: encoder_step,
            gains,
            lead_s: lead_s(tick_s, delay_ticks),
            rest_speed: 0.0,
            compensate: false,
            start,
            adaptation: Adaptation { gains: slow, ..adaptation },
            adaptive: false,
            model: model.clone(),
        };
        // Both laws are checked, as the file holds both.
        design.controller::<f64>()?;
        Self { adaptive: true, ..design.clone() }.controller::<f64>()?;
        Ok(design)
    }

    /// The margins of the loop; `None` if it never crosses unit gain.
    pub fn margins(&self) -> Option<Margins> {
        let Base { b, c, .. } = self.model.base;
        margins(&self.gains, b, c, self.tick_s, self.delay_ticks)
    }

    /// The largest bandwidth that tick and delay allow, Hz.
    pub fn largest_bandwidth_hz(&self) -> f64 {
        let Base { b, c, .. } = self.model.base;
        largest_bandwidth_hz(b, c, self.tick_s, self.delay_ticks)
    }

    /// The controller as a tick takes it.
    ///
    /// # Errors
    /// What the core refuses.
    pub fn controller<R: Fast>(&self) -> Result<Controller<R>, ControlError> {
        let effects = self.model.plant_effects().map_err(|error| ControlError::Tuning(error.to_string()))?;
        self.controller_for(&self.model.base, &effects)
    }

    /// The same law beside the compensator of another model.
    ///
    /// # Errors
    /// What the core refuses.
    pub fn controller_for<R: Fast>(
        &self,
        base: &Base<f64>,
        effects: &[Effect<f64>],
    ) -> Result<Controller<R>, ControlError> {
        let law = if self.adaptive {
            let law = Adaptive::new(
                &self.gains,
                &self.adaptation,
                &self.start,
                self.tick_s,
                self.delay_ticks,
                self.drive_limit,
            )?;
            Controller::adaptive(law)
        } else {
            let pid = Pid::with_delay(&self.gains, self.tick_s, self.delay_ticks, self.drive_limit)?;
            Controller::pid(pid.with_rest_band(self.rest_band))
        };
        let compensator = Compensator::new(base, effects)?.with_lead(self.lead_s)?.with_rest_speed(self.rest_speed);
        Ok(law.with_compensator(if self.compensate { compensator.on() } else { compensator }))
    }
}
