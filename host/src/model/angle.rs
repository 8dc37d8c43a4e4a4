//! A model in radians, in which the laws of an angle are written.

use breakaway_core::plant::effect::Parameter;

use super::{Model, effects::known_effect};

const RADIANS: &str = "rad";

impl Model {
    /// Converts the model to rad. Its position unit is the one it names, else one of `radians`.
    pub fn in_radians(&mut self, radians: f64) {
        if self.units.x == RADIANS {
            return;
        }
        let unit = self.units.radians(None).unwrap_or(radians);
        let base = [&mut self.base.b, &mut self.base.c];
        let errors = [&mut self.base_se.b, &mut self.base_se.c].into_iter().flatten();
        base.into_iter().chain(errors).for_each(|value| *value /= unit);
        for effect in &mut self.effects {
            let parameters = known_effect(&effect.name).map_or(&[][..], |definition| definition.parameters);
            for parameter in parameters {
                let scale = unit.powi(power_of_position(parameter));
                let values = [effect.parameters.get_mut(parameter.symbol), effect.se.get_mut(parameter.symbol)];
                values.into_iter().flatten().for_each(|value| *value *= scale);
            }
        }
        RADIANS.clone_into(&mut self.units.x);
    }
}

/// The power of the position in a parameter's unit: 1 in `X/s`, −1 in `U·s/X`, −2 in `U·s²/X²`.
fn power_of_position(parameter: &Parameter) -> i32 {
    let unit = parameter.role.unit();
    let (above, below) = unit.split_once('/').unwrap_or((unit, ""));
    let power = |part: &str| match part.split_once('X') {
        None => 0,
        Some((_, rest)) if rest.starts_with('\u{b2}') => 2,
        Some(_) => 1,
    };
    power(above) - power(below)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For 180° in π rad, computed by hand. b, c and their errors per rad are 180/π times those per degree, and a
    /// drag coefficient is its square. A wave number is per rad too. A speed is π/180 of the one in °/s, and a force
    /// is the same.
    #[test]
    fn degrees_become_radians() {
        let text = "[base]\nb = 1.0\nc = 2.0\nf1 = 3.0\n[base.se]\nb = 0.5\n[units]\nu = \"V\"\nx = \"deg\"\n\
            [[effect]]\nname = \"stribeck\"\ns = 1.0\nvs = 180.0\np = 2.0\n\
            [[effect]]\nname = \"quadratic_drag\"\nk = 1.0\n\
            [[effect]]\nname = \"cogging\"\nA = 1.0\nn = 1.0\nphi = 0.5\n";
        let mut model = Model::parse("deg.toml", text).unwrap();
        model.in_radians(7.0);
        let per = 180.0 / std::f64::consts::PI;
        let value = |effect: usize, symbol: &str| model.effects[effect].parameters[symbol];
        let close = |value: f64, expected: f64| assert!((value / expected - 1.0).abs() < 1e-12, "{value} {expected}");
        close(model.base.b, per);
        close(model.base_se.b.unwrap(), 0.5 * per);
        close(model.base.c, 2.0 * per);
        close(model.base.f1, 3.0);
        close(value(0, "s"), 1.0);
        close(value(0, "vs"), std::f64::consts::PI);
        close(value(1, "k"), per * per);
        close(value(2, "n"), per);
        close(value(2, "phi"), 0.5);
        assert_eq!(model.units.x, "rad");
        let once = model.clone();
        model.in_radians(7.0);
        assert_eq!(model, once);
    }
}
