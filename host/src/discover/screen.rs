//! The screen in weak form: it gives starting values of every effect (docs/discovery.md, section 8), and decides
//! nothing.
//!
//! The core gives the force that an effect adds along the measured motion. Its integral against the windows' test
//! function enters the weak form. Amplitudes are coefficients of columns; other parameters are tried on a grid. Wave
//! numbers come from the spectrum of the residual force.

use breakaway_core::plant::effect::{ActsIn, Parameter, Role, Scale, Search};
use breakaway_core::plant::{Base, Drive, Effect, Kind, Plant};
use nalgebra::{DMatrix, DVector};

use super::data::{Data, WARM_UP_S};
use super::spectrum;
use crate::fit::{Candidate, MeasuredMotion, Segment, median};
use crate::identify::weak::{self, Window};

/// Half-widths of the further windows in which periodic effects are sought, s.
const OTHER_WIDTHS_S: [f64; 2] = [0.060, 0.008];
/// Distance of two resonances that are told apart, times the length of a segment, rad. In step at the start of a
/// segment, they are out of step at its end.
const RESOLVED: f64 = 4.0;
/// Most grid points of an effect. The product of its grids is thinned to that.
const MAX_GRID: usize = 60;

/// A starting point of an effect.
#[derive(Clone, Debug)]
pub struct Start {
    /// Model to start from: base, effects so far, and the new effect last.
    pub candidate: Candidate,
    /// Residual sum of squares of the weak form, over that without the effect.
    pub ratio: f64,
}

/// The screen on the residual of a model.
#[derive(Debug)]
pub struct Screen<'a> {
    data: &'a Data,
    windows: Vec<Window>,
    current: Candidate,
    /// Weak columns of the base, and the right-hand side less the effects so far.
    columns: DMatrix<f64>,
    target: DVector<f64>,
    residual: DVector<f64>,
    square: f64,
    stroke: f64,
    /// The same with longer and shorter windows, for periodic effects. A slow ripple drowns in the noise of short
    /// windows; a fast one passes within long ones.
    others: Vec<Screen<'a>>,
}

impl<'a> Screen<'a> {
    /// Prepares the screen; `None` where the data hold too little motion.
    pub fn new(data: &'a Data, current: &Candidate) -> Option<Self> {
        Self::of_width(data, current, weak::HALF_WIDTH_S)
    }

    /// As [`Self::new`], with longer and shorter windows for periodic effects.
    pub fn of_all_widths(data: &'a Data, current: &Candidate) -> Option<Self> {
        let mut screen = Self::new(data, current)?;
        screen.others = OTHER_WIDTHS_S.iter().filter_map(|width_s| Self::of_width(data, current, *width_s)).collect();
        Some(screen)
    }

    /// Prepares the screen in windows of half-width `width_s`.
    pub fn of_width(data: &'a Data, current: &Candidate, width_s: f64) -> Option<Self> {
        // Few segments of an hour's session are simulated. Windows outside of them are not made.
        let within = |s: &Segment, track, first, last| s.track == track && s.start <= first && last < s.start + s.len;
        let wanted = |track, first, last| data.fit.iter().any(|s| within(s, track, first, last));
        let windows = weak::windows_of(&data.tracks, width_s, wanted);
        let (all, mut target) = weak::base_columns(&windows);
        let columns = all.columns(0, 3).into_owned();
        let mut screen = Self {
            data,
            windows,
            current: current.clone(),
            columns,
            target: target.clone(),
            residual: DVector::zeros(0),
            square: 0.0,
            stroke: stroke(data),
            others: Vec::new(),
        };
        for effect in &current.effects {
            target += screen.effect_column(current.base, effect);
        }
        let (_, residual) = weak::least_squares(&screen.columns, &target)?;
        screen.target = target;
        screen.square = residual.norm_squared();
        screen.residual = residual;
        Some(screen)
    }

    /// Windows used.
    pub fn windows(&self) -> &[Window] {
        &self.windows
    }

    /// Norm of the residual of all windows.
    pub fn residual_norm(&self) -> f64 {
        self.square.sqrt()
    }

    /// Residual force of every window, drive units: the right-hand side less what the model explains.
    pub fn residual_force(&self) -> Vec<f64> {
        self.residual.iter().zip(&self.windows).map(|(r, w)| r / w.unit).collect()
    }

    /// The same from the regression of the acceleration on drive, velocity and direction: what the motion lacks of the
    /// drive. It is not correlated with the drive itself. The residual of the drive is, wherever the model explains little
    /// of the drive. `None` where the drive tells nothing of the acceleration.
    pub fn residual_force_of_motion(&self) -> Option<Vec<f64>> {
        let mut columns = self.columns.clone();
        columns.set_column(0, &self.target);
        let (coefficients, residual) = weak::least_squares(&columns, &self.columns.column(0).into_owned())?;
        let b = 1.0 / coefficients[0];
        b.is_finite().then(|| residual.iter().zip(&self.windows).map(|(r, w)| -b * r / w.unit).collect())
    }

    /// ∫φ·(force of the effect) in every window, along the measured motion.
    fn effect_column(&self, base: Base<f64>, effect: &Effect<f64>) -> DVector<f64> {
        if effect.kind.definition().acts_in == ActsIn::Sensor {
            // x = measured − δ: b·ẍ + c·ẋ gains −b·δ̈ − c·δ̇ on the left.
            let column = self.windows.iter().map(|w| {
                let track = &self.data.tracks[w.track];
                let (second, first) = w.derivatives(|k| effect.sensor(track.xs[k]));
                base.b * second + base.c * first
            });
            return DVector::from_iterator(self.windows.len(), column);
        }
        let plant = Plant { base, effects: std::slice::from_ref(effect) };
        let mut forces: Vec<Vec<f64>> = self.data.tracks.iter().map(|t| vec![0.0; t.t.len()]).collect();
        for segment in &self.data.fit {
            force_along(&plant, &self.data.tracks[segment.track], segment, &mut forces[segment.track]);
        }
        let column = self.windows.iter().map(|w| w.held_integral(|k| forces[w.track][k]));
        DVector::from_iterator(self.windows.len(), column)
    }

    /// Starting points of an effect, the best first. Those of a periodic effect come from each width of the windows in
    /// turn.
    pub fn starts(&self, kind: Kind) -> Vec<Start> {
        let own = self.own_starts(kind);
        if !kind.definition().periodic() {
            return own;
        }
        let mut all: Vec<(usize, Start)> = own.into_iter().enumerate().collect();
        for other in &self.others {
            all.extend(other.own_starts(kind).into_iter().enumerate());
        }
        all.sort_by_key(|(rank, _)| *rank);
        all.into_iter().map(|(_, start)| start).collect()
    }

    fn own_starts(&self, kind: Kind) -> Vec<Start> {
        let mut starts: Vec<Start> = self
            .grid(kind)
            .into_iter()
            .filter_map(|values| self.start(kind, &values))
            .filter(|start| start.ratio.is_finite())
            .collect();
        starts.sort_by(|a, b| a.ratio.total_cmp(&b.ratio));
        starts
    }

    /// One grid point, with the amplitudes by least squares; `None` where they have no solution.
    fn start(&self, kind: Kind, values: &[Option<f64>]) -> Option<Start> {
        let base = self.current.base;
        let parameters = kind.definition().parameters;
        let mut effect = Effect::new(kind, &[]);
        for (i, value) in values.iter().enumerate() {
            if let Some(value) = value {
                effect.p[i] = *value;
            }
        }
        // (amplitude, its phase) by index.
        let amplitudes: Vec<(usize, Option<usize>)> = parameters
            .iter()
            .enumerate()
            .filter(|(_, p)| p.default.is_none() && p.search == Search::Amplitude)
            .map(|(i, _)| (i, phase_of(parameters, i)))
            .collect();
        let n = self.windows.len();
        let unit = 0.02 * base.f1.max(1e-9);
        let mut columns: Vec<DVector<f64>> = Vec::new();
        let mut target = self.target.clone();
        let zero = amplitudes.iter().fold(effect, |mut e, (i, _)| {
            e.p[*i] = 0.0;
            e
        });
        if amplitudes.is_empty() {
            target += self.effect_column(base, &effect);
        }
        for (i, phase) in &amplitudes {
            // The force is linear in an amplitude that is a force. A small trial value serves for the others.
            let trial = trial_value(&parameters[*i], unit);
            let angles: &[f64] = if phase.is_some() { &[0.0, std::f64::consts::FRAC_PI_2] } else { &[0.0] };
            for angle in angles {
                let mut e = zero;
                e.p[*i] = trial;
                if let Some(j) = phase {
                    e.p[*j] = *angle;
                }
                columns.push(self.effect_column(base, &e) / trial);
            }
        }
        let p = 3 + columns.len();
        let matrix = DMatrix::from_fn(n, p, |i, j| if j < 3 { self.columns[(i, j)] } else { -columns[j - 3][i] });
        let (coefficients, residual) = weak::least_squares(&matrix, &target)?;
        let mut at = 3;
        for (i, phase) in &amplitudes {
            if let Some(j) = phase {
                let (sine, cosine) = (coefficients[at], coefficients[at + 1]);
                effect.p[*i] = sine.hypot(cosine);
                effect.p[*j] = cosine.atan2(sine);
                at += 2;
            } else {
                effect.p[*i] = coefficients[at];
                at += 1;
            }
        }
        for (i, parameter) in parameters.iter().enumerate() {
            effect.p[i] = effect.p[i].clamp(parameter.min, parameter.max);
        }
        let mut effects = self.current.effects.clone();
        effects.push(effect);
        let fitted = Base { b: coefficients[0], c: coefficients[1].max(0.0), f1: coefficients[2].max(1e-3 * base.f1) };
        // The weak form's base is a starting value only where its inertia is within a factor of five of the current
        // one.
        let base = if fitted.b > 0.2 * base.b && fitted.b < 5.0 * base.b { fitted } else { base };
        Some(Start { candidate: Candidate { base, effects }, ratio: residual.norm_squared() / self.square })
    }

    /// The product of the grids of an effect. `None` in a place means that least squares or a default gives the value.
    fn grid(&self, kind: Kind) -> Vec<Vec<Option<f64>>> {
        let mut points: Vec<Vec<Option<f64>>> = vec![Vec::new()];
        for parameter in kind.definition().parameters {
            let values: Vec<Option<f64>> = match parameter.search {
                _ if parameter.default.is_some() => vec![None],
                Search::Amplitude | Search::Phase => vec![None],
                Search::Grid(scale, multiples) => {
                    let unit = self.scale(scale);
                    let values = multiples.iter().map(|m| (m * unit).clamp(parameter.min, parameter.max));
                    values
                        .map(|value| Some(if scale == Scale::Session { self.session_start() + value } else { value }))
                        .collect()
                }
                Search::Resonance(from, to) => {
                    let spacing = RESOLVED / self.data.segment_s;
                    (0..=((to - from) / spacing) as usize).map(|i| Some(from + i as f64 * spacing)).collect()
                }
                Search::Spectrum(over) => {
                    spectrum::peaks(&self.data.tracks, &self.windows, &self.residual_force(), over)
                        .into_iter()
                        .map(Some)
                        .collect()
                }
            };
            points = points
                .into_iter()
                .flat_map(|point| {
                    values.iter().map(move |value| {
                        let mut longer = point.clone();
                        longer.push(*value);
                        longer
                    })
                })
                .collect();
        }
        let step = points.len().div_ceil(MAX_GRID).max(1);
        points.into_iter().step_by(step).collect()
    }

    fn session_start(&self) -> f64 {
        self.data.tracks.first().and_then(|t| t.t.first()).copied().unwrap_or(0.0)
    }

    fn scale(&self, scale: Scale) -> f64 {
        let base = &self.current.base;
        let tracks = &self.data.tracks;
        match scale {
            Scale::Unit => 1.0,
            Scale::Speed => {
                let squares: f64 = self.windows.iter().map(|w| tracks[w.track].vs[w.centre].powi(2)).sum();
                (squares / self.windows.len().max(1) as f64).sqrt().max(1e-12)
            }
            Scale::Drive => tracks.iter().flat_map(|t| &t.u).fold(0.0, |m: f64, u| m.max(u.abs())),
            Scale::Coulomb => base.f1,
            Scale::Viscous => base.c,
            Scale::Session => tracks.last().and_then(|t| t.t.last()).copied().unwrap_or(1.0) - self.session_start(),
            Scale::Presliding => base.f1 / self.stroke,
            Scale::Stroke => self.stroke,
            Scale::Extent => tracks.iter().flat_map(|t| &t.xs).fold(0.0, |m: f64, x| m.max(x.abs())),
            Scale::BristleDamping => 2.0 * (30.0 * base.f1 / self.stroke * base.b).sqrt(),
        }
    }
}

/// Typical travel within a segment, position units: the median, at least the noise.
pub(super) fn stroke(data: &Data) -> f64 {
    let travels = data.fit.iter().map(|s| extent(&data.tracks[s.track].xs[s.start..s.start + s.len]));
    median(travels.collect()).max(data.sigma)
}

/// Largest travel within a recording, position units, at least the noise.
pub(super) fn travel(data: &Data) -> f64 {
    data.tracks.iter().map(|track| extent(&track.xs)).fold(data.sigma, f64::max)
}

/// From the least position to the largest.
fn extent(x: &[f64]) -> f64 {
    x.iter().copied().fold(f64::MIN, f64::max) - x.iter().copied().fold(f64::MAX, f64::min)
}

/// The phase that belongs to amplitude `i`: the next phase without a default, before another amplitude.
fn phase_of(parameters: &[Parameter], i: usize) -> Option<usize> {
    (i + 1..parameters.len())
        .take_while(|j| parameters[*j].default.is_none() && parameters[*j].search != Search::Amplitude)
        .find(|j| parameters[*j].search == Search::Phase)
}

/// A trial value at which the force is still proportional to the amplitude.
fn trial_value(parameter: &Parameter, force: f64) -> f64 {
    match parameter.role {
        Role::Ratio => 0.01_f64.min(parameter.max),
        Role::Rate => 1e-4,
        Role::Eccentricity => 1e-6,
        _ => force,
    }
}

/// The force of the plant's effects along the measured motion of a segment.
fn force_along(plant: &Plant<'_, f64>, track: &MeasuredMotion, segment: &Segment, forces: &mut [f64]) {
    let remembers = plant.effects.iter().any(|effect| effect.kind.remembers());
    let piece = track.pieces.partition_point(|&p| p <= segment.start) - 1;
    let warm_up = if remembers { (WARM_UP_S / track.ts) as usize } else { 0 };
    let first = segment.start.saturating_sub(warm_up).max(track.pieces[piece]);
    let mut state = plant.at_rest(track.xs[first]);
    let range = first..segment.start + segment.len;
    for (k, force) in range.clone().zip(&mut forces[range]) {
        let drive = Drive { u: &track.u[..=k], ts: track.dt(k), t: track.t[k] };
        *force = plant.effect_force(&mut state, drive, track.xs[k], track.vs[k], track.acceleration[k]);
    }
}
