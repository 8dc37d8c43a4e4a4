//! A machine's row of the table.

use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;

/// A machine's row: a result, or the reason why there is none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Row {
    /// Name of its folder.
    pub machine: String,
    /// Verdict; `null` if there is no result.
    pub verdict: Option<String>,
    /// The effects that were added.
    pub effects: Vec<String>,
    /// Effects that these recordings cannot tell from those.
    pub tied: Vec<String>,
    /// Held-out error of the base over that of the improved model, in open loop over 1 s.
    pub shrink: Option<f64>,
    /// Held-out error of the improved model over the noise.
    pub noise_factor: Option<f64>,
    /// Position noise, position units.
    pub noise_floor: Option<f64>,
    /// b, c, f1 of the improved model.
    pub base: [Option<f64>; 3],
    /// Time taken, s; of a result that was there, the time it took then.
    pub seconds: Option<f64>,
    /// Whether the result was there and is still that of these inputs.
    pub skipped: bool,
    /// Why there is no result.
    pub reason: Option<String>,
}

impl Row {
    /// The row of a machine without a result.
    pub fn failed(machine: &str, reason: impl Into<String>) -> Self {
        Self { machine: machine.to_owned(), reason: Some(reason.into()), ..Self::default() }
    }

    /// The row of a machine's document (the JSON of `discover`).
    pub fn of(machine: &str, document: &Value, skipped: bool) -> Self {
        let effects = document["effects"].as_array().map_or(&[][..], Vec::as_slice);
        let name = |value: &Value| value["name"].as_str().map(str::to_owned);
        let rivals = effects.iter().flat_map(|effect| effect["rivals"].as_array().into_iter().flatten());
        let ladder = document["ladder"].as_array().map_or(&[][..], Vec::as_slice);
        let ends = |key: &str| Some((ladder.first()?[key].as_f64()?, ladder.last()?[key].as_f64()?));
        let noise_floor = document["noise_floor"].as_f64();
        let ratio = |a: f64, b: f64| (b > 0.0).then(|| a / b);
        Self {
            machine: machine.to_owned(),
            verdict: document["verdict"].as_str().map(str::to_owned),
            effects: effects.iter().filter_map(name).collect(),
            tied: rivals.filter(|rival| rival["tied"] == true).filter_map(name).collect(),
            shrink: ends("holdout_open_loop_rmse").and_then(|(before, after)| ratio(before, after)),
            noise_factor: ends("holdout_rmse").zip(noise_floor).and_then(|((_, after), noise)| ratio(after, noise)),
            noise_floor,
            base: ["b", "c", "f1"].map(|symbol| document["base"][symbol]["value"].as_f64()),
            seconds: document["seconds"].as_f64(),
            skipped,
            reason: None,
        }
    }

    /// What is missing, for a reader: the effects, and in brackets what they cannot be told from.
    pub fn missing(&self) -> String {
        let named = self.effects.join(" + ").replace('_', " ");
        let tied = self.tied.join(", ").replace('_', " ");
        if tied.is_empty() { named } else { format!("{named} (or {tied})") }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::Row;

    #[test]
    fn a_row_is_made_of_the_document() {
        let rung = |held, open| json!({ "effects": [], "holdout_rmse": held, "holdout_open_loop_rmse": open });
        let document = json!({
            "verdict": "partly_explained", "noise_floor": 0.5, "seconds": 2.5,
            "base": { "b": { "value": 1.0 }, "c": { "value": null }, "f1": { "value": 3.0 } },
            "ladder": [rung(4.0, 8.0), rung(1.0, 2.0)],
            "effects": [{ "name": "position_friction", "rivals": [
                { "name": "cogging", "tied": true }, { "name": "spring", "tied": false }] }],
        });
        let row = Row::of("a", &document, false);
        assert_eq!((row.shrink, row.noise_factor), (Some(4.0), Some(2.0)));
        assert_eq!(row.base, [Some(1.0), None, Some(3.0)]);
        assert_eq!(row.missing(), "position friction (or cogging)");
        // An error that is not known, or no noise at all, gives no factor rather than infinity.
        let poor = json!({ "noise_floor": 0.0, "ladder": [rung(4.0, f64::NAN)] });
        assert_eq!((Row::of("b", &poor, true).shrink, Row::of("b", &poor, true).noise_factor), (None, None));
    }
}
