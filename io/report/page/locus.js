// Eigenvalues along a key, the modes that belong to them, and one slider for both.

// What the views of a section share: a value of the key, a moment of the run.
class Place {
  constructor(values, times) {
    Object.assign(this, {values, times, value: values[0]});
    this.listeners = new Set();
  }
  set(value) {
    this.isFresh = false;  // whoever plays it begins here
    this.value = Math.min(this.values[this.values.length - 1], Math.max(this.values[0], value));
    if (this.wish && this.wish.value !== this.value) this.wish = null;
    this.listeners.forEach(listen => listen());
  }
  // Goes to a value to show the motion of a frequency there.
  follow(value, frequency) {
    this.wish = {value, frequency};
    if (this.choose) this.choose();
    this.set(value);
  }
  between(from, to, x) {
    for (let i = 1; i < from.length; ++i) {
      if (from[i - 1] === null || from[i] === null || to[i - 1] === null || to[i] === null) continue;
      if ((x - from[i - 1]) * (x - from[i]) <= 0)
        return to[i - 1] + (to[i] - to[i - 1]) * (from[i] === from[i - 1] ? 0 : (x - from[i - 1]) / (from[i] - from[i - 1]));
    }
    return null;
  }
  get moment() { return this.between(this.values, this.times, this.value); }
  valueAt(moment) { return this.between(this.times, this.values, moment); }
}

// How far a motion is from the one wished for; one that decays is farther.
function offOf(wish, motion) {
  return Math.abs(motion.frequency - wish.frequency) / (wish.frequency + 1) + (motion.growth > 0 ? 0 : 0.05);
}

function branchAt(branch, value) {
  const {values} = branch;
  let low = 0, high = values.length - 1;
  if (high < 0 || value < values[0] - 1e-12 || value > values[high] + 1e-12) return null;
  while (high - low > 1) { const m = (low + high) >> 1; if (values[m] <= value) low = m; else high = m; }
  const share = high === low || values[high] === values[low] ? 0 : (value - values[low]) / (values[high] - values[low]);
  return {growth: branch.growth[low] + share * (branch.growth[high] - branch.growth[low]),
    frequency: branch.frequency[low] + share * (branch.frequency[high] - branch.frequency[low])};
}

async function makeLocus(place, view, section) {
  const [value, growth, frequency] = await Promise.all([view.value, view.growth, view.frequency].map(numbersOf));
  const branches = [];
  let begin = 0;
  view.sizes.forEach((size, number) => {
    const part = list => list.subarray(begin, begin + size);
    branches.push({number, values: part(value), growth: part(growth), frequency: part(frequency)});
    begin += size;
  });
  const vibrating = branches.filter(branch => branch.frequency.some(f => f > 0));
  const where = section.place;
  const share = v => (v - where.values[0]) / (where.values[where.values.length - 1] - where.values[0] || 1);
  const tint = v => `rgb(${paletteColour(palettes.viridis, 0.92 * share(v))})`;
  const describe = (branch, v) => {
    const now = branchAt(branch, v);
    return now ? `branch ${branch.number + 1} at ${view.parameter} = ${shown(v, view.units, 5)}: ${shown(now.frequency, 'Hz', 6)}, growth ${digits(now.growth, 4)} 1/s` : '';
  };
  // The point of any branch nearest to the pointer, on the screen.
  const nearest = (chart, px, x, y) => {
    let best = null, least = 400;
    for (const branch of vibrating) {
      const xs = x(branch), ys = y(branch);
      for (let i = 0; i < branch.values.length; ++i) {
        const off = (chart.px(xs[i]) - px.px) ** 2 + (chart.py(ys[i]) - px.py) ** 2;
        if (off < least) { least = off; best = {branch, i}; }
      }
    }
    return best;
  };
  const zeroLine = (chart, isVertical) => {
    const c = chart.context, f = chart.inner;
    c.strokeStyle = colour('failed');
    c.setLineDash([5, 4]);
    c.lineWidth = 1;
    c.beginPath();
    if (isVertical) { c.moveTo(chart.px(0), f.y); c.lineTo(chart.px(0), f.y + f.height); }
    else { c.moveTo(f.x, chart.py(0)); c.lineTo(f.x + f.width, chart.py(0)); }
    c.stroke();
    c.setLineDash([]);
  };
  const side = element('div', {class: 'side'}), left = element('figure'), right = element('figure');
  side.append(left, right);
  place.append(side);
  const growths = vibrating.map(branch => branch.growth);
  const plane = new Chart(left, {
    x: new Axis('growth rate', '1/s', ...rangeOf(growths)), y: new Axis('frequency', 'Hz', ...rangeOf(vibrating.map(b => b.frequency))),
    height: 380, name: 'Root locus: frequency over growth rate',
    paint: chart => {
      zeroLine(chart, true);
      for (const branch of vibrating) {
        if (view.points) for (let i = 0; i < branch.values.length; ++i) chart.dot(branch.growth[i], branch.frequency[i], tint(branch.values[i]), 2);
        else for (let i = 1; i < branch.values.length; ++i)
          chart.line(branch.growth.subarray(i - 1, i + 1), branch.frequency.subarray(i - 1, i + 1), tint(branch.values[i]), 1.8);
      }
    },
    marks: chart => {
      for (const branch of vibrating) {
        const now = branchAt(branch, where.value);
        if (now) chart.dot(now.growth, now.frequency, now.growth > 0 ? colour('loud') : colour('accent'), section.branch === branch.number ? 6 : 4, colour('ground'));
      }
    },
    hover: () => {
      const best = plane.pointer && nearest(plane, plane.pointer, b => b.growth, b => b.frequency);
      return best ? describe(best.branch, best.branch.values[best.i]) : '';
    },
    click: () => {
      const best = plane.pointer && nearest(plane, plane.pointer, b => b.growth, b => b.frequency);
      if (best) choose(best);
    },
  });
  const along = new Chart(right, {
    x: new Axis(view.parameter, view.units, where.values[0], where.values[where.values.length - 1]), y: new Axis('growth rate', '1/s', ...rangeOf(growths)),
    height: 380, name: 'Growth rate along the key',
    paint: chart => {
      const c = chart.context, f = chart.inner;
      c.fillStyle = colour('burst');
      for (const window of view.windows) c.fillRect(chart.px(window.from), f.y, Math.max(1, chart.px(window.to) - chart.px(window.from)), f.height);
      zeroLine(chart, false);
      for (const branch of vibrating) {
        if (view.points) for (let i = 0; i < branch.values.length; ++i) chart.dot(branch.values[i], branch.growth[i], lineColour(branch.number), 1.8);
        else chart.line(branch.values, branch.growth, lineColour(branch.number), section.branch === branch.number ? 2.6 : 1.2);
      }
    },
    marks: chart => {
      const c = chart.context, f = chart.inner;
      c.fillStyle = colour('mark');
      c.fillRect(chart.px(where.value) - 0.75, f.y, 1.5, f.height);
      const chosen = branches[section.branch], now = chosen && branchAt(chosen, where.value);
      if (now) chart.dot(where.value, now.growth, now.growth > 0 ? colour('loud') : colour('accent'), 5, colour('ground'));
    },
    hover: x => {
      const best = along.pointer && nearest(along, along.pointer, b => b.values, b => b.growth);
      return best ? describe(best.branch, best.branch.values[best.i]) : `${view.parameter} = ${shown(x, view.units, 5)}`;
    },
    click: x => {
      const best = along.pointer && nearest(along, along.pointer, b => b.values, b => b.growth);
      if (best) choose(best); else where.set(x);
    },
  });
  const choose = best => {
    section.branch = best.branch.number;
    section.wanted = {frequency: best.branch.frequency[best.i], growth: best.branch.growth[best.i]};
    where.set(best.branch.values[best.i]);
  };
  // The branch that a wish is about: of its frequency there, and growing if one is.
  where.choose = () => {
    let least = Infinity;
    for (const branch of vibrating) {
      const now = branchAt(branch, where.wish.value);
      if (!now) continue;
      const off = offOf(where.wish, now);
      if (off < least) { least = off; section.branch = branch.number; }
    }
  };
  section.wantedNow = () => {
    const branch = branches[section.branch];
    return branch ? branchAt(branch, where.value) : null;
  };
  if (section.branch === undefined) {
    const most = branch => branch.growth.reduce((a, b) => b > a ? b : a, -Infinity);
    const worst = vibrating.reduce((a, b) => most(b) > most(a) ? b : a, vibrating[0]);
    if (worst) section.branch = worst.number;
  }
  if (where.wish) where.choose();
  place.append(element('figcaption', {}, `Colour on the left: position along the key, dark to light; shaded on the right: unstable windows. ${view.points ? 'Points in the order of their frequencies at each value.' : 'Click a branch to follow its mode.'}`));
  let drawnBranch = null;
  const draw = () => {
    const isOther = drawnBranch !== section.branch;
    drawnBranch = section.branch;
    for (const chart of [plane, along]) if (isOther) chart.draw(); else chart.mark();
  };
  for (const chart of [plane, along]) chart.play = () => section.player && section.player.motion.toggle();
  where.listeners.add(draw);
  draw();
  place.locus = {plane, along, branches};  // for those who test the page
}

// The slider of a section, with what it moves.
function placeTools(section, view) {
  const where = section.place;
  const steps = 1000;
  const low = where.values[0], high = where.values[where.values.length - 1];
  const slider = element('input', {type: 'range', min: 0, max: steps, step: 1, 'aria-label': view.parameter,
    oninput: () => where.set(low + (high - low) * slider.value / steps)});
  const text = element('span', {class: 'readout'});
  const tell = () => {
    slider.value = Math.round(steps * (where.value - low) / (high - low || 1));
    const moment = where.moment;
    text.textContent = `${view.parameter} = ${shown(where.value, view.units, 5)}` + (moment === null ? '' : `, passed at ${shown(moment, 's', 5)}`);
  };
  where.listeners.add(tell);
  tell();
  slider.style.width = 'min(420px, 60vw)';
  section.player = placePlayer(where);
  return element('div', {class: 'tools'}, motionButton(section.player.motion, ['Play', 'Stop'], `along ${view.parameter}`),
    element('label', {}, 'Lasts', section.player.pace), element('label', {}, 'Position', slider), text);
}

// The frame nearest to a position, the one on the other side of it, and how far it is on the way there.
function framesAbout(frames, where) {
  if (!where) return [frames[0], frames[0], 0];
  let near = 0;
  frames.forEach((one, i) => { if (Math.abs(one.value - where.value) < Math.abs(frames[near].value - where.value)) near = i; });
  const frame = frames[near], other = frames[near + (where.value < frame.value ? -1 : 1)];
  if (!other || other.value === frame.value) return [frame, frame, 0];
  return [frame, other, (where.value - frame.value) / (other.value - frame.value)];
}

// Which mode of a frame is shown: the one wished for, that of the branch followed, the one chosen, or the one that grows fastest.
function shownMode(frame, where, section) {
  const wish = where && where.wish;
  const wanted = section.shownMode || (section.branch !== undefined && section.wantedNow ? section.wantedNow() : null);
  if (!wish && !wanted) return Math.min(section.mode ?? frame.modes.reduce((best, one, i) => one.growth > frame.modes[best].growth ? i : best, 0), frame.modes.length - 1);
  const offs = frame.modes.map(one => wish ? offOf(wish, one)
    : Math.abs(one.frequency - wanted.frequency) / (wanted.frequency + 1) + 1e-3 * Math.abs(one.growth - wanted.growth) / (1 + Math.abs(wanted.growth)));
  return offs.indexOf(Math.min(...offs));
}

// A motion φ turned by the e^{iα} with which it is most like the one before, so that a slide shows no jumps.
function inPhaseWith(before, motion) {
  if (!before || before.length !== motion.length) return motion;
  const half = motion.length / 2;
  let re = 0, im = 0;
  for (let i = 0; i < half; ++i) {
    re += motion[i] * before[i] + motion[half + i] * before[half + i];
    im += motion[i] * before[half + i] - motion[half + i] * before[i];
  }
  const size = Math.hypot(re, im);
  if (!(size > 0)) return motion;
  const turned = new Float32Array(motion.length);
  for (let i = 0; i < half; ++i) {
    turned[i] = (motion[i] * re - motion[half + i] * im) / size;
    turned[half + i] = (motion[i] * im + motion[half + i] * re) / size;
  }
  return turned;
}

async function makeModes(place, view, section) {
  const parts = await partsOf(view);
  const where = section.place;
  place.append(partLegend(parts));
  const mesh = new MeshView(place, parts, view, 'Bodies displaced by the mode');
  const firsts = await Promise.all([view.frames[0], view.frames[view.frames.length - 1]].map(frame => numbersOf(frame.places)));
  mesh.fit(...firsts);
  const text = element('div', {class: 'readout'});
  const choice = element('select', {'aria-label': 'Mode', onchange: () => { section.mode = Number(choice.value); section.branch = section.shownMode = undefined; if (where) where.wish = null; show(); }});
  const vibration = new Motion(seconds => {
    mesh.phase += 4 * seconds * Number(speed.value);
    mesh.draw();
  }, mesh);
  const play = motionButton(vibration, ['Vibrate', 'Pause'], 'the mode, slowly');
  const size = element('input', {type: 'range', min: 0, max: 3, step: 0.05, value: 1, 'aria-label': 'Amplitude', oninput: () => { mesh.amplitude = Number(size.value); mesh.draw(); }});
  const speed = element('input', {type: 'range', min: 0.1, max: 3, step: 0.1, value: 1, 'aria-label': 'Speed'});
  place.append(element('div', {class: 'tools'}, element('label', {}, 'Mode', choice), play, element('label', {}, 'Amplitude', size), element('label', {}, 'Speed', speed)), text,
    element('figcaption', {}, `Displacements enlarged, as of Re(φ exp iθ)${mesh.isPlanar ? '; grey: at rest' : ''}. Modes about the ${view.about} geometry. `,
      mesh.help));
  mesh.play = () => (section.player ? section.player.motion : vibration).toggle();

  let latest = 0, framed = null, numbered = null;
  const show = async () => {
    const ticket = ++latest;
    const [frame, other, share] = framesAbout(view.frames, where);
    const number = shownMode(frame, where, section);
    if (frame !== framed)
      choice.replaceChildren(...frame.modes.map((one, i) => element('option', {value: i}, `${i + 1}: ${shown(one.frequency, 'Hz')}, ${digits(one.growth, 3)} 1/s`)));
    choice.value = String(number);
    const [places, motions, others] = await Promise.all([frame.places, frame.displacements, other.places].map(numbersOf));
    if (ticket !== latest) return;
    const between = other === frame ? places : places.map((x, i) => x + share * (others[i] - x));
    if (frame === framed && number === numbered) mesh.move(between);
    else {
      const length = 2 * places.length;
      mesh.show(between, inPhaseWith(mesh.motion, motions.subarray(number * length, (number + 1) * length)));
    }
    [framed, numbered] = [frame, number];
    const mode = frame.modes[number];
    text.textContent = `Mode ${number + 1}: ${shown(mode.frequency, 'Hz', 6)}, growth rate ${digits(mode.growth, 4)} 1/s` +
      (view.parameter ? `, computed at ${view.parameter} = ${shown(frame.value, view.units, 5)}` : '');
    place.dataset.mode = String(number + 1);
  };
  if (where) where.listeners.add(show);
  section.showMode = () => { place.scrollIntoView({block: 'nearest'}); show(); };
  await show();
  place.mesh = mesh;  // for those who test the page
}
