//! What is hidden, for the scorer only.

use crate::{
    effect::Hidden,
    experiment::Role,
    law::ForceLaw,
    machine::{Base, Machine},
    measure::{base_error, gap_force, gap_rms, torque_error},
    plan::Spec,
    run::Trace,
    session::{Case, Session},
    world::World,
};

/// One hidden effect and the parameters of its law in the table's symbols.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectTruth {
    /// Which effect.
    pub hidden: Hidden,
    /// The coordinate along which it lives.
    pub coordinate: &'static str,
    /// Symbol and value; forces in V, positions in rad, times in s.
    pub parameters: Vec<(&'static str, f64)>,
}

/// Noise-free traces of one recording.
#[derive(Clone, Debug, PartialEq)]
pub struct TruthRecord {
    /// Name, as in the session.
    pub name: &'static str,
    /// Fit or score.
    pub role: Role,
    /// What the encoder would read without noise or quantisation, rad.
    pub x: Vec<f64>,
    /// Rate of that, rad/s.
    pub v: Vec<f64>,
    /// Position of the second body (of the shaft, without one), rad.
    pub load: Vec<f64>,
    /// Force the base model lacks, V, mean over each sample: where the effect acts. Random torque and sag are no part of it.
    pub gap_force: Vec<f64>,
    /// What the sensor saw without noise or quantisation, rad: late, held and from its own zero where the world is so.
    pub seen: Vec<f64>,
    /// Mean random torque over each sample, V.
    pub torque: Vec<f64>,
}

/// The sealed truth of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Seed of the case.
    pub seed: u64,
    /// What surrounds the plant, as it was drawn.
    pub world: World,
    /// Requested size of each effect, % of the amplitude.
    pub size_percent: f64,
    /// Base parameters (b is the whole inertia, both bodies).
    pub base: Base,
    /// A0, V: the drive amplitude that sizes refer to.
    pub amplitude: f64,
    /// What is hidden; empty for a clean case.
    pub effects: Vec<EffectTruth>,
    /// Largest and RMS force the true base lacks, % of the amplitude.
    pub gap_peak_percent: f64,
    /// RMS over the moving samples, % of the amplitude.
    pub gap_rms_percent: f64,
    /// The same after b, c, f1 absorbed what they can, % of the amplitude.
    pub gap_rms_refit_percent: f64,
    /// RMS error of the true base plant over 0.4 s open-loop segments over the noise floor. The floor includes the
    /// random torque's effect on the base plant over these segments. Below about 1 the effect is hard to see. An
    /// upper bound, since a fitted base absorbs part of it; multiply by `gap_rms_refit_percent / gap_rms_percent` for
    /// a rough value after that.
    pub visibility: f64,
    /// Noise floor √(σ² + step²/12), rad.
    pub noise_floor: f64,
    /// Noise-free traces, in the session's order.
    pub records: Vec<TruthRecord>,
}

impl Truth {
    pub(crate) fn new(case: &Case, machine: &Machine, law: &ForceLaw, specs: &[Spec], traces: &[Trace]) -> Self {
        let gaps: Vec<Vec<f64>> = traces.iter().map(|t| gap_force(machine, t)).collect();
        let percent = 100.0 / machine.amplitude;
        let (refit, rms) = gap_rms(traces, &gaps);
        let peak = gaps.iter().flatten().fold(0.0, |m: f64, g| m.max(g.abs()));
        let noise_floor = (machine.noise_sigma.powi(2) + machine.encoder_step.powi(2) / 12.0).sqrt();
        let (base, tick_s) = (machine.law(), case.world.tick_s);
        let shaken = case.world.torque.map(|_| torque_error(&base, traces, tick_s));
        let noise = shaken.map_or(noise_floor, |shaken| noise_floor.hypot(shaken));
        Self {
            seed: case.seed,
            world: case.world.clone(),
            size_percent: case.size_percent,
            base: machine.base,
            amplitude: machine.amplitude,
            effects: case
                .effects
                .iter()
                .filter(|e| **e != Hidden::None)
                .map(|e| EffectTruth { hidden: *e, coordinate: e.coordinate(), parameters: parameters(law, e.name()) })
                .collect(),
            gap_peak_percent: peak * percent,
            gap_rms_percent: rms * percent,
            gap_rms_refit_percent: refit * percent,
            visibility: base_error(&base, traces, tick_s) / noise,
            noise_floor,
            records: specs
                .iter()
                .zip(traces)
                .zip(gaps)
                .map(|((spec, trace), gap_force)| TruthRecord {
                    name: spec.name,
                    role: spec.role,
                    x: trace.y.clone(),
                    v: trace.y_rate.clone(),
                    load: trace.load.clone(),
                    gap_force,
                    seen: trace.seen.clone(),
                    torque: trace.torque.clone(),
                })
                .collect(),
        }
    }

    /// RMS of recorded minus true position (rad) over the recordings of that role. It is the score of the truth model
    /// itself, started from the true state and shaken by the true torque.
    pub fn own_error(&self, session: &Session, role: Role) -> f64 {
        let (mut squares, mut count) = (0.0, 0.0_f64);
        for (record, truth) in session.records.iter().zip(&self.records) {
            if truth.role == role {
                for (measured, x) in record.x.iter().zip(&truth.seen) {
                    squares += (measured - x).powi(2);
                    count += 1.0;
                }
            }
        }
        (squares / count.max(1.0)).sqrt()
    }
}

/// The named effect's parameters, by the table's symbols.
fn parameters(law: &ForceLaw, name: &str) -> Vec<(&'static str, f64)> {
    let wave = |w: Option<crate::law::Wave>, symbols: [&'static str; 3]| match w {
        Some(w) => symbols.into_iter().zip([w.a, w.n, w.phi]).collect(),
        None => Vec::new(),
    };
    match name {
        "constant_load" => vec![("bias", law.bias)],
        "asymmetric_viscous" => vec![("d", law.d_asym)],
        "stribeck" => law.stribeck.map_or(vec![], |s| vec![("s", s.s), ("vs", s.vs), ("p", s.p)]),
        "stiction" => vec![("s", law.stiction)],
        "dahl" | "lugre" => law.bristle.map_or(vec![], |b| {
            let mut list = vec![("sigma0", b.sigma0)];
            if let Some(s) = b.stribeck {
                list.extend([("sigma1", b.sigma1), ("s", s.s), ("vs", s.vs), ("p", s.p)]);
            }
            list
        }),
        "quadratic_drag" => vec![("k", law.drag)],
        "load_friction" => vec![("k", law.k_load)],
        "position_friction" => wave(law.friction_wave, ["k", "n", "phi"]),
        "cogging" => {
            let mut list = wave(law.cogging, ["A", "n", "phi"]);
            list.extend(wave(law.cogging2, ["A2", "n2", "phi2"]));
            list
        }
        "gravity_load" => law.gravity.map_or(vec![], |w| vec![("m", w.a), ("phi", w.phi)]),
        "spring" => law.spring.map_or(vec![], |(k, x0)| vec![("k", k), ("x0", x0)]),
        "end_stop" => law.stop.map_or(vec![], |(k, x0)| vec![("k", k), ("x0", x0)]),
        "time_periodic" => wave(law.periodic, ["A", "omega", "phi"]),
        "backlash" => law
            .second
            .map_or(vec![], |s| vec![("gap", s.gap), ("ratio", s.ratio), ("contact_k", s.k), ("contact_d", s.d)]),
        "flexible_coupling" => law.second.map_or(vec![], |s| vec![("ratio", s.ratio), ("k", s.k), ("d", s.d)]),
        "dead_zone" => vec![("d", law.dead_zone)],
        "saturation" => law.u_max.map_or(vec![], |u| vec![("u_max", u)]),
        "pwm_dead_time" => law.pwm.map_or(vec![], |p| vec![("d", p.d), ("i0", p.i0), ("Ke", p.ke)]),
        "delay" => vec![("tau", law.delay)],
        "electrical_lag" => vec![("tau", law.lag)],
        "encoder_eccentricity" => law.eccentricity.map_or(vec![], |w| vec![("A", w.a), ("phi", w.phi)]),
        "friction_drift" => law.friction_drift.map_or(vec![], |(s, t)| vec![("s", s), ("T", t)]),
        "gain_drift" => vec![("k", law.gain_drift)],
        "inertia_step" => law.inertia_step.map_or(vec![], |(t0, d)| vec![("t0", t0), ("delta", d)]),
        "force_well" => law.well.map_or(vec![], |(x, w, f)| vec![("centre", x), ("width", w), ("peak", f)]),
        "torque_bursts" => law.bursts.iter().map(|b| ("burst_at", b.0)).collect(),
        "velocity_ripple" => law.ripple.map_or(vec![], |(a, k)| vec![("A", a), ("k", k)]),
        "position_gain" => wave(law.position_gain, ["g", "n", "phi"]),
        _ => Vec::new(),
    }
}
