//! The monitor's screen, a pure function of its state.

use ratatui::buffer::Buffer;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style};
use ratatui::symbols::Marker;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Axis, Block, Chart, Dataset, GraphType, Paragraph, Widget};

use super::state::{Connection, Point, State, WINDOW_S};
use crate::device::text;
use breakaway_core::link::Mode;

const LABEL: Style = Style::new().fg(Color::DarkGray);
const KEYS: &str = " q quit   s stop   c clear fault   space freeze";
/// Smallest screen that holds everything.
const SMALLEST: (u16, u16) = (80, 24);

/// Draws the state into `area`. `plain` leaves out Braille.
pub fn draw(state: &State, plain: bool, area: Rect, buffer: &mut Buffer) {
    if area.width < SMALLEST.0 || area.height < SMALLEST.1 {
        let (width, height) = SMALLEST;
        let text = format!(
            "The monitor needs {width} × {height} characters, this terminal has {} × {}. q quits.",
            area.width, area.height
        );
        Paragraph::new(text).wrap(ratatui::widgets::Wrap { trim: true }).render(area, buffer);
        return;
    }
    let [title, numbers, position, drive, events, keys] = Layout::vertical([
        Constraint::Length(1),
        Constraint::Length(7),
        Constraint::Fill(3),
        Constraint::Fill(2),
        Constraint::Length(5),
        Constraint::Length(1),
    ])
    .areas(area);
    header(state, title, buffer);
    let [axis, link] = Layout::horizontal([Constraint::Fill(1), Constraint::Fill(1)]).areas(numbers);
    axis_numbers(state, axis, buffer);
    link_numbers(state, link, buffer);
    let units = &state.scale.units;
    let marker = if plain { Marker::Dot } else { Marker::Braille };
    let with_reference = !matches!(state.mode, Mode::Idle | Mode::Fault | Mode::Drive);
    let references: &[fn(&Point) -> f64] = if with_reference { &[|p| p.r] } else { &[] };
    curve(state, &format!("position, {}", units.x), |p| p.x, references, marker, position, buffer);
    curve(state, &format!("drive, {}", units.u), |p| p.u, &[], marker, drive, buffer);
    event_list(state, events, buffer);
    Paragraph::new(KEYS).style(LABEL).render(keys, buffer);
}

fn header(state: &State, area: Rect, buffer: &mut Buffer) {
    let text = format!(" breakaway monitor  {}  {}", state.title, state.port);
    // Cut by characters: a narrow screen must not cut one in two.
    let width = usize::from(area.width);
    let frozen = "  [frozen]";
    let text: String = if state.frozen {
        text.chars().take(width.saturating_sub(frozen.len())).chain(frozen.chars()).collect()
    } else {
        text.chars().take(width).collect()
    };
    Paragraph::new(text).style(Style::new().add_modifier(Modifier::REVERSED)).render(area, buffer);
}

fn row(label: &str, value: String, style: Style) -> Line<'_> {
    Line::from(vec![Span::styled(format!(" {label:<11}"), LABEL), Span::styled(value, style)])
}

fn axis_numbers(state: &State, area: Rect, buffer: &mut Buffer) {
    let units = &state.scale.units;
    let last = state.points.back();
    let number = |value: Option<f64>, unit: &str| value.map_or("-".to_owned(), |value| format!("{value:+.5} {unit}"));
    let (mode, style) = match (&state.connection, state.mode) {
        (Connection::Lost(_), _) => ("not connected", Style::new().fg(Color::Red).add_modifier(Modifier::BOLD)),
        (_, Mode::Fault) => ("FAULT", Style::new().fg(Color::Red).add_modifier(Modifier::BOLD)),
        (_, Mode::Idle) => ("idle", Style::new()),
        (_, mode) => (mode.name(), Style::new().fg(Color::Green).add_modifier(Modifier::BOLD)),
    };
    let status = state.status;
    let position = last.map(|p| p.x).or_else(|| status.map(|s| state.scale.position(s.count)));
    let drive = last.map(|p| p.u).or_else(|| status.map(|s| state.scale.drive(s.drive_code.into())));
    let lines = vec![
        row("mode", mode.to_owned(), style),
        row("position", number(position, &units.x), Style::new()),
        row("reference", number(last.map(|p| p.r), &units.x), Style::new()),
        row("velocity", number(state.velocity(), &format!("{}/s", units.x)), Style::new()),
        row("drive", number(drive, &units.u), Style::new()),
    ];
    Paragraph::new(lines).block(Block::bordered().title(" axis ")).render(area, buffer);
}

fn link_numbers(state: &State, area: Rect, buffer: &mut Buffer) {
    let totals = state.stream.totals;
    let (samples, bytes) = state.rates;
    let bad = |count: u64| if count == 0 { Style::new() } else { Style::new().fg(Color::Yellow) };
    let (late, unsaved) = state.status.map_or((0, false), |status| (u64::from(status.overruns), status.unsaved));
    let damaged_there = state.status.map_or(0, |status| u64::from(status.bad_frames));
    let lines = vec![
        row("rate", format!("{samples:.0} samples/s, {:.1} kB/s", bytes / 1000.0), Style::new()),
        row("missing", format!("{} samples, {} by the board", totals.missing, totals.dropped), bad(totals.missing)),
        row(
            "damaged",
            format!("{} frames here, {damaged_there} there", state.damaged),
            bad(state.damaged + damaged_there),
        ),
        row("late ticks", late.to_string(), bad(late)),
        row("unsaved", if unsaved { "settings or model" } else { "nothing" }.to_owned(), Style::new()),
    ];
    Paragraph::new(lines).block(Block::bordered().title(" link ")).render(area, buffer);
}

fn curve(
    state: &State,
    title: &str,
    value: fn(&Point) -> f64,
    more: &[fn(&Point) -> f64],
    marker: Marker,
    area: Rect,
    buffer: &mut Buffer,
) {
    let newest = state.points.back().map_or(0.0, |point| point.t);
    let line = |value: fn(&Point) -> f64| -> Vec<(f64, f64)> {
        state.points.iter().map(|point| (point.t - newest, value(point))).collect()
    };
    let curves: Vec<Vec<(f64, f64)>> = more.iter().copied().chain([value]).map(line).collect();
    let all = curves.iter().flatten().map(|point| point.1);
    let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    let (low, high) = if low < high {
        (low, high)
    } else if low == high {
        (low - 1.0, high + 1.0)
    } else {
        (-1.0, 1.0)
    };
    let datasets = curves
        .iter()
        .enumerate()
        .map(|(i, points)| {
            let color = if i + 1 == curves.len() { Color::Cyan } else { Color::DarkGray };
            Dataset::default().marker(marker).graph_type(GraphType::Line).style(Style::new().fg(color)).data(points)
        })
        .collect();
    let margin = 0.02 * (high - low);
    Chart::new(datasets)
        .block(Block::bordered().title(format!(" {title}, last {WINDOW_S} s ")))
        .x_axis(Axis::default().bounds([-WINDOW_S, 0.0]))
        .y_axis(
            Axis::default()
                .style(LABEL)
                .bounds([low - margin, high + margin])
                .labels([format!("{low:>9.3}"), format!("{high:>9.3}")]),
        )
        .legend_position(None)
        .render(area, buffer);
}

fn event_list(state: &State, area: Rect, buffer: &mut Buffer) {
    let lost = Style::new().fg(Color::Red).add_modifier(Modifier::BOLD);
    let height = usize::from(area.height.saturating_sub(2));
    let block = Block::bordered();
    let (title, text, style) = match (&state.connection, &state.fault) {
        (Connection::Lost(reason), _) => (" waiting for the board ", vec![reason.clone()], lost),
        (Connection::Up, Some(fault)) => {
            (" fault (c clears it) ", vec![format!("{}: {}", text::cause_name(fault.cause), text::fault(fault))], lost)
        }
        (Connection::Up, None) => {
            let first = state.events.len().saturating_sub(height);
            (" events ", state.events.iter().skip(first).cloned().collect(), Style::new())
        }
    };
    Paragraph::new(text.join("\n"))
        .style(style)
        .wrap(ratatui::widgets::Wrap { trim: true })
        .block(block.title(title))
        .render(area, buffer);
}
