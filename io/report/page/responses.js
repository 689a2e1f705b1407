// Frequency responses: magnitude and phase over the frequency, and the curve in the complex plane.

// Limits of a logarithmic axis: all peaks, and troughs but the deepest hundredth, in at most six decades.
function magnitudeRange(magnitudes) {
  const sizes = magnitudes.flatMap(list => list.filter(value => isFinite(value) && value > 0)).sort((a, b) => a - b);
  if (!sizes.length) return [0.1, 10];
  const most = sizes[sizes.length - 1], usual = sizes[Math.floor(0.01 * (sizes.length - 1))];
  return [Math.max(0.7 * usual, 1e-6 * most), 1.4 * most];
}

// A line without chords: none across a jump, nor where the curve turns faster than its points lie.
function withoutChords(xs, ys, isChord) {
  const line = [[], []];
  for (let i = 0; i < xs.length; ++i) {
    if (i && isChord(i)) { line[0].push(NaN); line[1].push(NaN); }
    line[0].push(xs[i]);
    line[1].push(ys[i]);
  }
  return line;
}

async function readResponses(group) {
  for (const curve of group.curves) {
    const [real, imaginary] = await Promise.all([numbersOf(curve.real), numbersOf(curve.imaginary)]);
    const size = Array.from(real, (re, i) => Math.hypot(re, imaginary[i]));
    const angle = Array.from(real, (re, i) => Math.atan2(imaginary[i], re) * 180 / Math.PI);
    Object.assign(curve, {real, imaginary, size, angle});
    if (curve.error) curve.off = await numbersOf(curve.error);
  }
  // Between points farther apart than a tenth of the largest response a line would be a chord.
  group.most = group.curves.reduce((most, curve) => curve.size.reduce((a, b) => b > a ? b : a, most), 0);
  for (const curve of group.curves) {
    const step = i => Math.hypot(curve.real[i] - curve.real[i - 1], curve.imaginary[i] - curve.imaginary[i - 1]);
    curve.plane = withoutChords(curve.real, curve.imaginary, i => step(i) > 0.1 * group.most);
    curve.turned = (xs) => withoutChords(xs, curve.angle, i => Math.abs(curve.angle[i] - curve.angle[i - 1]) > 180);
    curve.isCoarse = curve.plane[0].length > curve.real.length;
  }
}

function makeResponseGroup(place, view, group, xs) {
  const isLogX = isGeometric(xs) && xs[xs.length - 1] / xs[0] > 20;
  const side = element('div', {class: 'side'}), left = element('figure'), right = element('figure');
  side.append(left, right);
  const legend = element('div', {class: 'legend'}, group.curves.map((curve, k) => {
    const box = element('i');
    box.style.background = lineColour(k);
    return element('span', {}, box, curve.name);
  }));
  place.append(element('h3', {}, group.quantity[0].toUpperCase() + group.quantity.slice(1)), legend, side);
  let nearest = null;
  const mark = (chart, px, py) => { if (nearest !== null) group.curves.forEach((curve, k) => chart.dot(px(curve), py(curve), lineColour(k), 4, colour('text'))); };
  const say = () => `${shown(xs[nearest], 'Hz', 6)}: ` + group.curves.map(curve =>
    `${group.curves.length > 1 ? curve.name + ' ' : ''}${shown(curve.size[nearest], group.units, 5)}, ${digits(curve.angle[nearest], 4)}°`).join('; ');
  const over = {
    hover: x => { nearest = nearestIndex(xs, x, isLogX); plane.draw(); return say(); },
    zoomed() { charts.forEach(other => { if (other !== this && other !== plane) { other.x.set(this.x.from, this.x.to); other.draw(); } }); },
  };
  const frequency = () => new Axis('frequency', 'Hz', ...(isLogX ? [xs[0], xs[xs.length - 1]] : rangeOf([xs])), isLogX);
  const magnitude = new Chart(left, {...over, x: frequency(), height: 250, name: `Magnitude of the ${group.quantity}`,
    y: new Axis('magnitude', group.units, ...magnitudeRange(group.curves.map(curve => curve.size)), true),
    paint: chart => {
      group.curves.forEach((curve, k) => chart.line(xs, curve.size, lineColour(k)));
      group.curves.forEach((curve, k) => {
        if (curve.off) chart.line(xs, curve.off, lineColour(k), 0.8, [4, 4]);
      });
      mark(chart, () => xs[nearest], curve => curve.size[nearest]);
    }});
  const phase = new Chart(left, {...over, x: frequency(), height: 170, name: `Phase of the ${group.quantity}`,
    y: Object.assign(new Axis('phase', '°', -190, 190), {every: 90}),
    paint: chart => {
      group.curves.forEach((curve, k) => chart.line(...curve.turned(xs), lineColour(k)));
      mark(chart, () => xs[nearest], curve => curve.angle[nearest]);
    }});
  const ranges = [rangeOf(group.curves.map(curve => curve.real)), rangeOf(group.curves.map(curve => curve.imaginary))];
  const plane = new Chart(right, {height: 445, isToScale: true, name: `Nyquist diagram of the ${group.quantity}`,
    x: Object.assign(new Axis('real part', group.units, ...ranges[0]), {size: group.most}),
    y: Object.assign(new Axis('imaginary part', group.units, ...ranges[1]), {size: group.most}),
    paint: chart => {
      group.curves.forEach((curve, k) => {
        chart.line(...curve.plane, lineColour(k));
        if (curve.isCoarse) for (let i = 0; i < xs.length; ++i) chart.dot(curve.real[i], curve.imaginary[i], lineColour(k), 1.6);
      });
      mark(chart, curve => curve.real[nearest], curve => curve.imaginary[nearest]);
    },
    hover: (x, y) => {
      let least = 900, found = null;
      for (const curve of group.curves) for (let i = 0; i < xs.length; ++i) {
        const off = (plane.px(curve.real[i]) - plane.px(x)) ** 2 + (plane.py(curve.imaginary[i]) - plane.py(y)) ** 2;
        if (off < least) { least = off; found = i; }
      }
      nearest = found ?? nearest;
      [magnitude, phase].forEach(chart => chart.draw());
      return found === null ? '' : say();
    }});
  const charts = [magnitude, phase, plane];
  charts.forEach(chart => chart.draw());
  if (group.curves.some(curve => curve.off))
    left.append(element(
        'figcaption', {},
        'Dashed: how far the response is off with the modes that a run keeps (time.retain).'));
  if (group.curves.some(curve => curve.isCoarse))
    right.append(element('figcaption', {}, 'Dots: the frequencies of the file. No line joins two between which the response turns far; more --points show the way.'));
  return {magnitude, phase, plane};
}

async function makeResponses(place, view) {
  const xs = await numbersOf(view.frequency);
  place.responses = [];  // for those who test the page
  for (const group of view.groups) {
    await readResponses(group);
    place.responses.push(makeResponseGroup(place, view, group, xs));
  }
}
