// Histories of a run, one above the other, with one stretch of time and one cursor.

// Times of samples: equally spaced, or listed.
async function clockOf(time) {
  if (!time.values) {
    const step = time.step || 1;
    return {
      first: time.from, last: time.from + step * (time.count - 1), count: time.count, step,
      at: index => time.from + step * index,
      index: moment => (moment - time.from) / step,
    };
  }
  const times = await numbersOf(time.values);
  const count = times.length;
  return {
    first: times[0], last: times[count - 1], count, step: (times[count - 1] - times[0]) / Math.max(1, count - 1),
    at: index => {
      const i = Math.max(0, Math.min(count - 2, Math.floor(index)));
      return times[i] + (index - i) * (times[i + 1] - times[i]);
    },
    index: moment => {
      let low = 0, high = count - 1;
      while (high - low > 1) { const m = (low + high) >> 1; if (times[m] <= moment) low = m; else high = m; }
      return low + (moment - times[low]) / Math.max(1e-300, times[high] - times[low]);
    },
  };
}

const cursors = uPlot.sync('time');

// The time that is marked, as a line over a diagram: it moves without a drawing.
function momentMark() { return element('div', {class: 'moment'}); }
function putMark(mark, view, width, left = 0) {
  const isShown = view.moment !== null && view.moment >= view.from && view.moment <= view.to;
  mark.style.display = isShown ? '' : 'none';
  if (isShown) mark.style.transform = `translateX(${left + width * (view.moment - view.from) / view.length - 1}px)`;
}

const historyHeight = 188;

function historyOptions(series, scale, view, width, hooks) {
  const axis = {stroke: () => colour('text'), grid: {stroke: () => colour('line'), width: 0.6},
    ticks: {stroke: () => colour('line'), width: 0.6}, font: '12px system-ui'};
  return {
    width, height: historyHeight,
    legend: {show: false},
    scales: {x: {time: false, auto: false, range: () => [view.from, view.to]}, y: {auto: true}},
    axes: [{...axis, size: 30, label: 'time (s)', labelSize: 16, labelFont: '12px system-ui', values: (u, ticks) => ticks.map(t => tickText(t, Math.abs(ticks[1] - ticks[0]) || 1))},
      {...axis, size: 58, label: scale[1] || ' ', labelSize: 18, labelFont: '12px system-ui',
        values: (u, ticks) => ticks.map(t => tickText(t, Math.abs(ticks[1] - ticks[0]) || 1))}],
    series: [{}, {stroke: () => lineColour(series.number), width: 1.1, points: {show: false}, spanGaps: false}],
    cursor: {sync: {key: cursors.key, setSeries: false}, drag: {x: true, y: false, setScale: false}, points: {show: false}},
    hooks,
  };
}

// One series: title, diagram, value under the cursor.
async function makeHistory(place, series, clock, view, bursts) {
  const samples = await numbersOf(series.samples);
  const pyramid = new Pyramid(samples, series.factor);
  const largest = Math.max(Math.abs(series.min ?? 0), Math.abs(series.max ?? 0));
  const scale = scaleFor(largest, series.units);
  const value = element('span', {class: 'faint'});
  const title = element('h3', {}, series.name, ' ', value);
  const note = [series.title, series.filter, series.factor > 1 ? `extremes of ${series.factor} samples` : null,
    series.not_finite ? `${series.not_finite} values are not finite` : null].filter(Boolean).join('; ');
  const body = element('div', {role: 'img', 'aria-label': `${series.name} over time, ${shown(series.min, series.units)} to ${shown(series.max, series.units)}`});
  place.append(title, body);
  if (note) place.append(element('div', {class: 'faint'}, note));

  const dataNow = width => {
    const begin = Math.max(0, Math.floor(clock.index(view.from)) - 1);
    const end = Math.min(clock.count, Math.ceil(clock.index(view.to)) + 2);
    const [indices, values] = pyramid.between(begin, end, Math.max(200, width));
    const xs = new Array(indices.length), ys = new Array(indices.length);
    for (let i = 0; i < indices.length; ++i) {
      xs[i] = clock.at(indices[i]);
      ys[i] = isNaN(values[i]) ? null : values[i] / scale[0];
    }
    return [xs, ys];
  };
  const mark = momentMark();
  let placeMark = () => {};
  const hooks = {
    drawClear: [u => {
      for (const burst of bursts) {
        const from = u.valToPos(Math.max(burst.start, view.from), 'x', true), to = u.valToPos(Math.min(burst.end, view.to), 'x', true);
        if (to <= from) continue;
        u.ctx.fillStyle = colour('burst');
        u.ctx.fillRect(from, u.bbox.top, to - from, u.bbox.height);
      }
    }],
    draw: [() => placeMark()],
    setSelect: [u => {
      if (u.select.width < 5) return;
      const from = u.posToVal(u.select.left, 'x'), to = u.posToVal(u.select.left + u.select.width, 'x');
      u.setSelect({left: 0, top: 0, width: 0, height: 0}, false);
      view.set(from, to);
    }],
    setCursor: [u => {
      if (u.cursor.left < 0 || u.cursor.left === undefined) { value.textContent = ''; return; }
      const moment = u.posToVal(u.cursor.left, 'x');
      const i = Math.round(clock.index(moment) / (series.factor > 1 ? series.factor : 1));
      const index = Math.max(0, Math.min(pyramid.count - 1, i));
      const now = series.factor > 1 ? samples[2 * index + 1] : samples[index];
      value.textContent = `${shown(now, series.units)} at ${shown(clock.at(index * series.factor), 's', 6)}`;
    }],
  };
  const width = () => Math.max(200, body.clientWidth || place.clientWidth || 700);
  const diagram = new uPlot(historyOptions(series, scale, view, width(), hooks), dataNow(width()), body);
  diagram.over.append(mark);
  placeMark = () => putMark(mark, view, diagram.over.clientWidth);
  placeMark();
  let pressed = 0;
  diagram.over.addEventListener('mousedown', event => { pressed = event.clientX; });
  diagram.over.addEventListener('click', event => {
    if (Math.abs(event.clientX - pressed) < 5) view.mark(diagram.posToVal(event.clientX - diagram.over.getBoundingClientRect().left, 'x'));
  });
  diagram.over.addEventListener('dblclick', () => view.reset());
  diagram.over.addEventListener('wheel', event => {
    if (!event.ctrlKey && !event.shiftKey) return;
    event.preventDefault();
    view.zoom(event.deltaY > 0 || event.deltaX > 0 ? 1.25 : 0.8, event.offsetX / diagram.over.clientWidth);
  }, {passive: false});
  const draw = () => diagram.setData(dataNow(width()), true);
  view.listeners.add(draw);
  view.momentListeners.add(placeMark);
  redrawn.add(() => { diagram.setSize({width: width(), height: historyHeight}); diagram.redraw(true); });
  body.dataset.peak = String(largest);
  body.diagram = diagram;  // for those who test the page
}

const stateColours = ['#8d99a6', '#c2410c', '#2e7d32', '#7b1fa2'];

// Which state a contact is in, as a strip of colours.
async function makeStates(place, series, clock, view) {
  const samples = await numbersOf(series.samples);
  const legend = element('div', {class: 'legend'}, Object.entries(series.states).map(([number, name]) => {
    const box = element('i');
    box.style.background = stateColours[number % stateColours.length];
    return element('span', {}, box, name);
  }));
  const canvas = element('canvas', {role: 'img', 'aria-label': `${series.name}: states over time`});
  const mark = momentMark();
  place.append(element('h3', {}, series.name), legend, element('div', {class: 'layers'}, canvas, mark));
  let placeMark = () => {};
  const draw = () => {
    const [c, width] = sharp(canvas, 22);
    const left = 76, right = width - 25;
    placeMark = () => putMark(mark, view, right - left, left);
    placeMark();
    const begin = clock.index(view.from), end = clock.index(view.to);
    let run = null;
    for (let x = left; x < right; ++x) {
      const from = Math.max(0, Math.floor(begin + (end - begin) * (x - left) / (right - left)));
      const to = Math.max(from + 1, Math.floor(begin + (end - begin) * (x + 1 - left) / (right - left)));
      // The rarest state of what falls into a pixel is what one looks for: an opening, a stick.
      const seen = [0, 0, 0, 0];
      const stride = Math.max(1, Math.floor((to - from) / 64));
      for (let i = from; i < Math.min(to, samples.length); i += stride) ++seen[samples[i] & 3];
      let state = -1;
      for (let s = 0; s < 4; ++s) if (seen[s] > 0 && (state < 0 || seen[s] < seen[state])) state = s;
      if (run && run.state === state) continue;
      if (run && run.state >= 0) { c.fillStyle = stateColours[run.state]; c.fillRect(run.x, 2, x - run.x, 18); }
      run = {state, x};
    }
    if (run && run.state >= 0) { c.fillStyle = stateColours[run.state]; c.fillRect(run.x, 2, right - run.x, 18); }
  };
  view.listeners.add(draw);
  view.momentListeners.add(() => placeMark());
  redrawn.add(draw);
  draw();
}

async function makeHistories(place, view, run) {
  const clock = await clockOf(view.time);
  run.clock = clock;
  if (view.note) place.append(element('p', {class: 'faint'}, view.note));
  view.series.forEach((series, number) => {
    series.number = number;
    const one = element('figure');
    one.style.minHeight = '180px';
    place.append(one);
    whenSeen(one, async () => {
      if (series.states) await makeStates(one, series, clock, run.view);
      else await makeHistory(one, series, clock, run.view, run.bursts);
      one.style.minHeight = '';
    });
  });
  if (view.left_out.length) {
    place.append(element('details', {}, element('summary', {}, `${view.left_out.length} series are not here`),
      element('p', {class: 'faint'}, view.left_out.join(', '), '. Choose others with stridor report --channel NAME.')));
  }
}
