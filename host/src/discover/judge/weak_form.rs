//! The equation of motion in weak form: it is integrated against a test function, so that no position is
//! differentiated.

use super::dataset::{Dataset, Piece};
use super::direction::sliding;
use super::kernels::{Kernels, norm, over};
use super::library::Made;
use super::regression::dot;
use super::settings::Settings;

/// A quantity at every sample of every piece.
pub type Field = Vec<Vec<f64>>;

/// One window: where it lies.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Piece.
    pub piece: usize,
    /// Sample in its middle.
    pub centre: usize,
    /// Block of the cross-validation.
    pub block: usize,
}

/// All windows of one half-width, and the motion at every sample.
#[derive(Clone, Debug)]
pub struct WeakForm<'a> {
    /// The recordings.
    pub dataset: &'a Dataset,
    /// Half-width, s.
    pub half_width_s: f64,
    /// Windows in motion.
    pub rows: Vec<Row>,
    /// Blocks.
    pub blocks: usize,
    /// Velocity, acceleration and smoothed direction of motion at every sample.
    pub v: Field,
    /// See `v`.
    pub a: Field,
    /// See `v`; in −1..1.
    pub direction: Field,
    /// Acceleration, velocity and mean drive in every window.
    pub row_a: Vec<f64>,
    /// See `row_a`.
    pub row_v: Vec<f64>,
    /// See `row_a`.
    pub row_u: Vec<f64>,
    /// Mean smoothed direction in every window.
    pub row_direction: Vec<f64>,
    /// 95th percentile of the speed.
    pub v95: f64,
    /// Standard deviation of a window's acceleration that the sensor's noise makes, position units/s².
    pub noise_a: f64,
    /// Radians in a position unit; `None` where the position is no angle.
    pub radians: Option<f64>,
    /// Whether ripples are sought in these windows.
    pub ripples: bool,
    /// Terms of the library that the windows and the motion make.
    pub made: Made,
    kernels: Vec<Kernels>,
}

impl<'a> WeakForm<'a> {
    /// Windows of half-width `half_width_s` over all pieces that are long enough. `None` where nothing moves, or where
    /// fewer than 40 windows do.
    pub fn new(dataset: &'a Dataset, half_width_s: f64, settings: &Settings) -> Option<Self> {
        let mut form = Self::sliding(dataset, half_width_s, settings)?;
        let sliding = form.direction.clone();
        form.stick(&sliding, settings);
        Some(form)
    }

    /// The same with a direction that is 0 at rest: for what does not ask for friction.
    pub fn sliding(dataset: &'a Dataset, half_width_s: f64, settings: &Settings) -> Option<Self> {
        let half = |p: &Piece| ((half_width_s / p.h_s).round() as usize).max(settings.least_half_samples);
        let kernels: Vec<Kernels> = dataset.pieces.iter().map(|p| Kernels::new(half(p), p.h_s)).collect();
        let (mut v, mut a, mut noise_v) = (Vec::new(), Vec::new(), Vec::new());
        for (piece, kernel) in dataset.pieces.iter().zip(&kernels) {
            let narrow = Kernels::new((kernel.half / 2).max(2), piece.h_s);
            v.push(over(&narrow, &narrow.velocity, &piece.x));
            a.push(over(kernel, &kernel.acceleration, &piece.x));
            noise_v.push(piece.sigma * norm(&narrow.velocity));
        }
        let v95 = percentile(v.iter().flatten().map(|v| v.abs()).collect(), 0.95);
        if !(v95 > 0.0 && v95.is_finite()) {
            return None;
        }
        let direction: Field =
            dataset.pieces.iter().zip(&kernels).map(|(piece, kernel)| sliding(piece, kernel.half / 2, v95)).collect();
        let mut form = Self {
            dataset,
            half_width_s,
            rows: Vec::new(),
            blocks: 0,
            v,
            a,
            direction,
            row_a: Vec::new(),
            row_v: Vec::new(),
            row_u: Vec::new(),
            row_direction: Vec::new(),
            v95,
            noise_a: 0.0,
            radians: None,
            ripples: true,
            made: Made::default(),
            kernels,
        };
        form.place_rows(settings, &noise_v);
        (form.rows.len() >= 40).then_some(form)
    }

    fn place_rows(&mut self, settings: &Settings, noise_v: &[f64]) {
        let pieces = &self.dataset.pieces;
        let total_s: f64 = pieces.iter().map(|p| p.x.len() as f64 * p.h_s).sum();
        let block_s = settings
            .block_s
            .max(settings.block_half_widths * self.half_width_s)
            .max(total_s / settings.most_blocks as f64);
        let wanted: f64 =
            pieces.iter().zip(&self.kernels).map(|(p, k)| p.x.len() as f64 / (k.half / 3).max(1) as f64).sum();
        let thin = (wanted / settings.most_rows as f64).max(1.0);
        let (mut block, mut noise) = (0, 0.0);
        for (i, (piece, kernel)) in pieces.iter().zip(&self.kernels).enumerate() {
            let margin = kernel.half + (kernel.half / 2).max(2);
            if piece.x.len() < 2 * margin + 1 {
                continue;
            }
            let samples = ((block_s / piece.h_s) as usize).max(1);
            // Blocks of a piece have one length, so that none is a remnant.
            let count = ((piece.x.len() as f64 / samples as f64).round() as usize).max(1);
            for centre in
                (margin..piece.x.len() - margin).step_by((((kernel.half / 3).max(1)) as f64 * thin).round() as usize)
            {
                let speed = kernel.at(&kernel.velocity, &piece.x, centre);
                if speed.abs() <= (settings.slow_share * self.v95).max(3.0 * noise_v[i]) {
                    continue;
                }
                let own = block + centre * count / piece.x.len();
                self.rows.push(Row { piece: i, centre, block: own });
                self.row_v.push(speed);
                self.row_a.push(kernel.at(&kernel.acceleration, &piece.x, centre));
                noise += (piece.sigma * norm(&kernel.acceleration)).powi(2);
            }
            block += count;
        }
        self.blocks = block;
        self.noise_a = (noise / self.rows.len().max(1) as f64).sqrt();
        let drive: Field = pieces.iter().map(|p| p.u.clone()).collect();
        self.row_u = self.means(&drive);
        self.row_direction = self.means(&self.direction);
    }

    /// Mean of a quantity in every window. A piece without samples counts as 0.
    pub fn means(&self, field: &Field) -> Vec<f64> {
        let each = self.rows.iter().map(|row| {
            let kernel = &self.kernels[row.piece];
            field[row.piece].get(row.centre - kernel.half..).map_or(0.0, |samples| dot(&kernel.mean, samples))
        });
        each.collect()
    }

    /// First derivative of a quantity in every window, 1/s.
    pub fn rates(&self, field: &Field) -> Vec<f64> {
        let each = self.rows.iter().map(|row| {
            let kernel = &self.kernels[row.piece];
            kernel.at(&kernel.velocity, &field[row.piece], row.centre)
        });
        each.collect()
    }

    /// Second derivative of a quantity in every window. A piece without samples counts as 0.
    pub fn second_derivatives(&self, field: &Field) -> Vec<f64> {
        let each = self.rows.iter().map(|row| {
            let kernel = &self.kernels[row.piece];
            let piece = &field[row.piece];
            if piece.is_empty() { 0.0 } else { kernel.at(&kernel.acceleration, piece, row.centre) }
        });
        each.collect()
    }

    /// A quantity made of time, position, velocity and direction at every sample.
    pub fn field(&self, f: impl Fn(Sample) -> f64) -> Field {
        let pieces = self.dataset.pieces.iter().enumerate();
        pieces
            .map(|(i, p)| {
                let each = (0..p.x.len()).map(|k| {
                    f(Sample {
                        piece: i,
                        k,
                        t: p.t[k],
                        x: p.x[k],
                        v: self.v[i][k],
                        a: self.a[i][k],
                        direction: self.direction[i][k],
                        u: p.u[k],
                        h_s: p.h_s,
                    })
                });
                each.collect()
            })
            .collect()
    }

    /// Longest way between two positions of a piece, position units.
    pub fn travel(&self) -> f64 {
        let way = |piece: &Piece| {
            let (low, high) = piece.x.iter().fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(*x), h.max(*x)));
            high - low
        };
        self.dataset.pieces.iter().map(way).fold(0.0, f64::max)
    }

    /// Share of the noise in the rms of the acceleration.
    pub fn noise_share(&self) -> f64 {
        let square = self.row_a.iter().map(|a| a * a).sum::<f64>() / self.row_a.len().max(1) as f64;
        self.noise_a / square.sqrt()
    }
}

/// One sample of the measured motion.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Piece and sample.
    pub piece: usize,
    /// See `piece`.
    pub k: usize,
    /// Session time, s.
    pub t: f64,
    /// Position.
    pub x: f64,
    /// Velocity.
    pub v: f64,
    /// Acceleration.
    pub a: f64,
    /// Direction of the friction, −1..1: the smoothed sign of the velocity, and the share u/f1 of the drive at rest.
    pub direction: f64,
    /// Drive.
    pub u: f64,
    /// Interval, s.
    pub h_s: f64,
}

/// The value below which the share of the values lies; 0 if there are none.
pub fn percentile(mut values: Vec<f64>, share: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let at = ((values.len() - 1) as f64 * share) as usize;
    *values.select_nth_unstable_by(at, f64::total_cmp).1
}
