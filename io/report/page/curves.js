// Curves over a common axis, a panel for each quantity, and as tables.

// Columns of numbers, each in one unit, or of words.
function tableOf(columns, most = 400) {
  const count = columns[0].numbers.length;
  const rows = Array.from({length: Math.min(count, most)}, (_, i) => i);
  return [unitTable(columns.map(column => ({name: column.name.replace(/_/g, ' '), units: column.units, digits: 6,
    of: i => column.texts ? column.texts[i] : column.numbers[i], text: !!column.texts})), rows),
    count > most ? element('p', {class: 'faint'}, `${count - most} more rows are in the file.`) : ''];
}

// Sets of values that were passed one after the other: the way there in full, the way back dashed.
const setDashes = [[], [6, 4]];
function setColour(view, number, k) { return lineColour(view.sets.length > 1 ? number : k); }

function curvesLegend(view, curves, hasTitle) {
  const entries = [];
  const add = (text, stroke) => {
    const box = element('i');
    if (stroke) box.style.background = stroke;
    entries.push(element('span', {}, stroke ? box : null, text));
  };
  if (view.sets.length > 1) {
    for (const number of new Set(curves.map(curve => curve.set || 0)))
      add(`${view.sets[number].name}${setDashes[number % 2].length ? ', dashed' : ''}`, setColour(view, number, 0));
  } else if (curves.length > 1 || hasTitle) curves.forEach((curve, k) => add(curve.name, lineColour(k)));
  if (view.sets.some(set => set.failed && set.failed.length)) add('× failed', null);
  return entries.length ? element('div', {class: 'legend'}, entries) : '';
}

// In which direction a curve was passed: an arrow at its middle.
function arrowAlong(chart, xs, ys, fill) {
  const seen = [];
  for (let i = 0; i < xs.length; ++i) {
    const at = [chart.px(xs[i]), chart.py(ys[i])];
    if (at.every(isFinite)) seen.push(at);
  }
  const i = seen.length >> 1;
  if (i < 1) return;
  const [a, b] = [seen[i - 1], seen[i]], turn = Math.atan2(b[1] - a[1], b[0] - a[0]);
  const c = chart.context;
  c.save();
  c.translate(0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]));
  c.rotate(turn);
  c.fillStyle = fill;
  c.beginPath();
  c.moveTo(8, 0); c.lineTo(-5, -5); c.lineTo(-5, 5);
  c.fill();
  c.restore();
}

function paintCurves(chart, view, curves) {
  const c = chart.context, f = chart.inner;
  curves.forEach((curve, k) => {
    const number = curve.set || 0, xs = view.sets[number].numbers, stroke = setColour(view, number, k);
    const isBack = setDashes[number % 2].length > 0;
    if (!view.points) {
      c.setLineDash(setDashes[number % 2]);
      chart.line(xs, curve.numbers, stroke);
      c.setLineDash([]);
      if (view.sets.length > 1) arrowAlong(chart, xs, curve.numbers, stroke);
    }
    if (view.points || xs.length < 80)
      for (let i = 0; i < xs.length; ++i) if (isFinite(curve.numbers[i])) chart.dot(xs[i], curve.numbers[i], isBack ? colour('ground') : stroke, 2.5, isBack ? stroke : null);
    const near = chart.nearest && chart.nearest[number];
    if (near !== undefined && near !== null && isFinite(curve.numbers[near])) chart.dot(xs[near], curve.numbers[near], stroke, 4, colour('text'));
  });
  c.fillStyle = colour('failed');
  c.textAlign = 'center';
  c.textBaseline = 'bottom';
  c.font = 'bold 15px system-ui, sans-serif';
  for (const set of view.sets) for (const {index} of set.failed || []) c.fillText('×', chart.px(set.numbers[index]), f.y + f.height);
  c.font = '12px system-ui, "DejaVu Sans", sans-serif';
}

// What is said of a value of the axis: of every set that has it.
function sayCurves(view, curves, nearest) {
  return view.sets.map((set, number) => {
    const i = nearest[number];
    if (i === null) return '';
    const failure = (set.failed || []).find(one => one.index === i);
    const said = failure ? [`failed: ${failure.reason}`]
      : [...curves.filter(curve => (curve.set || 0) === number).map(curve => `${curve.name.replace(/_/g, ' ')} ${shown(curve.numbers[i], curve.units, 5)}`),
        ...(set.states || []).map(state => state.texts[i])];
    return said.length ? `${set.name ? set.name + ', ' : ''}${view.x.name} = ${shown(set.numbers[i], view.x.units, 6)}: ${said.filter(Boolean).join('; ')}` : '';
  }).filter(Boolean).join(' – ');
}

function makeCurvesPanel(place, view, panel, charts, run) {
  // What does not vary tells nothing as a curve; it stands in the table.
  const varies = numbers => numbers.some(value => isFinite(value) && value !== numbers.find(isFinite));
  const curves = panel.curves.filter(curve => curve.numbers.some(isFinite));
  if (!curves.length || (view.table && !curves.some(curve => varies(curve.numbers)))) return;
  const label = panel.title || curves[0].name.replace(/_/g, ' ');
  const figure = element('figure');
  place.append(figure);
  figure.append(curvesLegend(view, curves, !!panel.title));
  const chart = new Chart(figure, {
    x: new Axis(view.x.name.replace(/_/g, ' '), view.x.units, ...rangeOf(view.sets.map(set => set.numbers), view.isLogX), view.isLogX),
    y: new Axis(label, curves[0].units, ...rangeOf(curves.map(curve => curve.numbers), panel.log), panel.log), height: 230, name: label,
    paint: chart => paintCurves(chart, view, curves),
    hover: x => {
      chart.nearest = view.sets.map(set => set.numbers.length ? nearestIndex(set.numbers, x, view.isLogX) : null);
      return sayCurves(view, curves, chart.nearest);
    },
    zoomed: () => charts.forEach(other => { if (other !== chart) { other.x.set(chart.x.from, chart.x.to); other.draw(); } }),
  });
  charts.push(chart);
  if (run) run.timed.then(() => followTime(chart, view.sets[0].numbers, curves[0].numbers, run));
  chart.draw();
}

// A dot on a curve that was passed in time, a point for each row of the histories.
function followTime(chart, xs, ys, run) {
  chart.marks = () => {
    if (run.view.moment === null) return;
    const place = Math.min(xs.length - 1, Math.max(0, run.clock.index(run.view.moment))), i = Math.min(xs.length - 2, Math.floor(place));
    const at = list => list[i] + (place - i) * (list[i + 1] - list[i]);
    chart.dot(at(xs), at(ys), colour('mark'), 6, colour('ground'));
  };
  chart.play = () => run.player && run.player.motion.toggle();
  run.view.momentListeners.add(() => chart.mark());
}

async function makeCurves(place, view, section) {
  for (const set of view.sets) set.numbers = await numbersOf(set.values);
  for (const panel of view.panels) for (const curve of panel.curves) curve.numbers = await numbersOf(curve.values);
  const first = view.sets[0].numbers;
  view.isLogX = view.x_log || (isGeometric(first) && first[first.length - 1] / first[0] > 20);
  if (view.title) place.append(element('h3', {}, view.title));
  const charts = [];
  for (const panel of view.panels) makeCurvesPanel(place, view, panel, charts, view.over_time ? section.run : null);
  place.curves = charts;  // for those who test the page
  if (!view.table) return;
  view.sets.forEach((set, number) => {
    const columns = [{...view.x, numbers: set.numbers},
      ...view.panels.flatMap(panel => panel.curves).filter(curve => (curve.set || 0) === number),
      ...(set.states || []).map(state => ({...state, numbers: set.numbers}))];
    if (set.failed && set.failed.length) {
      const reasons = new Map(set.failed.map(one => [one.index, one.reason]));
      columns.push({name: 'failed', numbers: set.numbers, texts: Array.from(set.numbers, (_, i) => reasons.get(i) || '')});
    }
    place.append(element('details', {}, element('summary', {}, set.name ? `As a table, ${set.name}` : 'As a table'), tableOf(columns)));
  });
}
