//! `docs/adaptive.md` and its figures, from the simulations of [`adaptive`](crate::adaptive).

use std::fmt::Write as _;

use breakaway::report::figure::{Figure, Ink, Series, Strip, stack};
use breakaway_core::control::Estimates;

use crate::adaptive::{FIGURES, Loop, Moment, PAPER, rms};
use crate::markdown::wrapped;

/// A file of the documentation: its name under `docs/`, and its text.
pub type File = (String, String);

/// How long the figures' loops are run, s.
const SECONDS: f64 = 60.0;
/// Windows of the table, s.
const WINDOWS: [(f64, f64); 4] = [(0.0, 5.0), (5.0, 10.0), (10.0, 20.0), (40.0, 60.0)];

/// The page and its figures.
pub fn files() -> Vec<File> {
    let runs = FIGURES.map(|(number, start)| (number, Loop::figure(start).run(SECONDS)));
    let experiment = Experiment::run();
    let mut files: Vec<File> = runs
        .iter()
        .map(|(number, run)| (format!("images/adaptive-figure-{number}.svg"), first_seconds(*number, run).file()))
        .collect();
    files.push(("images/adaptive-later.svg".into(), later(&runs).file()));
    files.push(("images/adaptive-experiment.svg".into(), experiment.figure().file()));
    files.push(("adaptive.md".into(), wrapped(&page(&runs, &experiment))));
    files
}

fn column(run: &[Moment], seconds: (f64, f64), value: impl Fn(&Moment) -> f64) -> Vec<f64> {
    run.iter().filter(|m| (seconds.0..seconds.1).contains(&m.t)).map(value).collect()
}

/// The starting estimates in words.
const fn started(number: u32) -> &'static str {
    match number {
        8 => "all estimates start at zero",
        9 => "estimates start at half of the parameters",
        _ => "estimates start near the parameters",
    }
}

fn first_seconds(number: u32, run: &[Moment]) -> Figure {
    let span = (0.0, 5.0);
    // A drawing 800 pixels wide shows no more.
    let drawn: Vec<Moment> = run.iter().step_by(5).copied().collect();
    let t = column(&drawn, span, |m| m.t);
    let reference = column(&drawn, span, |m| m.reference);
    let position = column(&drawn, span, |m| m.reference - m.error);
    let error = column(&drawn, span, |m| m.error);
    let strips = [
        Strip {
            quantity: "position",
            unit: "m",
            height: 150.0,
            series: vec![
                Series { ink: Ink::Measured, label: "reference", y: &reference },
                Series { ink: Ink::After, label: "axis", y: &position },
            ],
            band: None,
            held: false,
        },
        Strip {
            quantity: "tracking error",
            unit: "m",
            height: 120.0,
            series: vec![Series { ink: Ink::Drive, label: "error", y: &error }],
            band: None,
            held: false,
        },
    ];
    let caption = format!(
        "As the paper's Fig. {number}: {}. RMS of the error over the first 5 s {:.1} mm.",
        started(number),
        1e3 * rms(run, 0.0, 5.0)
    );
    Figure::new(format!("Adaptive control, Fig. {number}"), caption, |width| stack(width, &t, &strips))
}

/// RMS of the error in each period of the sine, over a minute, on one scale.
fn later(runs: &[(u32, Vec<Moment>)]) -> Figure {
    let periods: Vec<f64> = (0..SECONDS as usize).map(|k| k as f64 + 0.5).collect();
    let curves: Vec<Vec<f64>> =
        runs.iter().map(|(_, run)| periods.iter().map(|t| rms(run, t - 0.5, t + 0.5).log10()).collect()).collect();
    let series = |i: usize, ink, label| Series { ink, label, y: &curves[i] };
    let strips = [Strip {
        quantity: "log10 of the error's RMS in m, per period",
        unit: "",
        height: 240.0,
        series: vec![
            series(0, Ink::Floor, "Fig. 8 (zeros)"),
            series(1, Ink::Before, "Fig. 9 (half)"),
            series(2, Ink::After, "Fig. 10 (near)"),
        ],
        band: None,
        held: false,
    }];
    let caption = "The same three loops for a minute. The order of the first 5 s does not last.";
    Figure::new("What happens later", caption, |width| stack(width, &periods, &strips))
}

/// Section 6, with and without compensation and with f̂1 off.
struct Experiment {
    without: Vec<Moment>,
    exact: Vec<Moment>,
    /// f̂1 over f1, and settled RMS, mm.
    sensitivity: Vec<(f64, f64)>,
    /// Amplitude (mm), frequency (Hz), settled RMS without and with, mm.
    motions: Vec<(f64, f64, f64, f64)>,
}

/// When the start has faded (the law's slow pole is at Λ1/Λ2), s.
const SETTLED: (f64, f64) = (5.0, 15.0);

impl Experiment {
    fn settled(scale: f64, sine: (f64, f64)) -> (Vec<Moment>, f64) {
        let mut rig = Loop { sine, ..Loop::experiment() };
        rig.start.f1 *= scale;
        let w = std::f64::consts::TAU * sine.1;
        rig.adaptation.speed = sine.0 * w;
        rig.adaptation.acceleration = sine.0 * w * w;
        if scale == 0.0 {
            rig.adaptation.gains = Estimates::default();
        }
        let run = rig.run(SETTLED.1);
        let error = rms(&run, SETTLED.0, SETTLED.1);
        (run, error)
    }

    fn run() -> Self {
        let sine = Loop::experiment().sine;
        Self {
            without: Self::settled(0.0, sine).0,
            exact: Self::settled(1.0, sine).0,
            sensitivity: [0.0, 0.5, 0.8, 0.9, 0.95, 1.0, 1.05, 1.1, 1.2]
                .map(|scale| (scale, Self::settled(scale, sine).1))
                .into(),
            motions: [(1.0, 0.5), (2.0, 0.5), (1.0, 1.0), (2.0, 1.0), (5.0, 1.0), (2.0, 2.0), (5.0, 2.0)]
                .map(|(a, f)| (a, f, Self::settled(0.0, (a, f)).1, Self::settled(1.0, (a, f)).1))
                .into(),
        }
    }

    fn figure(&self) -> Figure {
        let span = (12.0, 15.0);
        let t = column(&self.exact, span, |m| m.t);
        // In m, so that the axis can choose its prefix.
        let [without, exact] = [&self.without, &self.exact].map(|run| column(run, span, |m| 1e-3 * m.error));
        let off = column(&Self::settled(0.8, Loop::experiment().sine).0, span, |m| 1e-3 * m.error);
        let strip =
            |series| Strip { quantity: "tracking error", unit: "m", height: 110.0, series, band: None, held: false };
        let strips = [
            strip(vec![Series { ink: Ink::Before, label: "without compensation", y: &without }]),
            strip(vec![Series { ink: Ink::Drive, label: "compensated, f1 off by 20 %", y: &off }]),
            strip(vec![Series { ink: Ink::After, label: "compensated, exact parameters", y: &exact }]),
        ];
        let caption = "The motor of section 6 following 2 mm at 1 Hz, exact velocity, a tick of 0.2 ms.";
        Figure::new("The experiment of section 6, simulated", caption, |width| stack(width, &t, &strips))
    }
}

fn page(runs: &[(u32, Vec<Moment>)], experiment: &Experiment) -> String {
    let mut out = String::new();
    // Here and below, writing to a String cannot fail.
    let _ = write!(
        out,
        "# The adaptive controller

The law is `breakaway_core::control::Adaptive` (derivation, errata and proof: [theory.md](theory.md), section 6). This page is written by its test
(`BREAKAWAY_BLESS=1 cargo test -p breakaway-tests --test all pages::`); every number and figure below comes from the core's own law on the event-exact plant.

What differs from the paper's eqs 22–31, beyond the errata:

| change | why |
|---|---|
| â and f̂2 are one estimate, ĉ = f̂2 − â | they multiply the same velocity; no data tell them apart, and one gain kc = ka + kf2 does what two did |
| b_min ≤ b̂ ≤ b_max; f̂1, ĉ, f̂ ≥ 0 | projection: an estimate outside its physical range only costs time, and above b_max = b·0.8/((1 + d)·(Kv + Λ2)·Ts) the sampled loop leaves what tick and delay allow |
| f̂' = kf·(\\|s_Δ\\| − σ·f̂) | without the leak f̂ only ever rises |
| adaptation frozen while the drive is saturated, and ∫e taken back by what is cut off | see *Saturation* below |
| k_i in proportion to the parameters' squares | equal relative speed; the paper's k = 10⁻² for all lets b̂ run away |
| Kv·s within δ, as an option | the paper's Kv·s_Δ is no control at all within δ (erratum 33); s·s_Δ ≥ s_Δ² keeps the proof |
| ė from x_d − x, sgn of ẋ_d | differentiating the encoder alone costs most of what compensation gains |

Gains are refused past (Kv + Λ2)·Ts ≤ 0.8/(1 + d) for d ticks of delay, and \\|φ_i\\|·√(k_i/b)·Ts ≤ 0.1, each with the largest that is allowed.

## Figs 8, 9 and 10

The paper gives the plant (a = −10.5, b = {}, f = 10 N = {} V, errata 24 and 25) and the starting estimates, but neither gains nor reference. Ours: x_d = 0.3 m · sin 2πt,
Λ1 = 25, Λ2 = 10, Kv = 10, δ = 0.02 m/s, k = (b .001, c 2, f1 1, f 1), a tick of 1 ms, exact velocity.

![Fig. 8](images/adaptive-figure-8.svg)
![Fig. 9](images/adaptive-figure-9.svg)
![Fig. 10](images/adaptive-figure-10.svg)

RMS of the tracking error, mm:

| |",
        PAPER.b, PAPER.f1
    );
    for (from, to) in WINDOWS {
        let _ = write!(out, " {from}–{to} s |");
    }
    out.push_str("\n|---|---|---|---|---|\n");
    for (number, run) in runs {
        let _ = write!(out, "| Fig. {number}: {} |", started(*number));
        for (from, to) in WINDOWS {
            let _ = write!(out, " {:.2} |", 1e3 * rms(run, from, to));
        }
        out.push('\n');
    }
    let _ = write!(
        out,
        "
Over the first 5 s the order is the paper's: good starting values track better from the start, zeros worst (row 16 of the acceptance numbers).

**What the paper does not show is the time after.** ![later](images/adaptive-later.svg)

The loops with the bad start adapted more, because they had more error to adapt from. After that they track no worse than the one with the good start, and for a while better. All three end with small errors and *wrong parameters*:

| after {SECONDS:.0} s | b̂ | ĉ | f̂1 | f̂ |
|---|---|---|---|---|
| plant | {} | {} | {} | – |
",
        PAPER.b, PAPER.c, PAPER.f1
    );
    for (number, run) in runs {
        let e = run.last().map_or_else(Estimates::default, |moment| moment.estimates);
        let _ = writeln!(out, "| Fig. {number} | {:.3} | {:.2} | {:.2} | {:.2} |", e.b, e.c, e.f1, e.f);
    }
    out.push_str(
        "
The proof promises no more: it bounds the estimates and drives \\|s\\| to δ. Within δ nothing adapts. And a sine of one frequency cannot separate ĉ·v, f̂1·sgn v and f̂.
The adaptive law is a way to track, not a way to identify. Identify first (`breakaway identify`), start from that, and let it adapt slowly.

## Saturation

The same loops run for 30 s with ten times the adaptation gains and the drive limited to ±5 V; the motion needs 22 V. The table has the largest b̂; the plant's is 0.1429.

| | frozen in saturation | not frozen |
|---|---|---|
",
    );
    for (number, start) in FIGURES {
        let largest = |freeze: bool| {
            let mut saturated = Loop { limit: 5.0, freeze, ..Loop::figure(start) };
            let k = &mut saturated.adaptation.gains;
            *k = Estimates { b: 10.0 * k.b, c: 10.0 * k.c, f1: 10.0 * k.f1, f: 10.0 * k.f };
            saturated.run(30.0).iter().map(|m| m.estimates.b).fold(0.0, f64::max)
        };
        let _ = writeln!(out, "| Fig. {number} | {:.3} | {:.1} |", largest(true), largest(false));
    }
    let ratio = |without: f64, with: f64| format!("{:.1}", without / with);
    out.push_str(
        "
## The experiment of section 6, as a demonstration

The paper reports 11.2 µm without friction compensation and 1.01 µm with it, a factor of 11. The motor has Kp = 192.59 mm/s per V, Tp = 0.073454 s, f1 = 0.238 V (units: errata 26, 34). The law has Kv = 1200, Λ1 = 600, Λ2 = 1400, δ = 10. Amplitude and frequency are not given. Simulated in mm with a tick of 0.2 ms and exact velocity, settled (5–15 s):

![section 6](images/adaptive-experiment.svg)

| amplitude, frequency | without, µm | exact parameters, µm | ratio |
|---|---|---|---|
",
    );
    for (amplitude, frequency, without, with) in &experiment.motions {
        let _ = writeln!(
            out,
            "| {amplitude} mm, {frequency} Hz | {:.2} | {:.2} | {} |",
            1e3 * without,
            1e3 * with,
            ratio(*without, *with)
        );
    }
    out.push_str(
        "
So a factor of this size is possible, **if the parameters are exact and the velocity is**. The next table shows the rest of it when f̂1 is not exact (2 mm, 1 Hz):

| f̂1/f1 | error, µm | ratio to none |
|---|---|---|
",
    );
    let none = experiment.sensitivity.first().map_or(f64::NAN, |(_, error)| *error);
    for (scale, error) in &experiment.sensitivity {
        let _ = writeln!(out, "| {scale} | {:.2} | {} |", 1e3 * error, ratio(none, *error));
    }
    out.push_str(
        "
An error of 10 % of f1 takes most of the gain away and 20 % nearly all of it. The reason is δ. Any uncompensated friction, however small, pushes s to the edge of the band ±δ = ±10 mm/s. There the error is about δ/Λ2 = 7 µm. The error is small only if the compensation keeps s well within δ. We do not claim the factor of 11, because it depends on δ and the motion as much as on friction.
",
    );
    out.push_str(&crate::adaptive_default::section());
    out
}
