/* SPDX-License-Identifier: BSD-3-Clause */
/* Functions for document elements, numbers, statistics, tables, packed arrays and colours. Texts
   of the data are inserted as text nodes, never as markup. */

/* ---- elements ---- */

function make(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes || {}))
    if (name.startsWith('on')) node.addEventListener(name.slice(2), value);
    else if (value !== null && value !== undefined && value !== false)
      node.setAttribute(name, value === true ? '' : value);
  node.append(...some(children));
  return node;
}
/* Return a nested list as a flat list, without null, undefined and false. */
const some = list => list.flat(Infinity).filter(c => c !== null && c !== undefined && c !== false);
const el = (tag, attributes, ...children) =>
  make(document.createElement(tag), attributes, children);
const svg = (tag, attributes, ...children) =>
  make(document.createElementNS('http://www.w3.org/2000/svg', tag), attributes, children);

/* ---- numbers ---- */

const is = Number.isFinite;
const minus = text => text.replace(/^-/, '\u2212');

/* Return a number as text: an integer with thousands separators, another number with four
   significant digits, a dash if the number is not finite. */
function number(x) {
  if (!is(x)) return '\u2013';
  const size = Math.abs(x);
  if (Number.isInteger(x) && size < 1e15)
    return minus(String(x).replace(/\B(?=(\d{3})+$)/g, '\u202f'));
  if (size >= 1e6 || (size < 1e-4 && size > 0)) return minus(x.toExponential(2));
  return minus(String(Number(x.toPrecision(4))));
}
const quantity = (x, unit) => number(x) + (is(x) && unit ? '\u202f' + unit : '');

/* Return a number with a fixed number of decimals; a dash if the number is not finite. */
const fixed = (x, decimals) => (is(x) ? minus(x.toFixed(decimals)) : '\u2013');

/* Return the least number of the form 1, 2 or 5 times a power of ten that is at least x. */
function round_up(x) {
  if (!(x > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(x));
  return [1, 2, 5, 10].find(f => f * power >= x * (1 - 1e-9)) * power;
}

function ticks(low, high, wanted) {
  const step = round_up((high - low) / wanted), out = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + step * 1e-9; k++)
    out.push(Number((k * step).toPrecision(10)));
  return out;
}

/* ---- statistics ---- */

const finite = values => values.filter(is);
/* A weighted list is an array of values with the array `n` of their weights, the numbers of
   transistors. mapped() applies a function to the values and keeps the weights. */
const weighted = () => Object.assign([], {n: []});
const mapped = (values, f) => Object.assign(values.map(f), {n: values.n});
const total = values => (values.n ? values.n.reduce((a, b) => a + b, 0) : values.length);
const mean = values => values.reduce((a, v, i) => a + v * (values.n ? values.n[i] : 1), 0) / total(values); /* NaN without values */
const stdv = values => {
  const m = mean(values);
  return Math.sqrt(mean(mapped(values, v => (v - m) ** 2)));
};
const largest = values => values.reduce((a, b) => Math.max(a, b), 0);
function quantile(values, q) {
  const sorted = Float64Array.from(values).sort();
  return sorted.length ? sorted[Math.min(sorted.length - 1, Math.floor(q * sorted.length))] : NaN;
}

/* Return a round number that is at least the size of 98 % of the values. */
const range_of = values => round_up(quantile(values.map(Math.abs), 0.98) || 0);

/* ---- tables ---- */

/* Return the values of a column of a run's table; null if the run has no such table or column. */
function column(run, table, name) {
  const t = run.tables[table], c = t && t.columns.find(c => c.name === name);
  return c ? c.values : null;
}
const deviations = (run, name) => column(run, 'gates', name) || [];

/* ---- packed arrays ---- */

async function inflate(text) {
  const letters = atob(text), bytes = new Uint8Array(letters.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = letters.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Response(stream).arrayBuffer();
}

/* Return the integers of a text that json_packed (report/json.h) has written. */
async function unpack(text, stride) {
  const numbers = new Int32Array(await inflate(text));
  for (let i = stride; i < numbers.length; i++) numbers[i] += numbers[i - stride];
  return numbers;
}

/* ---- colours ---- */

const style = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
let printing = false;
const dark = () => !printing && style('--is-dark') === '1';

/* Convert a colour from Oklch to sRGB, 0 to 255 per channel (Ottosson 2020). */
function oklch(lightness, chroma, hue) {
  const a = chroma * Math.cos(hue), b = chroma * Math.sin(hue);
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  const channel = v => {
    const c = Math.min(1, Math.max(0, v));
    return Math.round(255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055));
  };
  return [channel(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
    channel(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
    channel(-0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s)];
}

/* Return 2 LEVELS + 1 colours from blue over the colour of the paper to orange, with even steps
   of lightness. Readers with the common forms of colour blindness can distinguish blue and
   orange. */
const LEVELS = 32;
function diverging() {
  const from = dark() ? 0.30 : 0.97, to = dark() ? 0.80 : 0.47, out = [];
  for (let k = -LEVELS; k <= LEVELS; k++) {
    const t = Math.abs(k) / LEVELS, hue = k < 0 ? 4.5 : 0.95;
    out.push(oklch(from + t * (to - from), 0.005 + 0.135 * t, hue));
  }
  return out;
}
const level_of = (value, range) =>
  LEVELS + Math.round(LEVELS * Math.max(-1, Math.min(1, value / range)));
const rgb = c => 'rgb(' + c.join(',') + ')';
