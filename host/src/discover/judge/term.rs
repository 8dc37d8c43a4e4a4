//! A term of the model: what an effect, or a decoy, adds to either side of the equation of motion.

use std::sync::{Arc, OnceLock};

use breakaway_core::plant::Kind;

use super::weak_form::Field;

/// What a term stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Name {
    /// An effect of the catalogue.
    Effect(Kind),
    /// A decoy: something else, which gets no name.
    Decoy(&'static str),
}

impl Name {
    /// The name as it is printed.
    pub fn text(self) -> &'static str {
        match self {
            Self::Effect(kind) => kind.name(),
            Self::Decoy(name) => name,
        }
    }
}

/// A quantity at every sample, and its values in the windows of one form.
#[derive(Debug)]
pub struct Sampled {
    /// At every sample. A piece without samples counts as 0.
    pub field: Field,
    /// In every window; made at the first call.
    pub windows: OnceLock<Vec<f64>>,
}

/// A column: at every sample where it must still be filtered, else in every window.
#[derive(Clone, Debug)]
pub enum Column {
    /// A force at every sample.
    Force(Arc<Sampled>),
    /// A displacement of the reading, whose second derivative times the inertia is the force.
    Displacement(Arc<Sampled>),
    /// A force in every window.
    Windows(Arc<Vec<f64>>),
}

impl Column {
    /// A force at every sample.
    pub fn force(field: Field) -> Self {
        Self::Force(Arc::new(Sampled { field, windows: OnceLock::new() }))
    }
    /// A displacement of the reading at every sample.
    pub fn displacement(field: Field) -> Self {
        Self::Displacement(Arc::new(Sampled { field, windows: OnceLock::new() }))
    }
    /// The force at every sample; `None` for any other column.
    pub fn sampled_force(&self) -> Option<&Field> {
        if let Self::Force(own) = self { Some(&own.field) } else { None }
    }
    /// The quantity at every sample; `None` where it is known in windows alone.
    pub fn field(&self) -> Option<&Field> {
        match self {
            Self::Force(own) | Self::Displacement(own) => Some(&own.field),
            Self::Windows(_) => None,
        }
    }
    /// The same for the windows of another form.
    fn afresh(&self) -> Self {
        match self {
            Self::Force(own) => Self::force(own.field.clone()),
            Self::Displacement(own) => Self::displacement(own.field.clone()),
            Self::Windows(own) => Self::Windows(own.clone()),
        }
    }
}

/// Bounds on the amplitudes of a term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// Any.
    Any,
    /// Positive, as the term is written on the side of the drive.
    Positive,
}

/// The kind of columns of a term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// Anything.
    Any,
    /// A sine and a cosine for each phase.
    Wave,
}

/// A term: the columns that an effect or a decoy adds.
#[derive(Clone, Debug)]
pub struct Term {
    /// What it stands for.
    pub name: Name,
    /// Parameters that the columns were made with, by index in the effect's definition.
    pub parameters: Vec<(usize, f64)>,
    /// Columns of the drive as a function of the motion.
    pub u: Vec<Column>,
    /// Columns of the motion as a function of the drive; empty where they are those of `u`.
    pub a: Vec<Column>,
    /// Whether the first column takes the place of the Coulomb friction's direction.
    pub replaces_direction: bool,
    /// Whether each recording has columns of its own, because its encoder starts anywhere.
    pub own_zeros: bool,
    /// What the columns are.
    pub shape: Shape,
    /// What the amplitudes may be.
    pub sign: Sign,
    /// A second body: its angular frequency (rad/s) and damping ratio. Side A sends every force through it.
    pub body: Option<[f64; 2]>,
    /// How the drive arrives; it replaces the drive on both sides. `None` where the term does not change it.
    pub drive: Option<Arrival>,
    /// Mean of the drive in every window, as it arrives by this term alone; made at the first call.
    pub arrived: Arc<OnceLock<Vec<f64>>>,
    /// Whether the columns hold the drive, or a prediction of it.
    pub holds_drive: bool,
    /// Parameters and amplitudes, by which a smaller term is preferred.
    pub size: usize,
    /// Independent terms of which this one was chosen, because it explains most; 1 where nothing was chosen.
    pub chosen_of: f64,
}

/// How the drive arrives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Arrival {
    /// Late by so many seconds.
    Delay(f64),
    /// Through a first-order lag of so many seconds.
    Lag(f64),
    /// Clipped to at most this magnitude, drive units.
    Limit(f64),
    /// Less this magnitude, drive units; 0 where the drive is smaller.
    DeadZone(f64),
    /// Less this share of its magnitude, as friction against the motion.
    Load(f64),
    /// Less d·clip((u − Ke·v)/edge) with the clip at ±1; u − Ke·v stands for the current. The values are d, edge and
    /// Ke, in drive units and drive units per velocity.
    DeadTime([f64; 3]),
}

impl Arrival {
    /// By how much the drive is late, s; `None` where it is not late.
    pub const fn time_s(self) -> Option<f64> {
        match self {
            Self::Delay(time_s) | Self::Lag(time_s) => Some(time_s),
            Self::Limit(_) | Self::DeadZone(_) | Self::Load(_) | Self::DeadTime(_) => None,
        }
    }
}

impl Term {
    /// A force that is linear in its columns' amplitudes and does not hold the drive.
    pub fn force(name: Name, fields: Vec<Field>) -> Self {
        let u: Vec<Column> = fields.into_iter().map(Column::force).collect();
        Self {
            name,
            parameters: Vec::new(),
            size: u.len(),
            u,
            a: Vec::new(),
            replaces_direction: false,
            own_zeros: false,
            shape: Shape::Any,
            sign: Sign::Any,
            body: None,
            drive: None,
            arrived: Arc::default(),
            holds_drive: false,
            chosen_of: 1.0,
        }
    }

    /// The same with a parameter that the columns were made with.
    pub fn with(mut self, index: usize, value: f64) -> Self {
        self.parameters.push((index, value));
        self.size += 1;
        self
    }

    /// The same for the windows of another form.
    pub fn afresh(&self) -> Self {
        let each = |columns: &[Column]| columns.iter().map(Column::afresh).collect();
        Self { u: each(&self.u), a: each(&self.a), arrived: Arc::default(), ..self.clone() }
    }

    /// The same with bounds on its amplitudes.
    pub fn signed(self, sign: Sign) -> Self {
        Self { sign, ..self }
    }
}
