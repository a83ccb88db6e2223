/* SPDX-License-Identifier: BSD-3-Clause */
/* Pictures of a layout on a canvas. Coordinates of shapes are in nm, y points upwards. */

/* ---- shapes ---- */

/* Return the scene of a run: the data of view.json, unpacked at the first call. A scene has the
   boxes of the transistors (x0, y0, x1, y1 in nm), the shapes with their bounds, and the image.
   The function row(i) returns the row of transistor i in gates.csv, which has one row for each
   class of transistors with equal masks. The function order() lists one transistor of each row, the largest deviation
   first. */
function scene_of(run) {
  if (!run.scene) run.scene = unpack_view(run);
  return run.scene;
}

async function unpack_view(run) {
  const view = run.view, boxes = Float32Array.from(await unpack(view.boxes, 4), v => v * view.grid);
  const shapes = await Promise.all(view.shapes.map(async s => {
    const sizes = await unpack(s.sizes, 1), points = Float32Array.from(await unpack(s.points, 2), v => v * s.unit);
    let size = 0;
    sizes.forEach((v, i) => { const n = v; sizes[i] = size; size += n; }); /* from numbers of points to the index of the first point */
    return {layer: s.layer, role: s.role, closed: !s.role.endsWith('print'), start: sizes, points, bounds: bounds(sizes, points)};
  }));
  const of = view.classes ? await unpack(view.classes, 1) : null, rows = values_of(run), value = {};
  const first = of ? new Int32Array(rows.after.length) : null;
  for (let i = of ? of.length : 0; i-- > 0;) first[of[i]] = i;
  for (const name of Object.keys(rows))
    value[name] = of && rows[name].length ? Float64Array.from(of, c => rows[name][c]) : rows[name];
  const order = () => (of ? worst_first(rows.after).map(c => first[c]) : worst_first(rows.after));
  return {run, boxes, shapes, count: view.transistors, layers: view.layers, row: i => (of ? of[i] : i), order,
    extent: view.extent.map(v => v * view.grid), image: view.image ? await picture(view.image) : null,
    value, violations: violations_of(run)};
}

function bounds(start, points) {
  const out = new Float32Array(4 * start.length);
  for (let i = 0; i < start.length; i++) {
    const end = i + 1 < start.length ? 2 * start[i + 1] : points.length;
    let x0 = Infinity, y0 = Infinity, x1 = -Infinity, y1 = -Infinity;
    for (let k = 2 * start[i]; k < end; k += 2) {
      x0 = Math.min(x0, points[k]), x1 = Math.max(x1, points[k]);
      y0 = Math.min(y0, points[k + 1]), y1 = Math.max(y1, points[k + 1]);
    }
    out.set([x0, y0, x1, y1], 4 * i);
  }
  return out;
}

async function picture(image) {
  const grey = new Uint8Array(await inflate(image.bytes)), n = image.columns;
  const pixels = new ImageData(n, image.rows);
  for (let i = 0; i < grey.length; i++) {
    const to = 4 * ((image.rows - 1 - Math.floor(i / n)) * n + i % n);
    pixels.data.set([grey[i], grey[i], grey[i], 255], to);
  }
  return {...image, bitmap: await createImageBitmap(pixels)};
}

/* Return the values that determine the colours of the transistors in each state: the Ion
   deviation before and after the correction, %, and the change of its size. NaN stands for a
   transistor that does not print. */
function values_of(run) {
  const list = name => Float64Array.from(deviations(run, name), v => v ?? NaN);
  const before = list('ion_before'), after = list('ion_after');
  return {before, after, change: after.map((v, i) => Math.abs(v) - Math.abs(before[i]))};
}

function violations_of(run) {
  const x = column(run, 'violations', 'x') || [], y = column(run, 'violations', 'y') || [];
  const rule = column(run, 'violations', 'rule') || [];
  return x.map((v, i) => ({x: v, y: y[i], rule: rule[i]}));
}

/* ---- painting ---- */

/* Least scale, pixels per nm, at which outlines are drawn: a gate of 65 nm is 2.6 pixels wide. */
const OUTLINES = 0.04;

/* Paint { scene, state, values, range, show, chosen } on a canvas. `state` is before, after or
   change; `values` has a number for each transistor; `range` is the value of the last colour;
   `show` has a flag for each part of the picture; `chosen` is the selected transistor or -1.
   The window { x, y, scale } has the centre in nm and the pixels per nm. */
function paint(canvas, what, window) {
  const ratio = globalThis.devicePixelRatio || 1;
  const w = canvas.clientWidth || canvas.width, h = canvas.clientHeight || canvas.height;
  if (canvas.width !== Math.round(w * ratio)) canvas.width = Math.round(w * ratio);
  if (canvas.height !== Math.round(h * ratio)) canvas.height = Math.round(h * ratio);
  const pen = canvas.getContext('2d'), half = [w / 2 / window.scale, h / 2 / window.scale];
  const p = {pen, ratio, w, h, ...window, box: [window.x - half[0], window.y - half[1], window.x + half[0], window.y + half[1]]};
  p.plain = () => pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  p.layout = () => pen.setTransform(ratio * p.scale, 0, 0, -ratio * p.scale,
    ratio * (w / 2 - p.x * p.scale), ratio * (h / 2 + p.y * p.scale));
  p.plain();
  pen.fillStyle = style('--paper');
  pen.fillRect(0, 0, w, h);
  if (what.show.image && what.scene.image && what.state !== 'before') paint_image(p, what.scene.image);
  paint_shapes(p, what, 'drawn', 'fill');
  paint_gates(p, what);
  if (what.show.mask && p.scale > OUTLINES) paint_shapes(p, what, what.state === 'before' ? 'drawn' : 'mask', 'outline');
  if (what.show.print && p.scale > OUTLINES) paint_shapes(p, what, what.state === 'before' ? 'drawn print' : 'print', 'print');
  if (what.show.violations && what.state !== 'before') paint_violations(p, what.scene.violations);
  if (what.chosen >= 0) paint_chosen(p, what.scene, what.chosen);
  scale_bar(p);
}

function paint_image(p, image) {
  p.layout();
  p.pen.save();
  p.pen.translate(image.x, image.y + image.rows * image.pixel);
  p.pen.scale(1, -1);
  p.pen.imageSmoothingQuality = 'high';
  p.pen.globalAlpha = 0.75;
  p.pen.drawImage(image.bitmap, 0, 0, image.columns * image.pixel, image.rows * image.pixel);
  p.pen.restore();
}

/* Paint the shapes of a role, from the last layer to the first, because poly (layer 0) is above
   active (layer 1). Contacts are painted last. */
function paint_shapes(p, what, role, as) {
  const is_contact = s => what.scene.layers[s.layer] === 'contact', height = s => (is_contact(s) ? -1 : s.layer);
  const all = what.scene.shapes.filter(s => s.role === role).sort((a, b) => height(b) - height(a));
  for (const s of all) {
    const colour = style(is_contact(s) && as === 'fill' ? '--contact' : `--layer-${s.layer % 6}-${as}`);
    if (as === 'fill' && !what.show.drawn) continue;
    if (as === 'outline' && !all_corrected(what.scene, s.layer)) continue;
    p.layout();
    p.pen.beginPath();
    trace(p, s);
    if (as === 'fill') {
      p.pen.globalAlpha = what.show.image ? 0.35 : 1;
      p.pen.fillStyle = colour;
      p.pen.fill('evenodd');
      p.pen.globalAlpha = 1;
      continue;
    }
    p.plain();
    p.pen.strokeStyle = colour;
    p.pen.lineWidth = as === 'print' ? Math.min(2, Math.max(1, 12 * p.scale)) : 1;
    p.pen.setLineDash(as === 'outline' && p.scale > 0.1 ? [5, 2] : []);
    p.pen.stroke();
    p.pen.setLineDash([]);
  }
}

const all_corrected = (scene, layer) => scene.shapes.some(s => s.layer === layer && s.role === 'mask');

/* Add the outlines of the shapes that overlap the window and are larger than half a pixel to the
   path. Do not use closePath: browsers search the whole path at each call, which takes 17 s for
   16,000 contacts. */
function trace(p, s) {
  const {start, points, bounds: b} = s, [x0, y0, x1, y1] = p.box, least = 0.5 / p.scale;
  for (let i = 0; i < start.length; i++) {
    const at = 4 * i;
    if (b[at] > x1 || b[at + 2] < x0 || b[at + 1] > y1 || b[at + 3] < y0) continue;
    if (b[at + 2] - b[at] < least && b[at + 3] - b[at + 1] < least) continue;
    const end = i + 1 < start.length ? 2 * start[i + 1] : points.length;
    p.pen.moveTo(points[2 * start[i]], points[2 * start[i] + 1]);
    for (let k = 2 * start[i] + 2; k < end; k += 2) p.pen.lineTo(points[k], points[k + 1]);
    if (s.closed) p.pen.lineTo(points[2 * start[i]], points[2 * start[i] + 1]);
  }
}

/* Paint the boxes of the transistors, one path for each colour, the largest deviations last. A
   box is at least 2.4 pixels wide, so that it is visible. If a layout has more than MANY
   transistors that are about a pixel wide, paint each pixel in the colour of the transistor with
   the largest deviation in the pixel. */
const MANY = 30000;
function paint_gates(p, what) {
  const {boxes, count} = what.scene, colours = diverging(), [x0, y0, x1, y1] = p.box;
  if (count > MANY && 60 * p.scale < 1.2) return paint_pixels(p, what, colours);
  const found = new Map(), broken = [], least = 2.4 / p.scale;
  for (let i = 0, k = 0; i < count; i++, k += 4) {
    if (boxes[k] > x1 || boxes[k + 2] < x0 || boxes[k + 1] > y1 || boxes[k + 3] < y0) continue;
    const value = what.values[i];
    if (value === undefined) continue;
    const level = is(value) ? level_of(value, what.range) : -1;
    if (!found.has(level)) found.set(level, new Path2D());
    const w = Math.max(least, boxes[k + 2] - boxes[k]), h = Math.max(least, boxes[k + 3] - boxes[k + 1]);
    found.get(level).rect((boxes[k] + boxes[k + 2] - w) / 2, (boxes[k + 1] + boxes[k + 3] - h) / 2, w, h);
    if (level < 0) broken.push(k);
  }
  const far = level => (level < 0 ? Infinity : Math.abs(level - LEVELS));
  const paths = [...found].sort((a, b) => far(a[0]) - far(b[0]));
  p.layout();
  p.pen.lineWidth = 0.8 / p.scale;
  p.pen.strokeStyle = style('--ink-soft');
  for (const [level, path] of paths) {
    p.pen.fillStyle = level < 0 ? style('--unknown') : rgb(colours[level]);
    p.pen.fill(path);
    if (p.scale > 0.05) p.pen.stroke(path);
  }
  p.pen.lineWidth = 2 / p.scale;
  p.pen.strokeStyle = style('--bad');
  p.pen.beginPath();
  for (const k of broken) {
    p.pen.moveTo(boxes[k], boxes[k + 1]), p.pen.lineTo(boxes[k + 2], boxes[k + 3]);
    p.pen.moveTo(boxes[k], boxes[k + 3]), p.pen.lineTo(boxes[k + 2], boxes[k + 1]);
  }
  p.pen.stroke();
}

function paint_pixels(p, what, colours) {
  const {boxes, count} = what.scene, w = Math.round(p.w), h = Math.round(p.h);
  const worst = new Float32Array(w * h).fill(-1), level = new Int8Array(w * h);
  for (let i = 0, k = 0; i < count; i++, k += 4) {
    const x = Math.floor(((boxes[k] + boxes[k + 2]) / 2 - p.x) * p.scale + w / 2);
    const y = Math.floor(h / 2 - ((boxes[k + 1] + boxes[k + 3]) / 2 - p.y) * p.scale);
    if (x < 0 || y < 0 || x >= w || y >= h) continue;
    const at = y * w + x, size = is(what.values[i]) ? Math.abs(what.values[i]) : Infinity;
    if (size <= worst[at]) continue;
    worst[at] = size;
    level[at] = is(what.values[i]) ? level_of(what.values[i], what.range) : -1;
  }
  const pixels = new ImageData(w, h), unknown = dark() ? [150, 150, 150] : [120, 120, 120];
  for (let i = 0; i < worst.length; i++)
    if (worst[i] >= 0) pixels.data.set([...(level[i] < 0 ? unknown : colours[level[i]]), 255], 4 * i);
  const sheet = new OffscreenCanvas(w, h);
  sheet.getContext('2d').putImageData(pixels, 0, 0);
  p.plain();
  p.pen.imageSmoothingEnabled = false;
  p.pen.drawImage(sheet, 0, 0, p.w, p.h);
}

const to_pixel = (p, x, y) => [p.w / 2 + (x - p.x) * p.scale, p.h / 2 - (y - p.y) * p.scale];

function paint_violations(p, violations) {
  p.plain();
  p.pen.strokeStyle = style('--bad');
  p.pen.lineWidth = 2;
  for (const v of violations) {
    const [x, y] = to_pixel(p, v.x, v.y);
    p.pen.beginPath();
    p.pen.moveTo(x, y - 7), p.pen.lineTo(x + 6.5, y + 5), p.pen.lineTo(x - 6.5, y + 5);
    p.pen.closePath();
    p.pen.stroke();
  }
}

function paint_chosen(p, scene, i) {
  const b = scene.boxes.subarray(4 * i, 4 * i + 4);
  const [x0, y0] = to_pixel(p, b[0], b[3]), [x1, y1] = to_pixel(p, b[2], b[1]), gap = 4;
  p.plain();
  for (const [colour, width] of [[style('--paper'), 5], [style('--accent'), 2.5]]) {
    p.pen.strokeStyle = colour;
    p.pen.lineWidth = width;
    p.pen.strokeRect(x0 - gap, y0 - gap, x1 - x0 + 2 * gap, y1 - y0 + 2 * gap);
  }
}

function scale_bar(p) {
  const wide = round_up(p.w / p.scale / 12), size = wide * p.scale;
  p.plain();
  p.pen.font = '12px system-ui, sans-serif';
  const text = wide < 1000 ? number(wide) + ' nm' : number(wide / 1000) + ' µm';
  p.pen.fillStyle = style('--paper');
  p.pen.globalAlpha = 0.8;
  p.pen.fillRect(4, p.h - 26, size + 14 + p.pen.measureText(text).width, 22);
  p.pen.globalAlpha = 1;
  p.pen.fillStyle = style('--ink');
  p.pen.fillRect(9, p.h - 14, size, 3);
  p.pen.fillText(text, 14 + size, p.h - 10);
}

/* ---- transistors ---- */

/* Return the figures of the transistor in row i of gates.csv, as pairs of a name and a text. */
function facts_of(run, i) {
  const at = name => { const c = column(run, 'gates', name); return c ? c[i] : undefined; };
  const pair = (word, name, unit) => (at(name) === undefined ? [] : [[word, quantity(at(name), unit)]]);
  return [['transistor', at('transistor') ?? '#' + (i + 1)], ...(at('cell') ? [['cell', at('cell')]] : []),
    ...(at('count') ? [['transistors of this class', number(at('count'))]] : []),
    ...(at('type') ? [['type', at('type')]] : []), ...pair('L', 'l', 'nm'), ...pair('W', 'w', 'nm'),
    ...pair('ΔIon as drawn', 'ion_before', '%'), ...pair('ΔIon', 'ion_after', '%'), ...pair('ΔIoff', 'ioff_after', '%'),
    ...pair('Δarea', 'area_after', '%'), ...pair('mask L', 'mask_l', 'nm'), ...pair('mask W', 'mask_w', 'nm'),
    ...(at('print') ? [['print', at('print')]] : []), ...(at('verdict') ? [['verdict', at('verdict')]] : [])];
}
const facts_list = (run, i) => el('dl', {class: 'facts'},
  facts_of(run, i).map(([word, text]) => el('div', null, el('dt', null, word), el('dd', null, text))));

/* Return the indices of the values by decreasing size; values that are not finite (transistors
   that do not print) come first. */
function worst_first(values) {
  const size = v => (is(v) ? Math.abs(v) : Infinity);
  return Array.from(values.keys()).sort((a, b) => (size(values[b]) - size(values[a]) || 0) || a - b);
}
