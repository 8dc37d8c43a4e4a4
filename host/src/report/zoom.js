// Reads values off the curves and enlarges a range of them. The page is complete without it: it asks for nothing outside.
// A figure's panels say in `data-x` and `data-y` what their edges stand for; a curve is a path with a `data-label`.
'use strict';
(() => {
const links = new Map(); // Figures over the same x, at both widths: one range for all of them.
const decimals = step => Math.max(0, Math.min(12, Math.ceil(-Math.log10(step) - 1e-9)));
const text = (value, step) => (Math.abs(value) < step / 2 ? 0 : value).toFixed(decimals(step)).replace('-', '−');

// An axis: the value at a share of its length, and ticks between two shares.
function axis(json) {
  const [kind, low, high, unit, name] = JSON.parse(json);
  const log = kind === 'log', span = Math.log(high / low);
  const at = share => log ? low * Math.exp(share * span) : low + share * (high - low);
  const place = value => log ? Math.log(value / low) / span : (value - low) / (high - low);
  const ticks = (a, b, count) => {
    const [from, to] = [at(a), at(b)], rough = (to - from) / count, decade = 10 ** Math.floor(Math.log10(rough));
    if (log && to / from > 10) {
      const powers = Array.from({ length: 40 }, (_, i) => 10 ** (Math.floor(Math.log10(from)) + i));
      return powers.filter(v => v >= from && v <= to).map(v => [place(v), text(v, v)]);
    }
    const step = decade * [1, 2, 2.5, 5, 10].find(m => m * decade >= 0.9 * rough), first = Math.ceil(from / step - 1e-9);
    const fine = decimals(step) < decimals(step / 10) && step / decade === 2.5 ? step / 10 : step;
    return Array.from({ length: Math.floor(to / step + 1e-9) - first + 1 }, (_, i) => (first + i) * step)
      .map(v => [place(v), text(v, fine)]);
  };
  const told = (share, range) => `${text(at(share), Math.max(Math.abs(at(share + range / 1000) - at(share)), 1e-12))} ${unit}`;
  return { kind, names: low, name, unit, at, ticks, told };
}

// A panel: its rectangle, its axes, and what is drawn in it, in shares of both axes from the lower left.
function panel(plot) {
  const box = plot.viewBox.baseVal, [left, top, width, height] = [box.x, box.y + 2, box.width, box.height - 4];
  const x = axis(plot.dataset.x), y = axis(plot.dataset.y);
  const share = (px, py) => [(px - left) / width, (top + height - py) / height];
  const shapes = [...plot.querySelectorAll('path,circle,rect')].map(node => {
    const number = name => Number(node.getAttribute(name));
    if (node.tagName === 'path') {
      const points = [...node.getAttribute('d').matchAll(/([MLZ])(?:([-\d.]+) ([-\d.]+))?/g)];
      return { node, points: points.map(([, pen, px, py]) => [pen, ...(pen === 'Z' ? [] : share(Number(px), Number(py)))]) };
    }
    if (node.tagName === 'circle') return { node, centre: share(number('cx'), number('cy')) };
    const [a, b, w, h] = ['x', 'y', 'width', 'height'].map(number);
    if (/^(band|column)/.test(node.getAttribute('class'))) return { node, area: [...share(a, b + h), ...share(a + w, b)] };
    return { node, centre: share(a + w / 2, b + h / 2), size: [w, h] };
  });
  const curves = shapes.filter(shape => shape.node.dataset.label && shape.points).map(shape => {
    const points = shape.points.filter(([pen]) => pen !== 'Z');
    return { ...shape, points, runs: points.every((p, i) => i === 0 || p[1] >= points[i - 1][1]) };
  });
  return { plot, left, top, width, height, x, y, shapes, curves, plane: curves.some(curve => !curve.runs), marks: [] };
}

// The value of a curve at a share of x; in a plane the point next to the pointer.
function value(p, curve, at, view) {
  if (!curve.runs) {
    const far = q => Math.hypot((q[1] - at[0]) / (view.b - view.a) * p.width, (q[2] - at[1]) / (view.d - view.c) * p.height);
    const next = curve.points.reduce((best, q) => far(q) < far(best) ? q : best);
    return far(next) < 40 ? [next[1], next[2]] : null;
  }
  const end = curve.points.findIndex(q => q[1] >= at[0]), [q, r] = [curve.points[end - 1], curve.points[end]];
  if (end < 0 || (end === 0 && r[1] > at[0] + 1e-6)) return null;
  if (end === 0 || r[1] === at[0]) return [r[1], r[2]];
  return r[0] === 'M' ? null : [at[0], q[2] + (r[2] - q[2]) * (at[0] - q[1]) / (r[1] - q[1])];
}

// What a panel shows of y: everything at first; enlarged, what the curves reach between the ends of x.
function reach(p, view) {
  if (p.plane || p.x.kind === 'words' || (view.a === 0 && view.b === 1)) return view;
  const inside = p.curves.flatMap(curve => [...curve.points.filter(q => q[1] >= view.a && q[1] <= view.b),
    ...[view.a, view.b].map(a => value(p, curve, [a], view)).filter(Boolean).map(v => ['L', ...v])]).map(q => q[2]);
  if (!inside.length) return view;
  const [low, high] = [inside.reduce((m, v) => Math.min(m, v)), inside.reduce((m, v) => Math.max(m, v))];
  const room = 0.07 * (high - low) || 0.02;
  return { ...view, c: low - room, d: high + room };
}

function draw(p, range) {
  const view = p.view = reach(p, range), whole = view.a === 0 && view.b === 1 && view.c === 0 && view.d === 1;
  const px = a => p.left + Math.max(-20, Math.min(20, (a - view.a) / (view.b - view.a))) * p.width;
  const py = c => p.top + p.height - Math.max(-20, Math.min(20, (c - view.c) / (view.d - view.c))) * p.height;
  const set = (node, values) => Object.entries(values).forEach(([name, v]) => node.setAttribute(name, v));
  for (const { node, points, centre, area, size: [w, h] = [] } of p.shapes) {
    if (points) set(node, { d: points.map(([pen, a, c]) => pen === 'Z' ? pen : `${pen}${px(a).toFixed(2)} ${py(c).toFixed(2)}`).join('') });
    else if (area) set(node, { x: px(area[0]), y: py(area[3]), width: px(area[2]) - px(area[0]), height: py(area[1]) - py(area[3]) });
    else if (w) set(node, { x: px(centre[0]) - w / 2, y: py(centre[1]) - h / 2 });
    else set(node, { cx: px(centre[0]), cy: py(centre[1]) });
  }
  p.px = px; p.py = py;
  for (const [name, horizontal] of [['x', true], ['y', false]]) {
    const group = p.plot.parentNode.querySelector(`.${name}-ticks`);
    if (!group) continue;
    p[`${name}Whole`] ??= group.innerHTML;
    if (whole) { group.innerHTML = p[`${name}Whole`]; continue; }
    const labels = p[`${name}Whole`].includes('<text'), bottom = p.top + p.height, right = p.left + p.width;
    const ticks = horizontal ? p.x.ticks(view.a, view.b, p.width / 85) : p.y.ticks(view.c, view.d, Math.max(3, p.height / 45));
    group.innerHTML = ticks.map(([share, label]) => horizontal
      ? `<path class="grid" d="M${px(share)} ${p.top}V${bottom}"/>${labels ? `<text class="tick" x="${px(share)}" y="${bottom + 17}" text-anchor="${px(share) > right - 8 ? 'end' : 'middle'}">${label}</text>` : ''}`
      : `<path class="grid" d="M${p.left} ${py(share)}H${right}"/><text class="tick" x="${p.left - 6}" y="${py(share) + 4}" text-anchor="end">${label}</text>`).join('');
  }
}

function figure(svg) {
  const panels = [...svg.querySelectorAll('svg.plot[data-x]')].map(panel), holder = svg.parentNode;
  if (!panels.length) return;
  const [first, last] = [panels[0], panels[panels.length - 1]], words = first.x.kind === 'words';
  const key = words || first.plane ? svg : first.plot.dataset.x;
  const range = links.get(key) ?? { a: 0, b: 1, c: 0, d: 1, draws: [] };
  links.set(key, range);
  const add = (parent, name, className) => {
    const node = parent.appendChild(document.createElementNS(parent.namespaceURI, name));
    node.setAttribute('class', className);
    return node;
  };
  const [out, whole] = [add(holder, 'div', 'readout'), add(holder, 'button', 'whole')];
  whole.textContent = 'whole range';
  out.setAttribute('role', 'status');
  out.hidden = true;
  svg.tabIndex = 0;
  if (!words) svg.style.touchAction = 'pan-y';
  let at = null, down = null;
  range.draws.push(() => {
    panels.forEach(p => draw(p, range));
    whole.hidden = range.b - range.a === 1 && range.d - range.c === 1;
    if (at) tell();
  });
  const show = (a, b, c = 0, d = 1) => {
    if (words || b - a < 1e-4 || d - c < 1e-4) return;
    Object.assign(range, { a: Math.max(0, a), b: Math.min(1, b), c: Math.max(0, c), d: Math.min(1, d) });
    range.draws.forEach(redraw => redraw());
  };
  const clear = () => panels.forEach(p => p.marks.splice(0).forEach(node => node.remove()));
  const mark = (p, name, className, attributes) => {
    const node = add(p.plot, name, className);
    Object.entries(attributes).forEach(([attribute, v]) => node.setAttribute(attribute, v));
    p.marks.push(node);
    return node;
  };
  const row = (content, colour) => {
    const node = add(out, 'div', 'row');
    if (colour) add(node, 'i', '').style.background = colour;
    node.append(content);
  };
  function tell() { // The values at `at`: a share of x, and of y for the panel of a plane.
    clear();
    out.replaceChildren();
    const names = first.x.names, i = words ? Math.max(0, Math.min(names.length - 1, Math.floor(at[0] * names.length))) : 0;
    const where = words ? [(i + 0.5) / names.length, at[1]] : at;
    if (words) row(names[i]);
    else if (!first.plane) row(`${first.x.name} ${first.x.told(where[0], range.b - range.a)}`);
    for (const p of panels) {
      if (panels.length > 1 && p.curves.length > 1) row(p.y.name);
      if (!p.plane) mark(p, 'path', 'cursor', { d: `M${p.px(where[0])} ${p.top}V${p.top + p.height}` });
      for (const curve of p.curves) {
        const v = value(p, curve, where, p.view), label = curve.node.dataset.label;
        if (!v) continue;
        const colour = getComputedStyle(curve.node).stroke, y = p.y.told(v[1], p.view.d - p.view.c);
        mark(p, 'circle', 'spot', { cx: p.px(v[0]), cy: p.py(v[1]), r: 4 }).style.fill = colour;
        if (p.plane) row(`${label}: ${p.x.name} ${p.x.told(v[0], p.view.b - p.view.a)}, ${p.y.name} ${y}`, colour);
        else row(`${label}: ${y}`, colour);
      }
    }
    out.hidden = !out.childNodes.length;
    const scale = svg.clientWidth / svg.viewBox.baseVal.width, x = first.px(where[0]) * scale, right = x < svg.clientWidth / 2;
    Object.assign(out.style, { top: `${first.top * scale}px`, left: right ? `${x + 14}px` : 'auto', right: right ? 'auto' : `${svg.clientWidth - x + 14}px` });
  }
  const hide = () => { at = null; out.hidden = true; clear(); };
  const point = event => { // The panel under the pointer, and the shares of its axes.
    const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    const p = panels.find(q => y <= q.top + q.height + 20) ?? last, { a, b, c, d } = p.view;
    const part = share => Math.max(0, Math.min(1, share));
    return [a + part((x - p.left) / p.width) * (b - a), c + part((p.top + p.height - y) / p.height) * (d - c), p];
  };
  svg.addEventListener('pointerdown', event => {
    at = point(event);
    tell();
    if (event.button || words) return;
    down = at;
    svg.setPointerCapture(event.pointerId);
  });
  svg.addEventListener('pointermove', event => {
    at = point(event);
    tell();
    if (!down) return;
    for (const p of first.plane ? [down[2]] : panels) {
      const [from, to] = [Math.min(down[0], at[0]), Math.max(down[0], at[0])].map(p.px);
      const [low, high] = first.plane ? [Math.max(down[1], at[1]), Math.min(down[1], at[1])].map(p.py) : [p.top, p.top + p.height];
      mark(p, 'rect', 'chosen', { x: from, y: low, width: to - from, height: high - low });
    }
  });
  svg.addEventListener('pointerup', event => {
    const [from, to] = [down, point(event)];
    down = null;
    if (!from || Math.abs(first.px(from[0]) - first.px(to[0])) < 6) return;
    const y = first.plane && Math.abs(first.py(from[1]) - first.py(to[1])) >= 6 ? [Math.min(from[1], to[1]), Math.max(from[1], to[1])] : [];
    show(Math.min(from[0], to[0]), Math.max(from[0], to[0]), ...y);
  });
  svg.addEventListener('pointercancel', () => { down = null; });
  // A finger that is lifted leaves what it pointed at.
  svg.addEventListener('pointerleave', event => { if (!down && event.pointerType !== 'touch') hide(); });
  document.addEventListener('pointerdown', event => { if (!svg.contains(event.target)) hide(); });
  svg.addEventListener('blur', hide);
  svg.addEventListener('dblclick', () => show(0, 1));
  whole.addEventListener('click', () => { show(0, 1); svg.focus(); });
  svg.addEventListener('keydown', event => {
    const { a, b } = range, wide = b - a, step = wide * (event.shiftKey ? 0.1 : 0.01) * (words ? 25 : 1);
    const now = at ?? [a + wide / 2, 0.5];
    const about = factor => show(now[0] - (now[0] - a) * factor, now[0] + (b - now[0]) * factor);
    const move = by => { at = [Math.max(a, Math.min(b, now[0] + by)), now[1]]; tell(); };
    const keys = {
      ArrowLeft: () => move(-step), ArrowRight: () => move(step), '+': () => about(0.5), '=': () => about(0.5),
      '-': () => about(2), 0: () => show(0, 1), Escape: () => { show(0, 1); hide(); },
    };
    if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
  });
  range.draws.forEach(redraw => redraw());
}

const figures = [...document.querySelectorAll('figure svg[role=img]')];
figures.forEach(figure);
const hint = document.createElement('p');
hint.className = 'note hint';
hint.textContent = 'Point at a figure to read its values. Drag to enlarge a range; a double click shows all again. '
  + 'On the keyboard: Tab to a figure, then arrows, +, − and Esc.';
if (links.size) document.querySelector('figure')?.before(hint);
})();
