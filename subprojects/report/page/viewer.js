/* SPDX-License-Identifier: BSD-3-Clause */
/* The viewer: up to three pictures of one layout side by side, which the pointer or the keyboard
   moves and zooms together. */

const HELP = 'Arrow keys select a neighbouring transistor, Page Down and Page Up the next or previous one in order of deviation; ' +
  '+ and \u2212 zoom, 0 shows the whole layout, Shift with arrow keys moves the picture, Escape ends the selection.';
const STATES = {before: 'as drawn', after: 'corrected', change: 'change of |deviation|'};
const ROLES = {drawn: 'drawn', mask: 'mask (dashed)', print: 'printed', image: 'image of the poly', violations: 'violations'};

class Viewer {
  constructor(runs) {
    this.runs = runs;
    this.show = {drawn: true, mask: true, print: true, image: false, violations: true};
    this.common = true; /* all pictures have the same range of colours */
    this.chosen = -1;
    this.panes = [0, 1, 2].map(() => this.new_pane());
    this.details = el('div', {class: 'details', 'aria-live': 'polite', id: 'details'});
    this.tip = el('div', {class: 'tip', hidden: true});
    this.element = el('div', {class: 'viewer'}, this.controls(),
      el('p', {class: 'about', id: 'viewer-help'}, HELP),
      el('div', {class: 'panes'}, this.panes.map(p => p.element)), this.details, this.tip);
    new ResizeObserver(() => (this.fits ? this.fit() : this.draw())).observe(this.element);
  }

  /* ---- parts of the viewer ---- */

  controls() {
    const options = this.runs.map((r, i) => el('option', {value: i}, name_of(r)));
    const change = () => this.open();
    this.first = el('select', {onchange: change, id: 'run'}, options);
    this.second = el('select', {onchange: change, id: 'beside'});
    const boxes = Object.entries(ROLES).map(([role, name]) => el('label', null,
      el('input', {type: 'checkbox', checked: this.show[role], 'data-role': role,
        onchange: e => { this.show[role] = e.target.checked; this.draw(); }}), name));
    const button = (text, name, act) => el('button', {type: 'button', 'aria-label': name, title: name, onclick: act}, text);
    return el('div', {class: 'controls'},
      el('label', null, 'Run ', this.first), el('label', null, 'beside ', this.second),
      el('span', {class: 'group', role: 'group', 'aria-label': 'Parts of the picture'}, boxes),
      el('label', null, el('input', {type: 'checkbox', checked: true, onchange: e => { this.common = e.target.checked; repaint(); }}), 'one scale'),
      el('span', {class: 'group'}, button('+', 'zoom in', () => this.zoom(1.5)),
        button('\u2212', 'zoom out', () => this.zoom(1 / 1.5)), button('all', 'show all', () => this.fit())));
  }

  new_pane() {
    const canvas = el('canvas', {tabindex: 0, role: 'application', 'aria-describedby': 'viewer-help details'});
    const title = el('h4'), key = el('div', {class: 'key'});
    const pane = {canvas, title, key, element: el('div', {class: 'pane'}, title, canvas, key)};
    canvas.addEventListener('keydown', e => this.key_down(e));
    canvas.addEventListener('wheel', e => {
      e.preventDefault();
      this.zoom(Math.exp(-e.deltaY * (e.deltaMode ? 0.05 : 0.0015)), this.place(pane, e));
    }, {passive: false});
    canvas.addEventListener('dblclick', e => this.zoom(2, this.place(pane, e)));
    this.listen_to_pointers(pane);
    return pane;
  }

  /* One finger or a pressed button moves the picture, two fingers zoom, and a click without a
     movement selects a transistor. */
  listen_to_pointers(pane) {
    const at = new Map(), {canvas} = pane;
    let moved = 0;
    const spread = () => { const [a, b] = [...at.values()]; return Math.hypot(a.x - b.x, a.y - b.y); };
    canvas.addEventListener('pointerdown', e => {
      canvas.setPointerCapture(e.pointerId);
      at.set(e.pointerId, {x: e.clientX, y: e.clientY});
      moved = 0;
    });
    canvas.addEventListener('pointermove', e => {
      const last = at.get(e.pointerId), before = at.size === 2 ? spread() : 0;
      if (!last) return this.point_at(pane, e);
      const dx = e.clientX - last.x, dy = e.clientY - last.y;
      at.set(e.pointerId, {x: e.clientX, y: e.clientY});
      moved += Math.abs(dx) + Math.abs(dy);
      if (before) this.zoom(spread() / before, this.place(pane, e));
      else this.move(-dx / this.window.scale, dy / this.window.scale);
    });
    const up = e => {
      if (at.delete(e.pointerId) && e.type === 'pointerup' && moved < 5)
        this.choose(this.gate_at(this.place(pane, e)), false);
    };
    for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, up);
    canvas.addEventListener('pointerleave', () => { this.tip.hidden = true; });
  }

  /* ---- content of the pictures ---- */

  async open(first) {
    if (first !== undefined) this.first.value = first;
    const a = this.runs[Number(this.first.value)], like = this.runs.filter(r => r !== a && is_like(r, a));
    const kept = this.second.value;
    this.second.replaceChildren(el('option', {value: ''}, 'the drawn mask'),
      ...like.map(r => el('option', {value: this.runs.indexOf(r)}, name_of(r))));
    if ([...this.second.options].some(o => o.value === kept)) this.second.value = kept;
    const b = this.second.value === '' ? null : this.runs[Number(this.second.value)];
    const [sa, sb] = [await scene_of(a), b && await scene_of(b)];
    if (!this.scene || this.scene.extent.join() !== sa.extent.join()) this.chosen = -1, this.window = null;
    this.scene = sa;
    const change = sb && sb.value.after.map((v, i) => Math.abs(v) - Math.abs(sa.value.after[i]));
    const content = b
      ? [[sa, 'after', sa.value.after, name_of(a)], [sb, 'after', sb.value.after, name_of(b)],
        [sb, 'change', change, `|deviation| of ${name_of(b)} less ${name_of(a)}`]]
      : ['before', 'after', 'change'].map(s => [sa, s, sa.value[s], STATES[s]]);
    this.panes.forEach((pane, k) => {
      const [scene, state, values, title] = content[k];
      pane.what = {scene, state, values, show: this.show, range: range_of(finite(Array.from(values)))};
      pane.title.textContent = title;
      pane.element.hidden = !values.length;
      pane.canvas.setAttribute('aria-label', `Layout of ${scene.run.view.cell}, ${title}`);
    });
    this.order = null;
    if (this.window) this.draw(); else this.fit();
  }

  draw() {
    if (this.due || !this.window) return;
    this.due = true;
    requestAnimationFrame(() => { this.due = false; this.draw_now(); });
  }

  draw_now() {
    if (!this.window) return; /* not open yet */
    const range = Math.max(...this.panes.map(p => p.what.range));
    for (const pane of this.panes) {
      if (pane.element.hidden) continue;
      const what = {...pane.what, chosen: this.chosen, range: this.common ? range : pane.what.range};
      paint(pane.canvas, what, this.window);
      pane.key.replaceChildren(...colour_key(what));
    }
    for (const name of ['x', 'y', 'scale']) this.element.dataset[name] = this.window[name].toPrecision(6);
  }

  /* Return the range of the colours for each state: the same range for all states if `common` is
     set. */
  ranges(scene, states) {
    const each = states.map(s => range_of(finite(Array.from(scene.value[s]))));
    return Object.fromEntries(states.map((s, i) => [s, this.common ? Math.max(...each) : each[i]]));
  }

  /* ---- moving ---- */

  canvas() { return this.panes.find(p => !p.element.hidden).canvas; }

  fit() {
    const [x0, y0, x1, y1] = this.scene.extent, c = this.canvas();
    this.window = {x: (x0 + x1) / 2, y: (y0 + y1) / 2,
      scale: 0.94 * Math.min((c.clientWidth || 400) / (x1 - x0), (c.clientHeight || 360) / (y1 - y0))};
    this.least = this.window.scale / 4;
    this.fits = true; /* until the user moves or zooms the picture */
    this.draw();
  }

  zoom(factor, at) {
    const w = this.window, scale = Math.max(this.least, Math.min(20, w.scale * factor)), about = at || w;
    w.x = about.x + (w.x - about.x) * w.scale / scale;
    w.y = about.y + (w.y - about.y) * w.scale / scale;
    w.scale = scale;
    this.fits = false;
    this.draw();
  }

  move(dx, dy) {
    this.window.x += dx, this.window.y += dy;
    this.fits = false;
    this.draw();
  }

  place(pane, e) {
    const r = pane.canvas.getBoundingClientRect(), w = this.window;
    return {x: w.x + (e.clientX - r.left - r.width / 2) / w.scale, y: w.y - (e.clientY - r.top - r.height / 2) / w.scale};
  }

  /* ---- transistors ---- */

  /* Return the transistor whose box is nearest to a point, at most 8 pixels away; -1 if there is
     none. */
  gate_at(at) {
    const {boxes, count} = this.scene;
    let best = -1, least = 8 / this.window.scale;
    for (let i = 0, k = 0; i < count; i++, k += 4) {
      const dx = Math.max(boxes[k] - at.x, 0, at.x - boxes[k + 2]), dy = Math.max(boxes[k + 1] - at.y, 0, at.y - boxes[k + 3]);
      const far = Math.max(dx, dy);
      if (far < least) least = far, best = i;
    }
    return best;
  }

  point_at(pane, e) {
    const i = this.gate_at(this.place(pane, e));
    this.tip.hidden = i < 0;
    if (i < 0) return;
    this.tip.replaceChildren(facts_list(pane.what.scene.run, pane.what.scene.row(i)));
    const r = this.element.getBoundingClientRect(), wide = 230;
    this.tip.style.left = Math.max(0, Math.min(e.clientX - r.left + 14, r.width - wide)) + 'px';
    this.tip.style.top = e.clientY - r.top + 16 + 'px';
  }

  centre(i) {
    const b = this.scene.boxes, k = 4 * i;
    return {x: (b[k] + b[k + 2]) / 2, y: (b[k + 1] + b[k + 3]) / 2};
  }

  /* Show the details of a transistor and move the window to it. */
  choose(i, near) {
    this.chosen = i;
    this.details.replaceChildren();
    if (i >= 0) {
      const runs = [...new Set(this.panes.map(p => p.what.scene.run))], c = this.centre(i), w = this.window;
      for (const run of runs)
        this.details.append(runs.length > 1 ? el('h4', null, name_of(run)) : '', facts_list(run, this.scene.row(i)));
      if (near) w.scale = Math.max(w.scale, 0.25);
      const half = {x: this.canvas().clientWidth / 2.4 / w.scale, y: this.canvas().clientHeight / 2.4 / w.scale};
      if (near || Math.abs(c.x - w.x) > half.x || Math.abs(c.y - w.y) > half.y) w.x = c.x, w.y = c.y;
      this.fits = false;
    }
    this.draw();
  }

  /* Select the nearest transistor within 60 degrees of a direction. */
  next(dx, dy) {
    const from = this.chosen >= 0 ? this.centre(this.chosen) : this.window;
    let best = this.chosen, least = Infinity;
    for (let i = 0; i < this.scene.count; i++) {
      const c = this.centre(i), along = (c.x - from.x) * dx + (c.y - from.y) * dy;
      const across = Math.abs((c.x - from.x) * dy) + Math.abs((c.y - from.y) * dx);
      if (i === this.chosen || along <= 0 || across > 1.75 * along) continue;
      if (along + 2 * across < least) least = along + 2 * across, best = i;
    }
    this.choose(best, false);
  }

  rank(by) {
    this.order = this.order || this.scene.order();
    const at = this.order.indexOf(this.chosen) + (this.chosen < 0 ? (by > 0 ? 1 : 0) : by);
    if (this.order.length) this.choose(this.order[Math.max(0, Math.min(this.order.length - 1, at))], true);
  }

  key_down(e) {
    const arrows = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};
    const go = arrows[e.key], far = 60 / this.window.scale;
    const acts = {'+': () => this.zoom(1.5), '=': () => this.zoom(1.5), '-': () => this.zoom(1 / 1.5), 0: () => this.fit(),
      PageDown: () => this.rank(1), PageUp: () => this.rank(-1), Escape: () => this.choose(-1)};
    if (e.ctrlKey || e.metaKey || e.altKey) return;
    if (go && e.shiftKey) this.move(go[0] * far, go[1] * far);
    else if (go) this.next(...go);
    else if (acts[e.key]) acts[e.key]();
    else return;
    e.preventDefault();
  }
}

/* Return whether two runs have the same transistors at the same places. */
const is_like = (a, b) => a.view.boxes === b.view.boxes;

function colour_key(what) {
  const colours = diverging(), end = what.range, sign = what.state === 'change' ? ' points' : ' %';
  const stops = colours.filter((c, i) => i % 4 === 0).map(rgb).join(',');
  const low = what.state === 'change' ? ' better' : ' weaker', high = what.state === 'change' ? ' worse' : ' stronger';
  return [el('span', null, number(-end) + sign + low),
    el('span', {class: 'ramp', style: `background:linear-gradient(to right,${stops})`}),
    el('span', null, '+' + number(end) + sign + high)];
}
