/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes the sections of the page from the data. */

const data = JSON.parse(document.getElementById('data').textContent);
const runs = data.runs;
const main = document.getElementById('main');
const FEW = 20; /* largest number of runs that are listed in detail */
const methods = [...new Set(runs.map(r => r.method))], cases = [...new Set(runs.map(r => r.case))];
const series_of = run => methods.indexOf(run.method);
const name_of = run => (cases.length > 1 ? run.label : run.method);

function section(id, title, ...content) {
  const there = some(content);
  if (!there.length) return;
  main.append(el('section', {id, 'aria-labelledby': id + '-title'}, el('h2', {id: id + '-title'}, title), there));
  document.getElementById('contents').append(el('li', null, el('a', {href: '#' + id}, title)));
}

/* Return a heading in which each |...| stays on one line. */
const unbroken = text => text.split(/(\|[^|]+\|,?)/).map((part, k) => (k % 2 ? el('span', {class: 'name'}, part) : part));

/* Return a table. A column is { name, unit, cell(row), text }, with `text` set for texts. */
function table(caption, columns, rows) {
  const head = c => el('th', {scope: 'col', class: c.text ? null : 'number'}, unbroken(c.name), c.unit ? el('span', {class: 'unit'}, ' ' + c.unit) : null);
  return el('div', {class: 'wide', role: 'region', tabindex: 0, 'aria-label': caption}, el('table', null,
    el('caption', null, caption), el('thead', null, el('tr', null, columns.map(head))),
    el('tbody', null, rows.map(row => el('tr', null, columns.map((c, k) => {
      const cell = c.cell(row);
      if (cell instanceof Element && (cell.tagName === 'TD' || cell.tagName === 'TH')) return cell;
      return k ? el('td', {class: c.text ? null : 'number'}, cell) : el('th', {scope: 'row'}, cell);
    }))))));
}

/* ---- summary ---- */

/* Metrics in the summary, with their labels. */
const CHOSEN = [['transistors', 'transistors'], ['ion_mean_drawn', 'mean |ΔIon|, drawn'], ['ion_mean', 'mean |ΔIon|'],
  ['ion_max', 'max |ΔIon|'], ['ioff_mean', 'mean |ΔIoff|'], ['area_mean', 'mean |Δarea|'], ['epe_mean', 'mean EPE'],
  ['shots', 'shots'], ['violations', 'violations'], ['failed', 'do not print'], ['worse', 'worse than drawn'],
  ['simulations', 'simulations']];
const FAULTS = ['failed', 'worse']; /* have a column only if a run has a value other than 0 */
const DELTA = 'Δ is the deviation from the drawn transistor.';

/* Return the path of the first metric of that name. Metrics are in the order of the steps, so
   the metric is that of the correction, not of a later verification. */
const metric_named = (run, name) => Object.keys(run.metrics).find(m => m.endsWith('.' + name)) || '';

function metric_cell(run, name) {
  const m = run.metrics[name];
  return el('td', {class: 'number', 'data-metric': name, 'data-value': m ? m.value : null}, number(m ? m.value : NaN));
}

/* Return a table of the metrics with a direction, of steps other than the correction and its
   cost, that differ between a few runs of one case. */
function other_steps() {
  if (cases.length > 1 || runs.length < 2 || runs.length > 12) return null;
  const step = name => name.split('.')[0];
  const own = new Set(runs.flatMap(r => ['ion_mean', 'shots'].map(n => step(metric_named(r, n)))));
  const all = Object.assign({}, ...runs.map(r => r.metrics)), value = (r, name) => (r.metrics[name] || {}).value;
  const rows = Object.keys(all).filter(name => all[name].better !== 'neutral' && !own.has(step(name)) &&
    new Set(runs.map(r => value(r, name))).size > 1);
  if (!rows.length) return null;
  return table('Figures of other steps that differ between the runs', [{name: 'figure', text: true, cell: name => name},
    {name: 'unit', text: true, cell: name => all[name].unit || ''}, {name: 'better', text: true, cell: name => all[name].better},
    ...runs.map(r => ({name: r.method, cell: name => metric_cell(r, name)}))], rows);
}

function summary() {
  const values = name => runs.map(r => r.metrics[metric_named(r, name)]).filter(m => m).map(m => m.value);
  const used = CHOSEN.filter(([name]) => values(name).some(v => v || !FAULTS.includes(name)));
  const unit = name => { const r = runs.find(r => metric_named(r, name)); return r.metrics[metric_named(r, name)].unit; };
  const columns = [{name: cases.length > 1 || runs.length > methods.length ? 'method' : 'run', text: true,
    cell: r => el('th', {scope: 'row', class: 'name'}, el('span', {class: 'swatch', style: 'background:' + colour_of(series_of(r))}), r.method)},
  ...(cases.length > 1 ? [{name: 'case', text: true, cell: r => r.case}] : []),
  ...used.map(([name, label]) => ({name: label, unit: unit(name), cell: r => metric_cell(r, metric_named(r, name))})),
  {name: 'time', unit: 's', cell: r => number(r.seconds ?? NaN)}];
  const each = table(`Each run, measured with its own model. ${DELTA}` + (runs.some(r => r.running) ? ' The run that wrote this page had not ended.' : ''), columns, runs);
  const pooled = cases.length > 1 ? by_method() : null;
  section('summary', 'Summary', notes(), verdicts(), pooled,
    pooled && runs.length > 24 ? el('details', null, el('summary', null, `Each of the ${runs.length} runs`), each) : each,
    other_steps(), requirements(), findings());
}

/* Return the verdicts on the pairs of methods as sentences, and a table of the changes. */
function verdicts() {
  const all = data.verdicts, few = all.slice(0, 12);
  if (!all.length) return null;
  const figures = Object.entries(Object.assign({}, ...all.map(v => v.changes)));
  const cell = c => {
    if (!c) return '\u2013';
    const has_interval = is(c.low) && c.unit;
    return [number(has_interval ? c.median : c.change), el('div', {class: 'unit'}, c.verdict +
      (has_interval ? `, ${number(c.low)} to ${number(c.high)}` : ''))];
  };
  return [el('div', {class: 'note'}, el('h3', null, 'Verdicts'), el('ul', null, few.map(v => el('li', null, v.text)),
    all.length > few.length ? el('li', null, `${all.length - few.length} more in the table below`) : null)),
  el('details', null, el('summary', null, 'Changes and 95 % intervals'),
    table('Change from the second method to the first: medians over cells or cases, from the verification if the runs have one',
      [{name: 'methods', text: true, cell: v => v.method + ' against ' + v.against},
        ...figures.map(([name, c]) => ({name: c.title, unit: c.unit, cell: v => cell(v.changes[name])}))], all))];
}

/* Return the first ten of more than twelve texts, and the number of the others. */
const first_of = texts => (texts.length > 12 ? [...texts.slice(0, 10), `and ${texts.length - 10} more`] : texts);

const notes = () => (data.missing.length
  ? el('div', {class: 'note'}, el('h3', null, 'Missing parts'), el('ul', null, first_of(data.missing).map(m => el('li', null, m)))) : null);

/* Return the deviations of all transistors of a method, in the case `only` or in all cases. A
   class of transistors has one value, with the number of its transistors as weight. */
function pool(method, only) {
  const out = {ion: weighted(), ioff: weighted(), area: weighted(), before: weighted(), w: [], pairs: weighted(), shots: 0, seconds: 0};
  const push = (to, v, n) => { to.push(v), to.n.push(n); };
  for (const r of runs.filter(r => r.method === method && (!only || r.case === only))) {
    const [ion, area, w] = ['ion_after', 'area_after', 'w'].map(n => deviations(r, n)), count = column(r, 'gates', 'count');
    const n = i => (count ? count[i] : 1);
    ion.forEach((v, i) => {
      if (!is(v)) return;
      push(out.ion, v, n(i));
      if (is(area[i])) push(out.area, area[i], n(i)), push(out.pairs, [area[i], v], n(i)), out.w.push(w[i]);
    });
    deviations(r, 'ioff_after').forEach((v, i) => { if (is(v)) push(out.ioff, v, n(i)); });
    deviations(r, 'ion_before').forEach((v, i) => { if (is(v)) push(out.before, v, n(i)); });
    const shots = r.metrics[metric_named(r, 'shots')];
    out.shots += shots ? shots.value : 0, out.seconds += r.seconds || 0;
  }
  return out;
}

const size = Math.abs;
const off_line = p => mean(mapped(p.pairs, q => size(q[0] - q[1])));

function by_method() {
  return table(`Each method, all transistors of ${cases.length} cases, measured with its own model. ${DELTA}`, [
    {name: 'method', text: true, cell: m => m.name}, {name: 'transistors', cell: m => number(total(m.ion))},
    {name: 'mean |ΔIon|', unit: '%', cell: m => number(mean(mapped(m.ion, size)))},
    {name: 'max |ΔIon|', unit: '%', cell: m => number(largest(m.ion.map(size)))},
    {name: 'standard deviation of Ion', unit: '%', cell: m => number(stdv(m.ion))},
    {name: 'mean |ΔIoff|', unit: '%', cell: m => number(mean(mapped(m.ioff, size)))},
    {name: 'mean |Δarea|', unit: '%', cell: m => number(mean(mapped(m.area, size)))},
    {name: 'mean |Δarea − ΔIon|', unit: '%', cell: m => number(off_line(m))},
    {name: 'shots', cell: m => number(m.shots)}, {name: 'time', unit: 's', cell: m => number(m.seconds)},
  ], methods.map(name => ({name, ...pool(name)})));
}

function requirements() {
  const broken = runs.flatMap(r => r.requirements.filter(q => !q.kept).map(q => ({run: name_of(r), ...q})));
  if (!broken.length) return null;
  return table('Requirements that were not met', [{name: 'run', text: true, cell: q => q.run},
    {name: 'metric', text: true, cell: q => q.metric}, {name: 'required', text: true, cell: q => q.required},
    {name: 'value', cell: q => quantity(q.value, q.unit)}], broken);
}

function findings() {
  const all = runs.flatMap(r => [...(r.failure ? [{step: 'failed', text: r.failure}] : []), ...r.findings]
    .map(f => (runs.length > 1 ? name_of(r) + ', ' : '') + f.step + ': ' + f.text));
  return all.length ? el('div', {class: 'note'}, el('h3', null, 'Findings'),
    el('ul', null, first_of(all).map(text => el('li', null, text)))) : null;
}

/* ---- charts ---- */

function charts() {
  if (!runs.some(r => r.tables.gates || r.tables.history)) return;
  const place = el('div'), show = only => place.replaceChildren(...some(charts_of(only)));
  const choice = cases.length > 1 ? el('label', null, 'Case ', el('select', {onchange: e => show(e.target.value)},
    el('option', {value: ''}, 'all'), cases.map(c => el('option', null, c)))) : null;
  show('');
  section('transistors', 'Transistors and convergence', choice, place);
}

function charts_of(only) {
  const pools = methods.map(m => pool(m, only));
  const performance = [el('h3', null, 'Deviation from the design'), histograms(pools), el('h3', null, 'Drive current against gate area'),
    el('p', {class: 'about'}, 'To first order, the relative delay error of a gate is that of its load capacitance, which is proportional to the gate area, ' +
      'minus that of its drive current (Δt/t ≈ ΔC/C − ΔIon/Ion). On the line where both are equal, the delay is as designed.'),
    scatters(pools), el('h3', null, 'Deviation against width'), against_width(pools)];
  return [pools.some(p => p.ion.length) ? performance : null, convergence(only)];
}

function histograms(pools) {
  const kinds = [['ion', 'Ion deviation'], ['ioff', 'Ioff deviation'], ['area', 'gate area deviation']];
  const range = kinds.map(([k]) => range_of(pools.flatMap(p => p[k])));
  return methods.map((name, k) => el('div', {class: 'row'}, el('h4', null, name), el('div', {class: 'charts'},
    kinds.map(([kind, word], j) => pools[k][kind].length
      ? histogram(word, '%', k, pools[k][kind], kind === 'ion' ? pools[k].before : [], range[j]) : null))));
}

function scatters(pools) {
  const of = i => range_of(pools.flatMap(p => p.pairs.map(q => q[i])));
  const [area, ion] = [of(0), of(1)];
  const each = methods.map((name, k) => scatter(name, `mean |Δarea − ΔIon|: ${number(off_line(pools[k]))} %`,
    {label: 'Δarea, %', low: -area, high: area}, {label: 'ΔIon, %', low: -ion, high: ion}, k, pools[k].pairs));
  return [el('div', {class: 'charts'}, means_chart(pools), each)];
}

/* Return the chart of figure 5.5 of the thesis (docs/background/thesis.md): for each method, the
   mean and the standard deviation of the current deviation against those of the area. */
function means_chart(pools) {
  const at = [];
  pools.forEach((p, k) => p.pairs.length && at.push([k, mean(mapped(p.area, size)), mean(mapped(p.ion, size)), stdv(p.area), stdv(p.ion)]));
  const values = at.flatMap(v => v.slice(1)).filter(v => v > 0);
  if (!values.length) return null;
  const axis = {log: true, low: Math.min(...values) / 1.5, high: largest(values) * 1.5};
  return el('div', null, chart({title: 'Means and standard deviations',
    about: 'Mean of the size as a filled mark, standard deviation as a ring around it.', height: 250,
    x: {...axis, label: '|Δarea|, %'}, y: {...axis, label: '|ΔIon|, %'}, draw: p => {
      iso(p, axis, axis);
      for (const [k, a, i, sa, si] of at) { /* a logarithmic axis cannot show 0 */
        const means = a > 0 && i > 0, spread = sa > 0 && si > 0;
        p.body.append(...some([
          means && spread && svg('path', {class: 'tie', style: 'stroke:' + colour_of(k), d: `M${p.x(a)} ${p.y(i)}L${p.x(sa)} ${p.y(si)}`}),
          spread && svg('circle', {class: 'ring', cx: p.x(sa), cy: p.y(si), r: 6.5, style: 'stroke:' + colour_of(k)}),
          means && marker(k, p.x(a), p.y(i), 4.5), spread && marker(k, p.x(sa), p.y(si), 3)]));
      }
    }}), methods.length > 1 ? legend(methods) : null);
}

/* Return charts of the mean deviation against the width. If there are more than GROUPS widths,
   neighbouring widths are combined into GROUPS groups of about equal size. */
const GROUPS = 16;
function against_width(pools) {
  const of = (p, k, what) => {
    const order = p.w.map((w, i) => [w, size(p[what][i]), p.pairs.n[i]]).sort((a, b) => a[0] - b[0]), points = [];
    const least = new Set(p.w).size > GROUPS ? order.length / GROUPS : 1;
    for (let from = 0, to; from < order.length; from = to) {
      for (to = from + 1; to < order.length && (to - from < least || order[to][0] === order[to - 1][0]);) to++;
      const part = order.slice(from, to);
      const n = part.map(q => q[2]), of = j => mean(Object.assign(part.map(q => q[j]), {n}));
      points.push([of(0), of(1)]);
    }
    return {k, points};
  };
  const one = (what, word) => lines('Mean |' + word + ' deviation|', '', {label: 'W as drawn, nm'}, {label: '%'},
    pools.map((p, k) => of(p.w.length ? {...p, ion: p.pairs.map(q => q[1])} : p, k, what)).filter(s => s.points.length));
  return el('div', null, el('div', {class: 'charts'}, one('area', 'area'), one('ion', 'Ion')), methods.length > 1 ? legend(methods) : null);
}

/* Return the points [iteration, value] of a column of history.csv: the mean over the runs of a
   method. A run that has ended counts with its last value. */
function mean_history(method, only, name) {
  const all = runs.filter(r => r.method === method && (!only || r.case === only) && column(r, 'history', name))
    .map(r => new Map(column(r, 'history', 'iteration').map((n, i) => [n, column(r, 'history', name)[i]])));
  const last = Math.max(-1, ...all.flatMap(h => [...h.keys()])), points = [];
  const now = all.map(() => NaN);
  for (let n = 0; n <= last; n++) {
    all.forEach((h, i) => { if (is(h.get(n))) now[i] = h.get(n); });
    const known = finite(now);
    if (known.length && all.some(h => h.has(n))) points.push([n, mean(known)]);
  }
  return points;
}

function convergence(only) {
  const one = (name, title, unit) => {
    const series = methods.map((m, k) => ({k, points: mean_history(m, only, name)})).filter(s => s.points.length);
    return series.length ? lines(title, '', {label: 'iteration'}, {label: unit, log: true}, series) : null;
  };
  const all = some([one('ion_mean', 'Mean |Ion deviation|', '%'), one('ion_max', 'Largest |Ion deviation|', '%'),
    one('area_mean', 'Mean |area deviation|', '%'), one('epe_mean', 'Mean |edge placement error|', 'nm')]);
  return all.length ? [el('h3', null, 'Convergence' + (cases.length > 1 && !only ? ', means over the cases' : '')),
    el('div', {class: 'charts'}, all), methods.length > 1 ? legend(methods) : null] : null;
}

/* ---- corners ---- */

function corners() {
  const differ = c => new Set(c.values).size > 1;
  const name = (r, i) => r.tables.corners.columns.filter(c => ['dose', 'focus', 'mask', 'overlay_x', 'overlay_y'].includes(c.name) && differ(c))
    .map(c => c.name + ' ' + quantity(c.values[i], c.unit)).join(', ');
  section('corners', 'Corners of the process', runs.filter(r => r.tables.corners).slice(0, FEW).map(r => {
    const one = (what, of) => bars_of(`Leakage of ${of}, over that as drawn`, column(r, 'corners', what) || [], i => name(r, i), series_of(r));
    return [el('h3', null, name_of(r)), el('div', {class: 'charts'}, one('leakage', 'all'), one('leakage_n', 'n'), one('leakage_p', 'p')),
      plain_table(r, 'corners')];
  }));
}

/* Return a chart of horizontal columns that start at 1, on a logarithmic axis. */
function bars_of(title, values, name, k) {
  const good = values.filter(v => is(v) && v > 0);
  if (!good.length) return null;
  const low = Math.min(1, ...good) / 1.1, high = Math.max(1, ...good) * 1.1, step = 20;
  return chart({title, height: 50 + step * values.length,
    x: {label: 'factor', log: true, low, high}, y: {bare: 158, low: 0, high: 1}, draw: p => values.forEach((v, i) => {
      if (!(v > 0)) return;
      const a = p.x(1), b = p.x(v), y = p.top + i * step;
      p.body.append(svg('rect', {class: 'bar', x: Math.min(a, b), y: y + 3, width: Math.max(1, size(a - b)), height: step - 8, style: 'fill:' + colour_of(k)}),
        svg('text', {x: p.left - 6, y: y + 14, 'text-anchor': 'end'}, name(i)));
    })});
}

function plain_table(run, name) {
  const t = run.tables[name], rows = [...Array(t.rows).keys()];
  return table(`${name}.csv of ${name_of(run)}`, t.columns.map(c => ({name: c.name, unit: c.unit, text: c.values.some(v => typeof v === 'string'),
    cell: i => (typeof c.values[i] === 'string' ? c.values[i] : number(c.values[i] ?? NaN))})), rows);
}

/* ---- layout ---- */

function layout() {
  const shown = runs.filter(r => r.view);
  if (!shown.length) return;
  const viewer = new Viewer(shown), worst = el('div');
  section('layout', 'Layout', shown.some(r => !r.view.whole)
    ? el('p', {class: 'about'}, 'A layout with many transistors shows each transistor as a box, and shapes only around the worst transistors.') : null, viewer.element);
  section('worst', 'The worst ten', worst);
  const show = () => viewer.open().then(() => worst_ten(worst, viewer));
  viewer.first.addEventListener('change', show);
  repaint = () => { viewer.draw_now(); worst.querySelectorAll('canvas').forEach(c => c.dispatchEvent(new Event('repaint'))); };
  show();
}
let repaint = () => {};

function worst_ten(place, viewer) {
  const scene = viewer.scene, ten = scene.order().slice(0, 10);
  const range = state => viewer.ranges(scene, ['before', 'after'])[state];
  const close_up = (i, state) => {
    const canvas = el('canvas', {class: 'close', role: 'img', 'aria-label': `${STATES[state]}, ${facts_of(scene.run, scene.row(i))[0][1]}`});
    const c = viewer.centre(i), k = 4 * i, b = scene.boxes;
    const wide = Math.max(b[k + 2] - b[k], b[k + 3] - b[k + 1]) + 300;
    const draw = () => paint(canvas, {scene, state, values: scene.value[state], range: range(state), chosen: -1, show: {...viewer.show, image: false}},
      {...c, scale: (canvas.clientWidth || 150) / wide});
    canvas.addEventListener('repaint', draw);
    requestAnimationFrame(draw);
    return el('figure', null, canvas, el('figcaption', null, STATES[state]));
  };
  place.replaceChildren(el('p', {class: 'about'}, `Transistors of ${name_of(scene.run)} with the largest |ΔIon|; transistors that do not print come first.`),
    el('ol', {class: 'cards'}, ten.map(i => el('li', null, el('div', {class: 'pair'},
      scene.value.before.length ? close_up(i, 'before') : null, close_up(i, 'after')), facts_list(scene.run, scene.row(i)),
    el('button', {type: 'button', onclick: () => { viewer.element.scrollIntoView(); viewer.choose(i, true); viewer.canvas().focus({preventScroll: true}); }}, 'Show in the layout')))));
}

/* ---- violations, facts ---- */

function violations() {
  const there = runs.filter(r => r.tables.violations);
  section('violations', 'Violations of rules', there.map(r => plain_table(r, 'violations')));
}

/* Return a table with a row for each parameter that differs between the runs. */
function parameters() {
  if (runs.length < 2) return null;
  const names = [...new Set(runs.flatMap(r => Object.keys(r.parameters)))];
  const differ = names.filter(n => new Set(runs.map(r => r.parameters[n])).size > 1);
  const first = cases.length > 1 ? runs.filter(r => r.case === cases[0]) : runs;
  return differ.length ? table('Parameters that differ' + (cases.length > 1 ? `, in the case ${cases[0]}` : ''),
    [{name: 'parameter', text: true, cell: n => n},
      ...first.map(r => ({name: r.method, text: true, cell: n => r.parameters[n] ?? '\u2013'}))], differ)
    : el('p', null, 'All parameters are the same.');
}

function facts() {
  const short = sum => (sum ? el('code', {title: sum}, sum.slice(0, 12)) : '');
  const inside = r => [el('dl', {class: 'facts long'}, [['folder', r.folder], ['flow', r.name], ['variant', r.variant], ['opcflow', r.version],
      ['started', r.started], ['time', is(r.seconds) ? quantity(r.seconds, 's') : ''], ['threads', r.threads]].filter(f => f[1]).map(([a, b]) =>
      el('div', null, el('dt', null, a), el('dd', null, String(b))))),
    table('Inputs', [{name: 'file', text: true, cell: f => f.path}, {name: 'SHA-256', text: true, cell: f => short(f.sha256)}], r.inputs),
    table('Steps', [{name: 'step', text: true, cell: s => s.name}, {name: 'time', unit: 's', cell: s => number(s.seconds)}], r.steps),
    table('Plugins', [{name: 'plugin', text: true, cell: p => p.id}, {name: 'version', text: true, cell: p => p.version},
      {name: 'SHA-256', text: true, cell: p => short(p.sha256)}], r.plugins)];
  section('facts', 'Facts of the runs', parameters(), all_metrics(), runs.map(r => folded(name_of(r), runs.length === 1, () => inside(r))));
}

/* Return an element that can be unfolded. The content is made when the element is unfolded or,
   for at most FEW runs, at once, so that a printout contains the content. */
function folded(title, open, content) {
  const d = el('details', {open}, el('summary', null, title));
  if (runs.length <= FEW) d.append(...some(content()));
  else d.addEventListener('toggle', () => d.append(...some(content())), {once: true});
  return d;
}

function all_metrics() {
  const names = [...new Set(runs.flatMap(r => Object.keys(r.metrics)))], few = runs.slice(0, 12);
  const any = n => runs.find(r => r.metrics[n]).metrics[n];
  return el('details', null, el('summary', null, 'All metrics' + (few.length < runs.length ? ` of the first ${few.length} runs` : '')),
    table('All metrics', [{name: 'metric', text: true, cell: n => n}, {name: 'unit', text: true, cell: n => any(n).unit || ''},
      {name: 'better', text: true, cell: n => any(n).better}, ...few.map(r => ({name: name_of(r), cell: n => metric_cell(r, n)}))], names));
}

/* ---- the page ---- */

function theme() {
  const choice = document.getElementById('theme'), root = document.documentElement;
  const set = to => { if (to) root.dataset.theme = to; else delete root.dataset.theme; repaint(); };
  choice.addEventListener('change', () => set(choice.value));
  if (location.hash === '#dark' || location.hash === '#light') set(choice.value = location.hash.slice(1));
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => repaint());
  let folded = [];
  const print = to => () => {
    if (to) folded = [...document.querySelectorAll('details:not([open])')];
    for (const d of folded) d.open = to;
    printing = to;
    root.classList.toggle('printing', to);
    repaint();
  };
  addEventListener('beforeprint', print(true));
  addEventListener('afterprint', print(false));
}

function head() {
  const title = data.title || (cases.length === 1 && cases[0] ? cases[0] + ': ' : '') + methods.join(', ');
  document.title = title + ' · opcflow report';
  document.getElementById('title').textContent = title;
  document.getElementById('subtitle').textContent = [
    runs.length > 1 ? `${runs.length} runs` : null, cases.length > 1 ? `${cases.length} cases, ${methods.length} methods` : null,
    runs[0] && runs[0].started ? 'started ' + runs[0].started.slice(0, 16).replace('T', ' ') + ' UTC' : null,
    'opcflow ' + data.opcflow].filter(t => t).join(' · ');
}

main.replaceChildren();
head();
summary();
charts();
corners();
layout();
violations();
facts();
theme();
document.documentElement.dataset.ready = '1';
