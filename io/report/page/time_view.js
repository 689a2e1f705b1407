// The stretch of time that all views of a run show, and the moment that they mark.

class TimeView {
  constructor(first, last) {
    Object.assign(this, {first, last, from: first, to: last, moment: null});
    this.former = [];
    this.listeners = new Set();
    this.momentListeners = new Set();
  }
  get length() { return this.to - this.from; }
  set(from, to, keep = true) {
    from = Math.max(this.first, from);
    to = Math.min(this.last, to);
    if (!(to > from)) return;
    if (keep) this.former.push([this.from, this.to]);
    [this.from, this.to] = [from, to];
    this.listeners.forEach(listen => listen());
  }
  reset() { this.set(this.first, this.last); }
  back() {
    const former = this.former.pop();
    if (former) this.set(former[0], former[1], false);
  }
  zoom(factor, about = 0.5) {
    const middle = this.from + about * this.length;
    this.set(middle - (middle - this.from) * factor, middle + (this.to - middle) * factor);
  }
  move(share) {
    const shift = Math.max(this.first - this.from, Math.min(this.last - this.to, share * this.length));
    this.set(this.from + shift, this.to + shift);
  }
  // A stretch with some room about it.
  show(from, to) {
    const room = 0.15 * (to - from) + 1e-3 * (this.last - this.first);
    this.set(from - room, to + room);
  }
  mark(moment) {
    this.moment = moment;
    this.momentListeners.forEach(listen => listen());
  }
}

// Buttons that move the view, for those who use no mouse.
function timeTools(view, player) {
  const button = (text, title, act) => element('button', {type: 'button', title, onclick: act}, text);
  const stretch = element('span', {class: 'readout'});
  const tell = () => { stretch.textContent = `${shown(view.from, 's', 5)} to ${shown(view.to, 's', 5)}`; };
  view.listeners.add(tell);
  tell();
  const moment = element('span', {class: 'readout'});
  view.momentListeners.add(() => { moment.textContent = `at ${shown(view.moment, 's', 5)}`; });
  return element('div', {class: 'tools bar', role: 'group', 'aria-label': 'Stretch of time'},
    motionButton(player.motion, ['Play', 'Stop'], 'what is shown, from the time that is marked'), element('label', {}, 'Lasts', player.pace),
    button('◀', 'Earlier', () => view.move(-0.5)), button('▶', 'Later', () => view.move(0.5)),
    button('+', 'Closer', () => view.zoom(0.5)), button('−', 'Wider', () => view.zoom(2)),
    button('Back', 'The stretch before', () => view.back()),
    button('All', 'The whole run', () => view.reset()), stretch, moment);
}

// Samples with least and largest values of groups of 4, 16, 64 …, so that any stretch draws fast.
class Pyramid {
  // samples: all, or (min, max) pairs of `factor` each
  constructor(samples, factor) {
    this.factor = factor;
    this.samples = samples;
    this.levels = [];
    if (factor > 1) {
      this.levels.push({size: factor, pairs: samples});
    }
  }
  get count() { return this.factor > 1 ? this.samples.length / 2 : this.samples.length; }
  level(k) {
    while (this.levels.length <= k) {
      const last = this.levels[this.levels.length - 1];
      const source = last ? last.pairs : null;
      const count = source ? source.length / 2 : this.samples.length;
      const groups = Math.ceil(count / 4);
      const pairs = new Float64Array(2 * groups);
      for (let g = 0; g < groups; ++g) {
        let low = NaN, high = NaN;
        for (let i = 4 * g; i < Math.min(count, 4 * g + 4); ++i) {
          const a = source ? source[2 * i] : this.samples[i];
          const b = source ? source[2 * i + 1] : a;
          if (!(a >= low)) low = isNaN(a) ? low : a;
          if (!(b <= high)) high = isNaN(b) ? high : b;
        }
        pairs[2 * g] = low;
        pairs[2 * g + 1] = high;
      }
      this.levels.push({size: (last ? last.size : 1) * 4, pairs});
    }
    return this.levels[k];
  }
  // Values between the samples begin and end (of the run), at most about 2·most points:
  // [indices, values]; the very samples where they are few enough.
  between(begin, end, most) {
    const count = end - begin;
    if (this.factor === 1 && count <= 2 * most) {
      const indices = new Float64Array(count), values = new Float64Array(count);
      for (let i = 0; i < count; ++i) { indices[i] = begin + i; values[i] = this.samples[begin + i]; }
      return [indices, values];
    }
    let k = 0;
    while (this.level(k).size * 2 * most < count * 1 && this.level(k).pairs.length > 8) ++k;
    const {size, pairs} = this.level(k);
    const first = Math.max(0, Math.floor(begin / size));
    const last = Math.min(pairs.length / 2, Math.ceil(end / size));
    const indices = new Float64Array(2 * Math.max(0, last - first)), values = new Float64Array(indices.length);
    for (let g = first; g < last; ++g) {
      const i = 2 * (g - first);
      indices[i] = (g + 0.25) * size;
      indices[i + 1] = (g + 0.75) * size;
      values[i] = pairs[2 * g];
      values[i + 1] = pairs[2 * g + 1];
    }
    return [indices, values];
  }
}
