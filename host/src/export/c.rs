//! C: a header with the model's parameters, and the controller's compensation of it in float and in Q16.16.
//!
//! The functions are those of the compensator on the board (docs/control.md), without its lead. One is the force along
//! a reference, the other the inverse of the drive's path. They need no library and keep no state.

use std::fmt::Write as _;

use breakaway_core::plant::effect::{Compensation, Effect};

use super::axis::{Decided, base_kept};
use super::fate::{Row, Written, kept, losses, lost};
use crate::file::EXPORT_MARK;
use crate::model::Model;

const HELPERS: &str = include_str!("c/helpers.h");
/// The share of the break-away force that friction compensation may reach, as in the compensator of the core.
const CAP: f64 = 0.98;
/// Radians to turns.
const TURNS: f64 = 1.0 / std::f64::consts::TAU;

/// Statements of a function, for both kinds of numbers.
#[derive(Default)]
struct Code {
    float: String,
    fixed: String,
}

impl Code {
    fn comment(&mut self, text: &str) {
        let text = text.replace("*/", "* /");
        for out in [&mut self.float, &mut self.fixed] {
            // Writing to a String cannot fail.
            let _ = writeln!(out, "    /* {text} */");
        }
    }
    fn line(&mut self, float: &str, fixed: &str) {
        let _ = writeln!(self.float, "    {float}");
        let _ = writeln!(self.fixed, "    {fixed}");
    }
}

pub(super) fn write(model: &Model, name: &str) -> Written {
    let (u, x) = (&model.units.u, &model.units.x);
    let base = model.base;
    let mut forward = Code::default();
    forward.comment(&format!(
        "b = {} {}, c = {} {}",
        super::number(base.b),
        model.units.of_b(),
        super::number(base.c),
        model.units.of_c()
    ));
    forward.line(
        &format!("float force = {}f * a + {}f * v;", float(base.b), float(base.c)),
        &format!("int64_t force = {} + {};", times("a", base.b), times("v", base.c)),
    );
    forward.comment(&format!("f1 = {} {u}: level of friction in motion and at rest", super::number(base.f1)));
    forward.line(
        &format!("float level = {}f, rest = level;", float(base.f1)),
        &format!("int64_t level = {}, rest = level;", q16(base.f1)),
    );
    let mut inverse = Code::default();
    let mut ratio = 0.0;
    let mut rows: Vec<Row> = base_kept(["feed-forward along the reference"; 3]);
    let effects: Vec<Effect<f64>> = model.effects.iter().filter_map(crate::model::EffectEntry::effect).collect();
    for effect in &effects {
        let definition = effect.kind.definition();
        let (fate, how) = shape(effect, model, &mut forward, &mut inverse, &mut ratio);
        rows.push(Row { what: definition.name.to_owned(), law: definition.law.to_owned(), fate, how });
    }
    forward.comment("friction stays below the break-away force, so that compensation alone moves nothing");
    forward.line(
        &format!("if (level > {CAP}f * rest) {{ level = {CAP}f * rest; }}"),
        &format!("if (level > {0}) {{ level = {0}; }}", times("rest", CAP)),
    );
    forward.line(
        "force += v > 0.0f ? (level > 0.0f ? level : 0.0f) : (v < 0.0f ? -(level > 0.0f ? level : 0.0f) : 0.0f);",
        "force += v > 0 ? (level > 0 ? level : 0) : (v < 0 ? -(level > 0 ? level : 0) : 0);",
    );
    if ratio != 0.0 {
        let bounded = |share: f64| if share > 0.05 { 1.0 / share } else { 20.0 };
        let (with, against) = (bounded(1.0 - ratio), bounded(1.0 + ratio));
        forward.comment(&format!("friction that grows with the drive, {} of it", super::number(ratio)));
        forward.line(
            &format!(
                "if (v != 0.0f) {{ force *= (force > 0.0f) == (v > 0.0f) ? {}f : {}f; }}",
                float(with),
                float(against)
            ),
            &format!(
                "if (v != 0) {{ force = (force > 0) == (v > 0) ? {} : {}; }}",
                times("bk_sat(force)", with),
                times("bk_sat(force)", against)
            ),
        );
    }
    let guard = name.to_ascii_uppercase();
    let head: Vec<String> = [
        format!("{EXPORT_MARK}{}: feed-forward and inverse of {name}", env!("CARGO_PKG_VERSION")),
        format!("x in {x}, v in {x}/s, a in {x}/s2, drive in {u}; the functions with _q16 take and give Q16.16"),
        "C99, no library, no state. v is the velocity of the reference, not the measured one.".to_owned(),
    ]
    .into_iter()
    .chain(losses(&rows))
    .map(|line| format!("/* {} */\n", line.replace("*/", "* /")))
    .collect();
    let mut text = head.concat();
    let functions = [
        (
            "feed_forward",
            ["x", "v", "a"].as_slice(),
            "The drive along a reference.",
            &forward,
            ["return force;", "return bk_sat(force);"],
        ),
        (
            "inverse",
            ["u", "v"].as_slice(),
            "The command that makes the drive hand on u.",
            &inverse,
            ["return u;", "return u;"],
        ),
    ];
    let _ = writeln!(text, "#ifndef {guard}_COMPENSATION_H\n#define {guard}_COMPENSATION_H\n\n{HELPERS}");
    let parameters = [("B", base.b), ("C", base.c), ("F1", base.f1)];
    for (symbol, value) in parameters {
        let _ = writeln!(text, "#define {guard}_{symbol} {}f", float(value));
    }
    for (function, arguments, what, code, end) in functions {
        for (kind, suffix, body, end) in [("float", "", &code.float, end[0]), ("int32_t", "_q16", &code.fixed, end[1])]
        {
            let list: Vec<String> = arguments.iter().map(|argument| format!("{kind} {argument}")).collect();
            let unused: Vec<String> = arguments.iter().map(|argument| format!("(void){argument};")).collect();
            let _ = writeln!(
                text,
                "\n/* {what} */\nstatic inline {kind} {name}_{function}{suffix}({}) {{\n    {}\n{body}    {end}\n}}",
                list.join(", "),
                unused.join(" ")
            );
        }
    }
    let _ = writeln!(text, "\n#endif");
    Written { text, rows, remarks: Vec::new() }
}

/// Adds what a controller does about an effect.
fn shape(effect: &Effect<f64>, model: &Model, forward: &mut Code, inverse: &mut Code, ratio: &mut f64) -> Decided {
    let definition = effect.kind.definition();
    let (Some(shape), Some(said)) = (effect.compensation(&model.base), definition.compensation) else {
        return lost("a controller cannot cancel it");
    };
    let comment = format!("{}: {said}", definition.name);
    match shape {
        Compensation::DeadZone { loss, band } => {
            inverse.comment(&comment);
            saturated(inverse, "u", "u", loss, band);
        }
        Compensation::DeadTime { loss, edge, back_emf } => {
            inverse.comment(&comment);
            let fixed = format!("u - {}", times("v", back_emf));
            saturated(inverse, &format!("u - {}f * v", float(back_emf)), &fixed, loss, edge);
        }
        Compensation::LevelOfDrive { ratio: share } => *ratio += share,
        Compensation::Linear { constant, stiffness } => {
            forward.comment(&comment);
            forward.line(
                &format!("force += {}f + {}f * x;", float(constant), float(stiffness)),
                &format!("force += {} + {};", q16(constant), times("x", stiffness)),
            );
        }
        Compensation::Drag { by_speed, by_square } => {
            forward.comment(&comment);
            forward.line(
                &format!("force += (v < 0.0f ? -v : v) * ({}f + {}f * v);", float(by_speed), float(by_square)),
                &format!(
                    "force += ((int64_t)(v < 0 ? -v : v) * bk_sat({} + {}) + 32768) >> 16;",
                    q16(by_speed),
                    times("v", by_square)
                ),
            );
        }
        Compensation::Ripple { wave_number, first, second } => {
            forward.comment(&comment);
            wave(forward, &["force"], wave_number, first);
            if second[0] != 0.0 {
                wave(forward, &["force"], 2.0 * wave_number, second);
            }
        }
        Compensation::LevelRipple { amplitude, wave_number, phase } => {
            forward.comment(&comment);
            wave(forward, &["level", "rest"], wave_number, [amplitude, phase]);
        }
        Compensation::Stribeck { rise, speed, exponent } => {
            forward.comment(&comment);
            stribeck(forward, rise, speed, exponent);
        }
    }
    kept(said)
}

/// Adds `loss·sat(of/band)` to u.
fn saturated(code: &mut Code, float_of: &str, fixed_of: &str, loss: f64, band: f64) {
    code.line(
        &format!(
            "{{ float i = {float_of}; u += i > {0}f ? {1}f : (i < -{0}f ? -{1}f : {2}f * i); }}",
            float(band),
            float(loss),
            float(loss / band)
        ),
        &format!(
            "{{ int32_t i = bk_sat({fixed_of}); u = bk_sat(u + (i > {0} ? {1} : (i < -{0} ? -{1} : {2}))); }}",
            q16(band),
            q16(loss),
            times("i", loss / band)
        ),
    );
}

/// Adds `amplitude·sin(n·x + phase)` to each of `to`.
fn wave(code: &mut Code, to: &[&str], wave_number: f64, [amplitude, phase]: [f64; 2]) {
    let turns = (phase * TURNS).rem_euclid(1.0);
    // A phase in 2⁻³² turns from a position in 2⁻¹⁶.
    let (m, s) = constant(wave_number * TURNS * 65536.0);
    let (am, a_s) = constant(amplitude);
    let add = |value: &str| to.iter().map(|name| format!(" {name} += {value};")).collect::<Vec<_>>().concat();
    code.line(
        &format!(
            "{{ float w = {}f * bk_sin_turns({}f * x + {}f);{} }}",
            float(amplitude),
            float(wave_number * TURNS),
            float(turns),
            add("w")
        ),
        &format!(
            "{{ int64_t w = bk_mul(bk_sin_phase((uint32_t)bk_mul(x, {m}, {s}) + {}u), {am}, {});{} }}",
            (turns * 4_294_967_296.0) as u32,
            a_s + 14,
            add("w")
        ),
    );
}

/// Adds `rise·e^(−(|v|/speed)^exponent)` to the level, and `rise` to that at rest.
fn stribeck(code: &mut Code, rise: f64, speed: f64, exponent: f64) {
    let (m, s) = constant(rise);
    let (float_power, fixed_power) = if exponent == 2.0 {
        ("r * r".to_owned(), "(r * r) >> 16".to_owned())
    } else {
        (
            format!("r > 0.0f ? bk_power(r, {}f) : 0.0f", float(exponent)),
            format!("r > 0 ? bk_power_q16(r, {}) : 0", q16(exponent)),
        )
    };
    code.line(
        &format!(
            "{{ float r = (v < 0.0f ? -v : v) * {}f; rest += {1}f; level += {1}f * bk_exp_negative({float_power}); }}",
            float(1.0 / speed),
            float(rise)
        ),
        &format!(
            "{{ int64_t r = bk_sat({}); rest += {}; level += bk_mul(bk_exp_negative_q16({fixed_power}), {m}, {}); }}",
            times("(v < 0 ? -v : v)", 1.0 / speed),
            q16(rise),
            s + 14
        ),
    );
}

/// A literal without its `f`.
fn float(value: f64) -> String {
    format!("{:.8e}", value as f32)
}

/// In 2⁻¹⁶.
fn q16(value: f64) -> i64 {
    (value * 65536.0).round().clamp(-f64::from(i32::MAX), f64::from(i32::MAX)) as i64
}

/// m and s of m·2⁻ˢ, with |m| from 2²⁹ to 2³⁰, or 0 for what is too small to count.
fn constant(value: f64) -> (i32, i32) {
    if value == 0.0 || !value.is_finite() {
        return (0, 1);
    }
    let s = 29 - value.abs().log2().floor() as i32;
    if s > 61 {
        return (0, 1);
    }
    let s = s.max(0);
    ((value * f64::from(s).exp2()).round().clamp(-f64::from(i32::MAX), f64::from(i32::MAX)) as i32, s)
}

/// A variable in Q16.16 times a constant.
fn times(variable: &str, by: f64) -> String {
    let (m, s) = constant(by);
    format!("bk_mul({variable}, {m}, {s})")
}
