// Diagrams on a canvas: axes, curves, pictures, zoom by drag and wheel, values at the pointer.

function niceSteps(from, to, most) {
  const rough = (to - from) / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map(m => m * power).find(s => s >= rough * 0.999);
  const ticks = [];
  for (let i = Math.ceil(from / step - 1e-9); i * step <= to + step * 1e-9; ++i) ticks.push(i * step);
  return ticks;
}

function multiplesOf(step, from, to) {
  const ticks = [];
  for (let i = Math.ceil(from / step); i * step <= to; ++i) ticks.push(i * step);
  return ticks;
}

function tickText(value, step) {
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-3) return value.toExponential(1).replace('.0e', 'e').replace('e+', 'e');
  const places = Math.min(8, Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));
  return value.toFixed(places);
}

class Axis {
  constructor(label, units, from, to, isLog = false) {
    Object.assign(this, {label, units, from, to, isLog, first: from, last: to});
  }
  get inside() { return this.isLog ? [Math.log10(this.from), Math.log10(this.to)] : [this.from, this.to]; }
  share(value) {
    const [low, high] = this.inside;
    return ((this.isLog ? Math.log10(value) : value) - low) / (high - low);
  }
  value(share) {
    const [low, high] = this.inside;
    const place = low + share * (high - low);
    return this.isLog ? 10 ** place : place;
  }
  set(from, to) { if (to > from) [this.from, this.to] = [from, to]; }
  reset() { this.set(this.first, this.last); }
  zoom(share, factor) {
    const [low, high] = this.inside;
    const middle = low + share * (high - low);
    const next = [middle + (low - middle) * factor, middle + (high - middle) * factor];
    this.set(...(this.isLog ? next.map(x => 10 ** x) : next));
  }
  get text() {
    // Axes of one quantity share a unit by their `size`.
    const unit = scaleFor(Math.max(Math.abs(this.from), Math.abs(this.to), this.size || 0), this.units);
    return {factor: unit[0], label: this.label + (unit[1] ? ` (${unit[1]})` : '')};
  }
  ticks(most) {
    const {factor} = this.text;
    if (this.isLog) {
      const [low, high] = this.inside;
      const step = Math.max(1, Math.ceil((high - low) / most));
      const ticks = [];
      for (let p = Math.ceil(low - 1e-9); p <= high + 1e-9; p += step) ticks.push([10 ** p, digits(10 ** p / factor, 1).replace(/^1·/, '')]);
      if (ticks.length >= 2) return ticks;
      return niceSteps(this.from, this.to, most).map(v => [v, digits(v / factor, 3)]);
    }
    const scaled = this.every && this.to - this.from > 2 * this.every ? multiplesOf(this.every, this.from, this.to)
      : niceSteps(this.from / factor, this.to / factor, most);
    const step = scaled.length > 1 ? scaled[1] - scaled[0] : 1;
    return scaled.map(v => [v * factor, tickText(v, step)]);
  }
}

// Range of all finite values, a little wider; of positive ones alone for logarithms.
function rangeOf(arrays, isLog) {
  let low = Infinity, high = -Infinity;
  for (const values of arrays) {
    for (const value of values) {
      if (!isFinite(value) || (isLog && value <= 0)) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  if (!(low <= high)) return isLog ? [0.1, 10] : [-1, 1];
  if (isLog) return low === high ? [low / 2, high * 2] : [low / 1.15, high * 1.15];
  const margin = low === high ? Math.max(Math.abs(low) * 0.1, 1e-12) : (high - low) * 0.04;
  return [low - margin, high + margin];
}

class Chart {
  // options: x, y (Axis), height, paint(chart) draws within the frame, hover(x, y) gives a text,
  // click(x, y), zoomed(), isToScale: one length for one number along both axes;
  // marks(chart) draws what moves over all of this, play() answers the space bar
  constructor(place, options) {
    Object.assign(this, options);
    this.place = place;
    this.canvas = element('canvas', {tabindex: '0', role: 'img', 'aria-label': this.name || ''});
    this.readout = element('div', {class: 'readout', 'aria-live': 'off'});
    place.append(this.canvas, this.readout);
    // The sides are those of the histories, so that one time stands at one place.
    this.margin = {left: 76, right: 25, top: 8, bottom: 38};
    this.listen();
    watchSight(this.canvas);
    redrawn.add(() => this.draw());
  }
  get inner() {
    const {left, right, top, bottom} = this.margin;
    return {x: left, y: top, width: this.width - left - right, height: this.total - top - bottom};
  }
  px(value) { const f = this.inner; return f.x + this.x.share(value) * f.width; }
  py(value) { const f = this.inner; return f.y + (1 - this.y.share(value)) * f.height; }
  at(event) {
    const box = this.canvas.getBoundingClientRect();
    const f = this.inner;
    const x = event.clientX - box.left, y = event.clientY - box.top;
    return {px: x, py: y, sx: (x - f.x) / f.width, sy: 1 - (y - f.y) / f.height};
  }
  isInside(p) { return p.sx >= 0 && p.sx <= 1 && p.sy >= 0 && p.sy <= 1; }
  listen() {
    let start = null;
    const canvas = this.canvas;
    canvas.addEventListener('pointerdown', event => {
      const p = this.at(event);
      if (!this.isInside(p)) return;
      start = p;
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener('pointermove', event => {
      const p = this.at(event);
      this.selection = start && Math.hypot(p.px - start.px, p.py - start.py) > 5 ? [start, p] : null;
      this.pointer = this.isInside(p) ? p : null;
      this.readout.textContent = this.pointer && this.hover
        ? this.hover(this.x.value(p.sx), this.y.value(p.sy)) || '' : '';
      this.draw();
    });
    canvas.addEventListener('pointerup', event => {
      const p = this.at(event);
      if (start && this.selection) this.select(start, p);
      else if (start && this.click) this.click(this.x.value(p.sx), this.y.value(p.sy));
      start = null;
      this.selection = null;
      this.draw();
    });
    canvas.addEventListener('pointerleave', () => { this.pointer = null; this.draw(); });
    canvas.addEventListener('dblclick', () => this.reset());
    canvas.addEventListener('wheel', event => {
      if (!event.ctrlKey && !event.shiftKey) return;  // a plain wheel scrolls the page
      event.preventDefault();
      const p = this.at(event);
      this.scale(p, event.deltaY > 0 || event.deltaX > 0 ? 1.25 : 0.8);
    }, {passive: false});
    canvas.addEventListener('keydown', event => {
      const middle = {sx: 0.5, sy: 0.5};
      const shift = {ArrowLeft: -0.2, ArrowRight: 0.2}[event.key];
      if (event.key === '+') this.scale(middle, 0.8);
      else if (event.key === '-') this.scale(middle, 1.25);
      else if (event.key === '0') this.reset();
      else if (event.key === ' ' && this.play) this.play();
      else if (shift) {
        const from = this.x.value(shift), to = this.x.value(1 + shift);
        this.x.set(from, to);
        this.changed();
      } else return;
      event.preventDefault();
    });
  }
  scale(p, factor) {
    this.x.zoom(p.sx, factor);
    if (!this.keepsY) this.y.zoom(p.sy, factor);
    this.changed();
  }
  select(a, b) {
    const shares = (from, to) => [Math.max(0, Math.min(from, to)), Math.min(1, Math.max(from, to))];
    const [x0, x1] = shares(a.sx, b.sx), [y0, y1] = shares(a.sy, b.sy);
    const isWide = Math.abs(a.px - b.px) > 8, isHigh = Math.abs(a.py - b.py) > 8;
    const xs = [this.x.value(x0), this.x.value(x1)], ys = [this.y.value(y0), this.y.value(y1)];
    if (isWide) this.x.set(...xs);
    if (isHigh && !this.keepsY) this.y.set(...ys);
    this.changed();
  }
  reset() { this.x.reset(); this.y.reset(); this.changed(); }
  changed() { if (this.zoomed) this.zoomed(); this.draw(); }
  draw() {
    if (!this.canvas.isConnected) return;
    late.delete(this.canvas);
    this.still = null;
    this.drawStill();
    this.drawMarks();
  }
  // What has moved alone, over a copy of the rest.
  mark() {
    drawWhenSeen(this.canvas, () => {
      if (!this.canvas.isConnected || !this.context) { this.draw(); return; }
      const {canvas, context} = this;
      if (!this.still) {
        this.drawStill();
        this.still = element('canvas', {width: canvas.width, height: canvas.height});
        this.still.getContext('2d').drawImage(canvas, 0, 0);
      } else {
        context.save();
        context.setTransform(1, 0, 0, 1, 0, 0);
        context.clearRect(0, 0, canvas.width, canvas.height);
        context.drawImage(this.still, 0, 0);
        context.restore();
      }
      this.drawMarks();
    });
  }
  drawMarks() {
    if (!this.marks) return;
    const c = this.context, f = this.inner;
    c.save();
    c.beginPath();
    c.rect(f.x, f.y, f.width, f.height);
    c.clip();
    this.marks(this);
    c.restore();
  }
  drawStill() {
    [this.context, this.width, this.total] = sharp(this.canvas, this.height || 300);
    const c = this.context, f = this.inner;
    if (this.isToScale) this.equalise(f);
    c.save();
    c.beginPath();
    c.rect(f.x, f.y, f.width, f.height);
    c.clip();
    if (this.under) this.under(this);
    this.grid(c, f);
    this.paint(this);
    if (this.selection) {
      const [a, b] = this.selection;
      c.fillStyle = colour('window');
      c.fillRect(Math.min(a.px, b.px), this.keepsY ? f.y : Math.min(a.py, b.py), Math.abs(a.px - b.px),
        this.keepsY ? f.height : Math.abs(a.py - b.py));
    }
    c.restore();
    this.frame(c, f);
  }
  // Widens one axis about its middle.
  equalise(f) {
    const x = (this.x.to - this.x.from) / f.width, y = (this.y.to - this.y.from) / f.height;
    const [axis, extent] = x < y ? [this.x, y * f.width] : [this.y, x * f.height];
    const middle = 0.5 * (axis.from + axis.to);
    axis.set(middle - 0.5 * extent, middle + 0.5 * extent);
  }
  grid(c, f) {
    if (this.isPicture) return;
    c.strokeStyle = colour('line');
    c.lineWidth = 0.6;
    c.beginPath();
    for (const [value] of this.x.ticks(Math.max(4, f.width / 90))) { c.moveTo(this.px(value), f.y); c.lineTo(this.px(value), f.y + f.height); }
    for (const [value] of this.y.ticks(f.height / 45)) { c.moveTo(f.x, this.py(value)); c.lineTo(f.x + f.width, this.py(value)); }
    c.stroke();
  }
  frame(c, f) {
    c.strokeStyle = colour('faint');
    c.fillStyle = colour('text');
    c.lineWidth = 1;
    c.strokeRect(f.x, f.y, f.width, f.height);
    c.textAlign = 'center';
    c.textBaseline = 'top';
    for (const [value, text] of this.x.ticks(Math.max(4, f.width / 90))) c.fillText(text, this.px(value), f.y + f.height + 5);
    c.fillText(this.x.text.label, f.x + f.width / 2, f.y + f.height + 21);
    c.textAlign = 'right';
    c.textBaseline = 'middle';
    for (const [value, text] of this.y.ticks(f.height / 45)) c.fillText(text, f.x - 6, this.py(value));
    c.save();
    c.translate(12, f.y + f.height / 2);
    c.rotate(-Math.PI / 2);
    c.textAlign = 'center';
    c.fillText(this.y.text.label, 0, 0);
    c.restore();
  }
  line(xs, ys, stroke, width = 1.4, dashes = []) {
    const c = this.context;
    c.strokeStyle = stroke;
    c.lineWidth = width;
    c.setLineDash(dashes);
    c.beginPath();
    let isDown = false;
    for (let i = 0; i < xs.length; ++i) {
      const x = this.px(xs[i]), y = this.py(ys[i]);
      if (!isFinite(x) || !isFinite(y)) { isDown = false; continue; }
      if (isDown) c.lineTo(x, y); else c.moveTo(x, y);
      isDown = true;
    }
    c.stroke();
    c.setLineDash([]);
  }
  dot(x, y, fill, radius = 4, stroke = null) {
    const c = this.context;
    c.beginPath();
    c.arc(this.px(x), this.py(y), radius, 0, 2 * Math.PI);
    c.fillStyle = fill;
    c.fill();
    if (stroke) { c.strokeStyle = stroke; c.lineWidth = 1.5; c.stroke(); }
  }
}
