// Curves over a common axis, a panel for each quantity, and as a table.

function tableOf(columns, most = 400) {
  const count = columns[0].numbers.length;
  const rows = [];
  for (let i = 0; i < Math.min(count, most); ++i)
    rows.push(element('tr', {}, columns.map(column => element('td', {}, digits(column.numbers[i], 6)))));
  return element('div', {class: 'scroll'}, element('table', {},
    element('thead', {}, element('tr', {}, columns.map(column =>
      element('th', {}, column.name + (prettyUnits(column.units) ? ` (${prettyUnits(column.units)})` : ''))))),
    element('tbody', {}, rows)), count > most ? element('p', {class: 'faint'}, `${count - most} more rows are in the file.`) : null);
}

async function makeCurves(place, view) {
  const xs = await numbersOf(view.x.values);
  const isLogX = view.x_log || (isGeometric(xs) && xs[xs.length - 1] / xs[0] > 20);
  if (view.title) place.append(element('h3', {}, view.title));
  const columns = [{...view.x, numbers: xs}];
  const charts = [];
  for (const panel of view.panels) {
    for (const curve of panel.curves) curve.numbers = await numbersOf(curve.values);
    // What does not vary tells nothing as a curve; it stands in the table.
    const varies = numbers => numbers.some(value => isFinite(value) && value !== numbers.find(isFinite));
    const shownCurves = panel.curves.filter(curve => curve.numbers.some(isFinite) && (!view.table || varies(curve.numbers)));
    columns.push(...panel.curves);
    if (!shownCurves.length) continue;
    const all = shownCurves.map(curve => curve.numbers);
    const units = shownCurves.every(curve => curve.units === shownCurves[0].units) ? shownCurves[0].units : '1';
    const label = panel.title || (shownCurves.length === 1 ? shownCurves[0].name.replace(/_/g, ' ') : '');
    const figure = element('figure');
    place.append(figure);
    if (shownCurves.length > 1 || panel.title) {
      figure.append(element('div', {class: 'legend'}, shownCurves.map((curve, k) => {
        const box = element('i');
        box.style.background = lineColour(k);
        return element('span', {}, box, curve.name);
      })));
    }
    const chart = new Chart(figure, {
      x: new Axis(view.x.name.replace(/_/g, ' '), view.x.units, ...rangeOf([xs], isLogX), isLogX),
      y: new Axis(label, units, ...rangeOf(all, panel.log), panel.log), height: 230, name: label,
      paint: chart => shownCurves.forEach((curve, k) => {
        if (!view.points) chart.line(xs, curve.numbers, lineColour(k));
        if (view.points || xs.length < 80)
          for (let i = 0; i < xs.length; ++i) if (isFinite(curve.numbers[i])) chart.dot(xs[i], curve.numbers[i], lineColour(k), 2.5);
        if (chart.nearest !== undefined && isFinite(curve.numbers[chart.nearest]))
          chart.dot(xs[chart.nearest], curve.numbers[chart.nearest], lineColour(k), 4, colour('text'));
      }),
      hover: x => {
        const i = nearestIndex(xs, x, isLogX);
        chart.nearest = i;
        return `${view.x.name} = ${shown(xs[i], view.x.units, 6)}: ` +
          shownCurves.map(curve => `${curve.name} ${shown(curve.numbers[i], curve.units, 5)}`).join('; ');
      },
      zoomed: () => charts.forEach(other => { if (other !== chart) { other.x.set(chart.x.from, chart.x.to); other.draw(); } }),
    });
    charts.push(chart);
    chart.draw();
  }
  if (view.table) place.append(element('details', {}, element('summary', {}, 'As a table'), tableOf(columns)));
}
