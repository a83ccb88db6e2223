/* SPDX-License-Identifier: BSD-3-Clause */
/* Charts with two axes: columns, lines and points. The style sheet defines the colours, so that
   charts change with the theme and are printed in light colours. */

const SERIES = 7; /* number of colours, dash patterns and markers; series 7 has those of series 0 */
const colour_of = k => 'var(--series-' + (k % SERIES) + ')';
const DASHES = ['', '7 3', '2 2', '9 3 2 3', '12 4', '4 4', '1 3'];

/* Outlines of the markers, each about 2 units wide. */
const MARKERS = ['M1 0A1 1 0 1 1 -1 0A1 1 0 1 1 1 0Z', 'M-.9 -.9H.9V.9H-.9Z', 'M0 -1.2L1.1 .8H-1.1Z',
  'M0 -1.3L1.1 0L0 1.3L-1.1 0Z', 'M-1 -1L1 1M-1 1L1 -1', 'M0 -1.2V1.2M-1.2 0H1.2', 'M0 1.2L1.1 -.8H-1.1Z'];
const marker = (k, x, y, size) => svg('path', {d: MARKERS[k % SERIES], class: 'marker',
  transform: `translate(${x.toFixed(1)} ${y.toFixed(1)}) scale(${size})`, style: 'stroke:' + colour_of(k)});

/* ---- axes ---- */

/* Return { place, marks } of an axis: place(v) is the coordinate of the value v, in pixels
   between `from` and `to`; `marks` are the values of the grid lines. */
function scale(axis, from, to) {
  const f = axis.log ? Math.log10 : v => v;
  const low = f(axis.low), high = f(axis.high);
  const place = v => from + (f(v) - low) / (high - low || 1) * (to - from);
  if (!axis.log) return {place, marks: axis.marks || ticks(axis.low, axis.high, axis.wanted || 5)};
  const marks = [], wide = high - low > 2.5;
  for (let p = Math.floor(low); p <= high; p++)
    for (const m of wide ? [1] : [1, 2, 5])
      if (m * 10 ** p >= axis.low * 0.999 && m * 10 ** p <= axis.high * 1.001)
        marks.push(Number((m * 10 ** p).toPrecision(6)));
  return {place, marks};
}

/* Return the figure of a chart { title, about, x, y, width, height, draw }. An axis is
   { label, low, high, log }. A y axis with `bare` has no marks and a margin of `bare` pixels.
   draw(plot) appends shapes to plot.body, by the functions plot.x and plot.y from values to
   pixels. */
function chart(c) {
  const width = c.width || 360, height = c.height || 230;
  const left = c.y.bare || 52, right = 18, top = 8, bottom = 38;
  const x = scale(c.x, left, width - right), y = scale(c.y, height - bottom, top);
  const body = svg('g'), axes = svg('g', {class: 'axes'});
  for (const v of x.marks)
    axes.append(svg('path', {d: `M${x.place(v)} ${top}V${height - bottom}`}),
      svg('text', {x: x.place(v), y: height - bottom + 14, 'text-anchor': 'middle'}, number(v)));
  for (const v of c.y.bare ? [] : y.marks)
    axes.append(svg('path', {d: `M${left} ${y.place(v)}H${width - right}`}),
      svg('text', {x: left - 5, y: y.place(v) + 4, 'text-anchor': 'end'}, number(v)));
  axes.append(svg('path', {class: 'base', d: `M${left} ${height - bottom}H${width - right}`}),
    svg('text', {class: 'label', x: (left + width - right) / 2, y: height - 5, 'text-anchor': 'middle'}, c.x.label));
  if (!c.y.bare)
    axes.append(svg('text', {class: 'label', 'text-anchor': 'middle',
      transform: `translate(12 ${(top + height - bottom) / 2}) rotate(-90)`}, c.y.label));
  c.draw({x: x.place, y: y.place, body, left, right: width - right, top, bottom: height - bottom});
  const picture = svg('svg', {viewBox: `0 0 ${width} ${height}`, role: 'img',
    'aria-label': c.title + '. ' + (c.about || '')}, axes, body);
  return el('figure', {class: 'chart'}, el('figcaption', null, c.title), picture,
    c.about ? el('p', {class: 'about'}, c.about) : null);
}

/* Return the legend of the series: colour, dash pattern and marker of each name. */
function legend(names) {
  return el('ul', {class: 'legend'}, names.map((name, k) => el('li', null,
    svg('svg', {viewBox: '0 0 34 12', width: 34, height: 12, 'aria-hidden': 'true'},
      svg('path', {class: 'line', d: 'M1 6H33', style: 'stroke:' + colour_of(k), 'stroke-dasharray': DASHES[k % SERIES]}),
      marker(k, 17, 6, 3.5)), ' ', name)));
}

/* ---- kinds of charts ---- */

const BINS = 41;
function counts(values, range) {
  const out = new Array(BINS).fill(0);
  values.forEach((v, i) => {
    out[Math.max(0, Math.min(BINS - 1, Math.floor((v / range + 1) / 2 * BINS)))] += values.n ? values.n[i] : 1;
  });
  return out;
}

/* Draw the histogram of values over -range .. range as columns, and that of `before`
   as a line if more than half of its values are in the range. Values outside of the
   range are counted in the outer columns, and the text below the chart states their number. */
function histogram(title, unit, k, values, before, range) {
  const in_range = before.filter(v => Math.abs(v) <= range).length;
  const bars = counts(values, range), line = 2 * in_range > before.length ? counts(before, range) : null;
  const high = Math.max(1, ...bars), beyond = values.reduce((a, v, i) => a + (Math.abs(v) > range ? (values.n ? values.n[i] : 1) : 0), 0);
  const about = values.length ? `${number(total(values))} transistors, mean ${number(mean(values))} ${unit}, ` +
    `standard deviation ${number(stdv(values))} ${unit}` +
    (beyond ? `; ${number(beyond)} beyond ±${number(range)} ${unit}` : '') +
    (before.length ? `. As drawn: mean ${number(mean(before))} ${unit}, standard deviation ${number(stdv(before))} ${unit}` +
      (line ? ', dashed' : '') : '') : 'no transistor';
  return chart({title, about, height: 170, x: {label: unit, low: -range, high: range, wanted: 4},
    y: {label: 'transistors', low: 0, high, wanted: 3},
    draw: p => {
      const wide = (p.right - p.left) / BINS;
      bars.forEach((n, i) => n && p.body.append(svg('rect', {class: 'bar', x: p.left + i * wide + 0.4,
        y: p.y(n), width: wide - 0.8, height: p.bottom - p.y(n), style: 'fill:' + colour_of(k)})));
      if (!line) return;
      let d = `M${p.left} ${p.bottom}`;
      line.forEach((n, i) => { d += `V${p.y(Math.min(n, high)).toFixed(1)}H${(p.left + (i + 1) * wide).toFixed(1)}`; });
      p.body.append(svg('path', {class: 'before', d: d + `V${p.bottom}`}));
    }});
}

/* Return a chart of lines with a marker at each point. A series is { k, points: [[x, y]] },
   where k is the number of the colour (default: the index of the series). */
function lines(title, about, x, y, series) {
  const all = series.flatMap(s => s.points);
  const values = all.map(p => p[1]).filter(v => !y.log || v > 0);
  if (!values.length) return null;
  const low = y.log ? Math.min(...values) : 0, high = largest(values);
  const xs = all.map(p => p[0]);
  return chart({title, about,
    x: {...x, low: Math.min(...xs), high: Math.max(...xs) + (Math.max(...xs) > Math.min(...xs) ? 0 : 1)},
    y: {...y, low: y.log ? low / 1.3 : 0, high: y.log ? high * 1.3 : round_up(high)},
    draw: p => series.forEach((s, k) => {
      const at = s.points.filter(q => !y.log || q[1] > 0).map(q => [p.x(q[0]), p.y(q[1])]);
      p.body.append(svg('path', {class: 'line', style: 'stroke:' + colour_of(s.k ?? k),
        'stroke-dasharray': DASHES[(s.k ?? k) % SERIES], d: 'M' + at.map(q => q.map(v => v.toFixed(1)).join(' ')).join('L')}));
      for (const q of at) p.body.append(marker(s.k ?? k, q[0], q[1], 2.6));
    })});
}

/* Return a chart of points with the line of equal coordinates. If there are more than MOST points,
   the chart has every second, third, ... point, and all points beyond 80 % of an axis. */
const MOST = 4000;
function scatter(title, about, x, y, k, points) {
  const every = Math.ceil(points.length / MOST);
  const shown = points.filter((p, i) => i % every === 0 || Math.abs(p[0]) > x.high * 0.8 || Math.abs(p[1]) > y.high * 0.8);
  const sampled = every > 1 ? ` One in ${every} is shown, and all that are far out.` : '';
  const clamp = (v, a) => Math.max(a.low, Math.min(a.high, v));
  return chart({title, about: about + sampled, height: 250, x, y, draw: p => {
    iso(p, x, y);
    p.body.append(svg('path', {class: 'dots', style: 'stroke:' + colour_of(k),
      d: shown.map(q => `M${p.x(clamp(q[0], x)).toFixed(1)} ${p.y(clamp(q[1], y)).toFixed(1)}h0`).join('')}));
    if (points.length) {
      const m = [mean(points.map(q => q[0])), mean(points.map(q => q[1]))];
      p.body.append(svg('g', {class: 'mean'}, marker(5, p.x(clamp(m[0], x)), p.y(clamp(m[1], y)), 6)));
    }
  }});
}

function iso(p, x, y) {
  const low = Math.max(x.low, y.low), high = Math.min(x.high, y.high);
  p.body.append(svg('path', {class: 'iso', d: `M${p.x(low)} ${p.y(low)}L${p.x(high)} ${p.y(high)}`}));
}
