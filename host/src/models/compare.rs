//! Two cards side by side.

use serde::Serialize;

use super::Card;
use crate::report::text::{number, with_error};

/// One parameter of two cards.
#[derive(Clone, Debug, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Line {
    /// `b`, `c`, `f1`, or `effect.symbol`.
    pub parameter: String,
    /// Its value and unit in the first card.
    pub first: Option<Quantity>,
    /// The same in the second.
    pub second: Option<Quantity>,
    /// Second over first, where both have one unit and the first is not 0.
    pub ratio: Option<f64>,
}

/// A number with its error and unit.
#[derive(Clone, Debug, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Quantity {
    /// The value.
    pub value: f64,
    /// Its standard error, where it is known.
    pub se: Option<f64>,
    /// Its unit.
    pub unit: String,
}

impl Quantity {
    /// The value with its error, where it is known, and without the unit.
    pub fn text(&self) -> String {
        self.se.map_or_else(|| number(self.value, 5), |se| with_error(self.value, se))
    }
}

/// Every parameter of a card, the base's first. A second effect of a name has its number behind it.
pub fn parameters(card: &Card) -> Vec<(String, Quantity)> {
    let model = &card.model;
    let (units, base, se) = (&model.units, model.base, model.base_se);
    let one = |name: &str, value, se, unit| (name.to_owned(), Quantity { value, se, unit });
    let mut all = vec![
        one("b", base.b, se.b, units.of_b()),
        one("c", base.c, se.c, units.of_c()),
        one("f1", base.f1, se.f1, units.of_f1()),
    ];
    for (k, entry) in model.effects.iter().enumerate() {
        let before = model.effects[..k].iter().filter(|earlier| earlier.name == entry.name).count();
        let name = if before == 0 { entry.name.clone() } else { format!("{}({})", entry.name, before + 1) };
        let known = crate::model::known_effects().find(|known| known.name == entry.name);
        for parameter in known.map_or(&[][..], |known| known.parameters) {
            let Some(value) = entry.parameters.get(parameter.symbol) else { continue };
            if parameter.default == Some(*value) {
                continue;
            }
            let unit = crate::model::catalogue::unit(parameter.unit, units);
            let se = entry.se.get(parameter.symbol).copied();
            all.push((format!("{name}.{}", parameter.symbol), Quantity { value: *value, se, unit }));
        }
    }
    all
}

/// The parameters of two cards, side by side: those of the first in its order, then what the second has beside them.
pub fn compare(first: &Card, second: &Card) -> Vec<Line> {
    let (a, b) = (parameters(first), parameters(second));
    let of = |list: &[(String, Quantity)], name: &str| list.iter().find(|(n, _)| n == name).map(|(_, q)| q.clone());
    let names = a.iter().chain(b.iter().filter(|(name, _)| of(&a, name).is_none())).map(|(name, _)| name.clone());
    names
        .map(|parameter| {
            let (first, second) = (of(&a, &parameter), of(&b, &parameter));
            let ratio = first
                .as_ref()
                .zip(second.as_ref())
                .filter(|(a, b)| a.unit == b.unit && a.value != 0.0)
                .map(|(a, b)| b.value / a.value);
            Line { parameter, first, second, ratio }
        })
        .collect()
}
