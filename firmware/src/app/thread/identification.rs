//! On-board identification: from the samples of relay experiments to (b, c, f1) with standard errors.
//!
//! The first whole cycle tells the period T. From then on the weak form over windows of 2T sums in f32, here in the
//! thread. Once the period is steady, the tick sums the sine fit in integers. [`Identification::solve`] then takes a
//! time that does not depend on the record.

mod cycle;

use breakaway_core::estimate::limit_cycle::{DetectorSettings, DetectorState, LimitCycleDetector, RelayOutcome};
use breakaway_core::estimate::modulating::{Block, Modulating, ModulatingState, estimate_base};
use breakaway_core::estimate::sine::SineFit;
use breakaway_core::link::{
    CommandError, Ending, Estimate, FULL_SCALE_CODE, IdentificationVerdict, Identified, Mode, Relay, Sample, Settings,
    Sine,
};
use heapless::Vec;

use crate::app::accumulate::{Accumulation, SineConfig};
use crate::board::travel;
use cycle::CycleTimer;

/// Delay line of the weak form: a half-width of the velocity's sign of up to 63 samples.
const LINE: usize = 128;
/// Experiments whose sums are kept, the last ones; 1.8 KiB each. c and f1 need two with different h2.
const EXPERIMENTS: usize = 2;
/// Half-width of the velocity's sign in periods (docs/theory.md, section 4: 0.01 to 0.02).
const HALF_WIDTH: f32 = 0.01;
/// Relative change from one period to the next below which the sine fit starts. At 100 cycles and 32 blocks it may be
/// wrong by 4 % (docs/theory.md, section 3: B ≥ 8·M·|ε|).
const STEADY: f32 = 0.02;
/// Relative change of period and amplitude still to come at which a cycle has settled.
const TOLERANCE: f32 = 0.005;
/// How long a cycle may take to settle before the detector gives up; the run itself goes on.
const SETTLING_S: f32 = 120.0;

type WeakForm = Modulating<f32, 1, LINE>;
type WeakState = ModulatingState<f32, 1, LINE>;
type Detector = (LimitCycleDetector<f32>, DetectorState<f32>);

/// A relay experiment, as far as its identification goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Experiment {
    h1_code: i16,
    h2_code: i16,
    hysteresis_counts: u32,
    until_settled: bool,
    append: bool,
    still: bool,
}

impl Experiment {
    /// From the command, with the hysteresis in force.
    #[must_use]
    pub fn new(relay: &Relay, hysteresis_counts: u32) -> Self {
        Self {
            h1_code: relay.h1_code,
            h2_code: relay.h2_code,
            hysteresis_counts,
            until_settled: relay.until_settled,
            append: relay.append,
            still: relay.reference.amplitude_counts == 0,
        }
    }
}

/// What the identification needs from the tick.
#[derive(Clone, Copy, Debug)]
pub enum Want {
    /// Sums for a sine fit.
    Sums(SineConfig),
    /// The end of the run.
    End(Ending),
}

struct Active {
    experiment: Experiment,
    start: Option<Sample>,
    last_tick: u32,
    timer: CycleTimer,
    detector: Option<Detector>,
    judged: bool,
    weak: Option<(WeakForm, WeakState)>,
    period: Option<f32>,
    summing: bool,
}

/// The sums of the relay experiments, and the one under way.
pub struct Identification {
    active: Option<Active>,
    blocks: Vec<Block<f32>, EXPERIMENTS>,
    gaps: bool,
    recorded: bool,
    sine: Option<Sine>,
}

impl Identification {
    /// Nothing recorded.
    #[must_use]
    pub const fn new() -> Self {
        Self { active: None, blocks: Vec::new(), gaps: false, recorded: false, sine: None }
    }

    /// An experiment has started; its samples follow.
    #[inline(never)]
    pub fn start(&mut self, experiment: Experiment) {
        if !experiment.append {
            self.blocks.clear();
            self.gaps = false;
            self.recorded = false;
        }
        self.sine = None;
        self.active = Some(Active {
            experiment,
            start: None,
            last_tick: 0,
            timer: CycleTimer::new(experiment.hysteresis_counts),
            detector: None,
            judged: false,
            weak: None,
            period: None,
            summing: false,
        });
    }

    /// Takes a sample, of any mode; what it makes necessary.
    #[inline(never)]
    pub fn push(&mut self, sample: &Sample, settings: &Settings, tick_hz: u32) -> Option<Want> {
        let active = self.active.as_mut()?;
        if sample.mode != Mode::Relay {
            return None;
        }
        let start = *active.start.get_or_insert_with(|| {
            active.last_tick = sample.tick.wrapping_sub(1);
            *sample
        });
        if sample.tick.wrapping_sub(active.last_tick) != 1 {
            // Sums over a gap are worth nothing, whatever follows.
            self.gaps = true;
            active.weak = None;
        }
        active.last_tick = sample.tick;
        let ts = 1.0 / tick_hz as f32;
        let x = travel(start.count, sample.count) as f32 * settings.position_per_count;
        let u = f32::from(sample.drive_code) * (settings.drive_full_scale / f32::from(FULL_SCALE_CODE));
        if let Some((weak, state)) = &mut active.weak {
            weak.push(state, x, u);
        }
        let error = sample.reference.wrapping_sub(sample.count);
        if let (Some(period), false) = (active.timer.push(error), self.gaps) {
            let last = active.period.replace(period);
            if active.weak.is_none() {
                active.weak = weak_form(period, ts, settings);
            }
            // The fit resolves frequencies near its own only: it waits until the period keeps.
            if !active.summing && last.is_some_and(|last| (last - period).abs() <= STEADY * period) {
                active.summing = true;
                return SineConfig::of_period(period as u32, ts).map(Want::Sums);
            }
        }
        active.judge(error, u, ts, settings)
    }

    /// The tick's sums of the experiment's position, in steps of `position_per_count`.
    #[inline(never)]
    pub fn summed(&mut self, sums: &Accumulation<'_>, position_per_count: f32) {
        let fit = sums.config.fit(&*sums.sums).ok();
        self.sine = fit.map(|fit| wire_sine(&fit, position_per_count));
    }

    /// The experiment is over; after a fault it is not used.
    pub fn ended(&mut self, by_fault: bool) {
        let Some(active) = self.active.take() else {
            return;
        };
        self.recorded |= active.start.is_some() && !by_fault;
        if let (Some((_, state)), false) = (&active.weak, by_fault || self.gaps) {
            if self.blocks.is_full() {
                self.blocks.remove(0);
            }
            let _ = self.blocks.push(state.blocks()[0]);
        }
    }

    /// What the experiments so far determine.
    ///
    /// # Errors
    /// [`CommandError::NothingRecorded`] before the first experiment, [`CommandError::Busy`] during one.
    #[inline(never)]
    pub fn solve(&self) -> Result<Identified, CommandError> {
        if self.active.is_some() {
            return Err(CommandError::Busy(Mode::Relay));
        }
        if !self.recorded {
            return Err(CommandError::NothingRecorded);
        }
        let mut identified = Identified {
            verdict: IdentificationVerdict::Gaps,
            b: Estimate::default(),
            c: Estimate::default(),
            f1: Estimate::default(),
            load: None,
            residual: 0.0,
            condition: 0.0,
            windows: 0,
            sine: self.sine,
        };
        if self.gaps {
            return Ok(identified);
        }
        let experiments: Vec<&[Block<f32>], EXPERIMENTS> = self.blocks.iter().map(core::slice::from_ref).collect();
        match estimate_base(&experiments) {
            Ok(found) => {
                let [b, c, f1, _] = found.standard_errors;
                identified.verdict = IdentificationVerdict::Determined;
                identified.b = Estimate { value: found.b, se: b };
                identified.c = Estimate { value: found.c, se: c };
                identified.f1 = Estimate { value: found.f1, se: f1 };
                identified.residual = found.residual;
                identified.condition = found.condition;
                identified.windows = found.windows;
            }
            Err(refusal) => identified.verdict = IdentificationVerdict::from(refusal),
        }
        Ok(identified)
    }
}

impl Default for Identification {
    fn default() -> Self {
        Self::new()
    }
}

impl Active {
    /// Ends the run when it is to end as soon as its cycle has settled, or cannot.
    #[inline(never)]
    fn judge(&mut self, error_counts: i32, drive: f32, ts: f32, settings: &Settings) -> Option<Want> {
        if !self.experiment.until_settled || !self.experiment.still || self.judged {
            return None;
        }
        if self.detector.is_none() {
            self.detector = self.detector(ts, settings);
        }
        let (detector, state) = self.detector.as_mut()?;
        let outcome = detector.push(state, error_counts as f32, drive)?;
        self.judged = true;
        let cycles = |cycles: u32| u16::try_from(cycles).unwrap_or(u16::MAX);
        match outcome {
            RelayOutcome::Settled(cycle) => Some(Want::End(Ending::Settled { cycles: cycles(cycle.cycles) })),
            RelayOutcome::Asymmetric { cycle, .. } => {
                Some(Want::End(Ending::Asymmetric { cycles: cycles(cycle.cycles) }))
            }
            RelayOutcome::NoLimitCycle { .. } => Some(Want::End(Ending::NoLimitCycle)),
            RelayOutcome::Timeout { .. } | RelayOutcome::LimitTripped { .. } => None,
        }
    }

    fn detector(&self, ts: f32, settings: &Settings) -> Option<Detector> {
        let unit = settings.drive_full_scale / f32::from(FULL_SCALE_CODE);
        let detector = LimitCycleDetector::new(DetectorSettings {
            ts,
            h1: f32::from(self.experiment.h1_code) * unit,
            h2: f32::from(self.experiment.h2_code) * unit,
            hysteresis: self.experiment.hysteresis_counts as f32 + 0.5,
            f1: None,
            tolerance: TOLERANCE,
            timeout_s: SETTLING_S,
            max_error: f32::INFINITY,
        })
        .ok()?;
        let state = detector.start();
        Some((detector, state))
    }
}

fn weak_form(period: f32, ts: f32, settings: &Settings) -> Option<(WeakForm, WeakState)> {
    let half_width = ((HALF_WIDTH * period + 0.5) as usize).clamp(2, (LINE - 1) / 2);
    let window = (2.0 * period + 0.5) as u32;
    // At rest the count stands still, or trembles by one.
    let weak = Modulating::new(ts, window, half_width, [2], settings.position_per_count).ok()?;
    let state = weak.start();
    Some((weak, state))
}

fn wire_sine(fit: &SineFit<f32>, unit: f32) -> Sine {
    Sine {
        amplitude: Estimate { value: fit.amplitude * unit, se: fit.se.amplitude * unit },
        omega: Estimate { value: fit.omega_rad_s, se: fit.se.omega_rad_s },
        phase_centre: Estimate { value: fit.phase_centre_rad, se: fit.se.phase_centre_rad },
        offset: Estimate { value: fit.offset * unit, se: fit.se.offset * unit },
        rms: fit.rms * unit,
        cycles: fit.cycles,
    }
}
