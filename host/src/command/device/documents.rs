//! The JSON documents of `breakaway device`.

use std::borrow::Cow;
use std::collections::BTreeMap;

use breakaway_core::link::{
    FaultRecord, Identified as OnWire, Info as Board, Settings as Values, Sine as SineOnWire, Status as State,
};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Serialize;
use serde_json::{Map, Value, json};

use crate::device::list::Listed;
use crate::device::scale::{Scale, decimal};
use crate::device::{settings, text};
use crate::model::Model as ModelFile;
use crate::report::json::Quantity;

/// What a command did that gives nothing back.
#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::command) struct Done {
    pub done: &'static str,
}

/// `info`.
#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::command) struct Info<'a> {
    board: &'a str,
    firmware: &'a str,
    build: &'a str,
    link_version: u16,
    tick_hz: u32,
    counts_per_revolution: u32,
    /// 0 where the current is not measured.
    current_range_ma: u32,
    position_per_count: f64,
    position_unit: &'a str,
    drive_full_scale: f64,
    drive_unit: &'a str,
}

impl<'a> Info<'a> {
    pub fn new(info: &'a Board, scale: &'a Scale) -> Self {
        Self {
            board: info.board.as_str(),
            firmware: info.firmware.as_str(),
            build: info.build.as_str(),
            link_version: info.protocol_version,
            tick_hz: info.tick_hz,
            counts_per_revolution: info.counts_per_revolution,
            current_range_ma: info.current_range_ma,
            position_per_count: scale.step,
            position_unit: &scale.units.x,
            drive_full_scale: scale.drive_max(),
            drive_unit: &scale.units.u,
        }
    }
}

/// `status`.
#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::command) struct Status {
    mode: &'static str,
    tick: u32,
    pub position: f64,
    pub drive: f64,
    /// 0 where nothing is streamed.
    decimation: u16,
    dropped: u32,
    damaged_frames: u32,
    late_ticks: u32,
    unsaved: bool,
    zero_needed: bool,
}

impl Status {
    pub fn new(status: &State, scale: &Scale) -> Self {
        Self {
            mode: status.mode.name(),
            tick: status.tick,
            position: scale.position(status.count),
            drive: scale.drive(status.drive_code.into()),
            decimation: status.decimation,
            dropped: status.dropped,
            damaged_frames: status.bad_frames,
            late_ticks: status.overruns,
            unsaved: status.unsaved,
            zero_needed: status.zero_needed,
        }
    }
}

/// `settings get`: the settings asked for, by name.
#[derive(Debug, Serialize)]
#[serde(transparent)]
pub(in crate::command) struct Settings(pub Map<String, Value>);

impl JsonSchema for Settings {
    fn schema_name() -> Cow<'static, str> {
        "Settings".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let kind = |value: &Value| match value {
            Value::Bool(_) => "boolean",
            Value::String(_) => "string",
            _ => "number",
        };
        let list = settings::list(&Values::default());
        let properties: Map<String, Value> =
            list.into_iter().map(|(name, value)| (name, json!({ "type": kind(&value) }))).collect();
        // None is required: `settings get NAME` gives the named ones.
        json_schema!({ "type": "object", "properties": properties, "required": [] })
    }
}

/// `fault`.
#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::command) struct Fault {
    /// `null` where none is latched.
    fault: Option<Latched>,
}

#[derive(Debug, Serialize, JsonSchema)]
struct Latched {
    cause: &'static str,
    text: String,
    mode: &'static str,
    tick: u32,
    position: f64,
    drive: f64,
    value: i32,
    limit: i32,
}

impl Fault {
    pub fn new(record: Option<&FaultRecord>, scale: &Scale) -> Self {
        let latched = |record: &FaultRecord| Latched {
            cause: text::cause_name(record.cause),
            text: text::fault(record),
            mode: record.mode.name(),
            tick: record.tick,
            position: scale.position(record.count),
            drive: scale.drive(record.drive_code.into()),
            value: record.value,
            limit: record.limit,
        };
        Self { fault: record.map(latched) }
    }
}

/// `model get`.
#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::command) struct Model<'a> {
    b: f64,
    c: f64,
    f1: f64,
    effects: Vec<Effect<'a>>,
}

#[derive(Debug, Serialize, JsonSchema)]
struct Effect<'a> {
    name: &'a str,
    parameters: &'a BTreeMap<String, f64>,
}

impl<'a> From<&'a ModelFile> for Model<'a> {
    fn from(model: &'a ModelFile) -> Self {
        let effects = model.effects.iter().map(|effect| Effect { name: &effect.name, parameters: &effect.parameters });
        Self { b: model.base.b, c: model.base.c, f1: model.base.f1, effects: effects.collect() }
    }
}

/// `identify`.
#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::command) struct Identified {
    b: Quantity,
    c: Quantity,
    f1: Quantity,
    load: Option<Quantity>,
    residual: f64,
    condition: f64,
    windows: u32,
    sine: Option<Sine>,
}

#[derive(Debug, Serialize, JsonSchema)]
struct Sine {
    amplitude: f64,
    omega: f64,
    phase_centre: f64,
    offset: f64,
    rms: f64,
    cycles: f64,
    se: SineErrors,
}

#[derive(Debug, Serialize, JsonSchema)]
struct SineErrors {
    amplitude: f64,
    omega: f64,
    phase_centre: f64,
    offset: f64,
}

impl Identified {
    pub fn new(found: &OnWire, scale: &Scale) -> Self {
        let units = &scale.units;
        let quantity = |value: f32, se: f32, unit: String| Quantity { value: decimal(value), se: decimal(se), unit };
        Self {
            b: quantity(found.b.value, found.b.se, units.of_b()),
            c: quantity(found.c.value, found.c.se, units.of_c()),
            f1: quantity(found.f1.value, found.f1.se, units.of_f1()),
            load: found.load.map(|load| quantity(load.value, load.se, units.u.clone())),
            residual: decimal(found.residual),
            condition: decimal(found.condition),
            windows: found.windows,
            sine: found.sine.as_ref().map(Sine::from),
        }
    }
}

impl From<&SineOnWire> for Sine {
    fn from(sine: &SineOnWire) -> Self {
        Self {
            amplitude: decimal(sine.amplitude.value),
            omega: decimal(sine.omega.value),
            phase_centre: decimal(sine.phase_centre.value),
            offset: decimal(sine.offset.value),
            rms: decimal(sine.rms),
            cycles: decimal(sine.cycles),
            se: SineErrors {
                amplitude: decimal(sine.amplitude.se),
                omega: decimal(sine.omega.se),
                phase_centre: decimal(sine.phase_centre.se),
                offset: decimal(sine.offset.se),
            },
        }
    }
}

/// `zero`.
#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::command) struct Zeroed {
    pub done: &'static str,
    pub position: f64,
}

/// `home` and `jog`.
#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::command) struct Moved {
    pub done: &'static str,
    pub ending: String,
    pub position: f64,
}

/// `stop`.
#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::command) struct Stopped {
    pub done: &'static str,
    /// `holder`, `port` or `past_holder`.
    pub way: &'static str,
}

/// A port of `list`.
#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::command) struct Entry<'a> {
    port: &'a str,
    device: Option<&'a str>,
    answers: bool,
    #[serde(flatten)]
    answer: Answer<'a>,
}

/// Who answers, or why nobody does.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(untagged)]
enum Answer<'a> {
    Board { board: &'a str, firmware: &'a str, build: &'a str, held: bool },
    None { reason: &'a str },
}

impl<'a> From<&'a Listed> for Entry<'a> {
    fn from(listed: &'a Listed) -> Self {
        let Listed { port, device, answer } = listed;
        let answers = answer.is_ok();
        let answer = match answer {
            Ok(found) => {
                Answer::Board { board: &found.board, firmware: &found.firmware, build: &found.build, held: found.held }
            }
            Err(reason) => Answer::None { reason },
        };
        Self { port, device: device.as_deref(), answers, answer }
    }
}
