'use strict';
// Contents of the page, and how they are unpacked and shown.

const report = JSON.parse(document.getElementById('report').textContent);
const unpacked = new Map();

async function bytesOf(block) {
  const element = document.getElementById(block);
  const text = element.textContent;
  let packed;
  if (Uint8Array.fromBase64) {
    packed = Uint8Array.fromBase64(text);
  } else {
    const binary = atob(text);
    packed = new Uint8Array(binary.length);
    for (let i = 0; i < binary.length; ++i) packed[i] = binary.charCodeAt(i);
  }
  if (typeof DecompressionStream === 'undefined') {
    throw new Error('This browser cannot unpack gzip (DecompressionStream); one of 2023 or later can.');
  }
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  element.textContent = '';  // the text is not needed again
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

function unshuffled(bytes, size, count) {
  const plain = new Uint8Array(bytes.length);
  for (let k = 0; k < size; ++k) {
    for (let i = 0; i < count; ++i) plain[i * size + k] = bytes[k * count + i];
  }
  return plain.buffer;
}

// Integers of 16 bits, with an offset and a scale for every 4096 of them.
function scaledSamples(bytes, count) {
  const perScale = 4096;
  const pieces = Math.ceil(count / perScale);
  const head = new Float64Array(bytes.slice(0, 16 * pieces).buffer);
  const low = 16 * pieces;
  const high = low + count;
  const samples = new Float64Array(count);
  for (let i = 0; i < count; ++i) {
    const code = (bytes[low + i] | (bytes[high + i] << 8)) << 16 >> 16;
    const piece = i >> 12;
    samples[i] = code === -32768 ? NaN : head[2 * piece] + head[2 * piece + 1] * code;
  }
  return samples;
}

async function unpack(reference) {
  const bytes = await bytesOf(reference.block);
  switch (reference.coding) {
    case 'scaled16': return scaledSamples(bytes, reference.count);
    case 'float64': return new Float64Array(unshuffled(bytes, 8, reference.count));
    case 'float32': return new Float32Array(unshuffled(bytes, 4, reference.count));
    default: return bytes;
  }
}

// Numbers of a block; unpacked when they are asked for first.
function numbersOf(reference) {
  if (!unpacked.has(reference.block)) unpacked.set(reference.block, unpack(reference));
  return unpacked.get(reference.block);
}

function element(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) node.addEventListener(name.slice(2), value);
    else if (value === true) node.setAttribute(name, '');
    else if (value !== false && value !== undefined) node.setAttribute(name, value);
  }
  for (const child of children.flat()) if (child !== null) node.append(child);
  return node;
}

const prefixes = [[1e9, 'G'], [1e6, 'M'], [1e3, 'k'], [1, ''], [1e-3, 'm'], [1e-6, 'µ'], [1e-9, 'n'],
  [1e-12, 'p']];
const prefixed = new Set(['m', 'm/s', 'm/s^2', 'N', 's', 'Hz', 'J', 'W', 'Pa', 'm/N', 'm/s/N', 'm/s^2/N']);

function prettyUnits(units) {
  return units === '1' || !units ? '' : units.replace(/\^2/g, '²').replace(/\^3/g, '³');
}

// The prefix under which a number of this size is read best: [factor, unit].
function scaleFor(size, units) {
  if (!prefixed.has(units) || !(size > 0) || !isFinite(size)) return [1, prettyUnits(units)];
  for (const [factor, sign] of prefixes) {
    if (size >= factor * 0.9999) return [factor, sign + prettyUnits(units)];
  }
  return [1, prettyUnits(units)];
}

// 8.2·10⁻⁵.
function inPowers(value, places) {
  const [mantissa, power] = value.toExponential(places).split('e');
  return `${mantissa}·10${power.replace('+', '').replace(/./g, sign => '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'['-0123456789'.indexOf(sign)])}`;
}

function digits(value, count = 4) {
  if (value === null || value === undefined) return '–';
  if (!isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) return inPowers(value, Math.max(0, count - 1));
  return String(Number(value.toPrecision(count)));
}

function shown(value, units, count = 4) {
  if (value === null || value === undefined || !isFinite(value)) return '–';
  const [factor, unit] = scaleFor(Math.abs(value), units);
  return digits(value / factor, count) + (unit ? ' ' + unit : '');
}

function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();
}

const lineColours = {
  light: ['#0b5394', '#c2410c', '#2e7d32', '#7b1fa2', '#8d6e00', '#00838f', '#ad1457', '#455a64'],
  dark: ['#6db3f2', '#ff9d5c', '#7bc67e', '#ce93d8', '#e6c34d', '#4dd0e1', '#f48fb1', '#b0bec5'],
};
const darkness = matchMedia('(prefers-color-scheme: dark)');

function lineColour(number) {
  const list = darkness.matches ? lineColours.dark : lineColours.light;
  return list[number % list.length];
}

// What is to be drawn again when colours or sizes change.
const redrawn = new Set();
darkness.addEventListener('change', () => redrawn.forEach(draw => draw()));
let resizing = 0;
addEventListener('resize', () => {
  cancelAnimationFrame(resizing);
  resizing = requestAnimationFrame(() => redrawn.forEach(draw => draw()));
});

// A canvas as sharp as the screen: its context in CSS pixels.
function sharp(canvas, height) {
  const ratio = Math.max(1, devicePixelRatio || 1);
  const width = Math.max(60, canvas.clientWidth || canvas.parentElement.clientWidth || 600);
  canvas.style.height = height + 'px';
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  context.font = '12px system-ui, "DejaVu Sans", sans-serif';
  return [context, width, height];
}

// Viridis at nine places (a colour map by Smith and van der Walt, CC0).
const viridis = [[68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141],
  [39, 173, 129], [92, 200, 99], [170, 220, 50], [253, 231, 37]];
const palettes = {
  viridis,
  grey: [[255, 255, 255], [0, 0, 0]],
  heat: [[0, 0, 0], [90, 0, 60], [190, 30, 30], [245, 140, 20], [255, 240, 120], [255, 255, 255]],
  signed: [[5, 80, 160], [110, 165, 215], [240, 240, 240], [235, 140, 90], [160, 20, 10]],
};

function paletteColour(stops, share) {
  const place = Math.min(1, Math.max(0, share)) * (stops.length - 1);
  const i = Math.min(stops.length - 2, Math.floor(place));
  return stops[i].map((low, k) => Math.round(low + (stops[i + 1][k] - low) * (place - i)));
}

// Pieces of a page that are made when they come into view; all of them before it is printed.
const waiting = new Map();
const watcher = 'IntersectionObserver' in window ? new IntersectionObserver(entries => {
  for (const entry of entries) if (entry.isIntersecting) makeNow(entry.target);
}, {rootMargin: '300px'}) : null;

function makeNow(place) {
  const make = waiting.get(place);
  if (!make) return Promise.resolve();
  waiting.delete(place);
  if (watcher) watcher.unobserve(place);
  return make().catch(error => {
    place.append(element('p', {class: 'verdict failed', role: 'alert'}, String(error.message || error)));
  });
}

function whenSeen(place, make) {
  waiting.set(place, make);
  if (watcher) watcher.observe(place);
  else makeNow(place);
}

function makeAll() {
  return Promise.all([...waiting.keys()].map(makeNow));
}
// A page is printed as it stands when the print begins: what has not been looked at is made while
// nothing else is to be done, one piece after the other.
function makeRestWhenIdle() {
  const idle = window.requestIdleCallback || (act => setTimeout(act, 200));
  const [next] = waiting.keys();
  if (next) idle(() => makeNow(next).then(makeRestWhenIdle));
}
addEventListener('beforeprint', () => {
  for (const fold of document.querySelectorAll('details:not([open])')) { fold.open = true; fold.dataset.opened = 'for print'; }
  return makeAll();
});
addEventListener('afterprint', () => {
  for (const fold of document.querySelectorAll('details[data-opened]')) { fold.open = false; delete fold.dataset.opened; }
});
