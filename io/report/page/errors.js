// Errors against run times: a line for each method, and every setting as a row.

const normNames = {force: 'of the contact force', acceleration: 'of the acceleration', envelope: 'of the envelope of the acceleration',
  displacement: 'of the displacement'};

function makeErrors(place, view) {
  const useful = view.settings.filter(row => row.error > 0 && row.run_time > 0);
  const methods = [...new Set(useful.map(row => row.method))];
  if (useful.length) drawErrors(place, view, useful, methods);
  place.append(element('details', {open: view.settings.length <= 12 || !useful.length}, element('summary', {}, 'Every setting'), unitTable([
    {name: 'Method', of: row => row.method, text: true}, {name: 'Step', units: 's', of: row => row.tolerance === null ? row.step : ''},
    {name: 'Tolerance', digits: 2, of: row => row.tolerance ?? ''}, {name: 'Modes', digits: 6, of: row => row.modes},
    {name: 'Run time', units: 's', of: row => row.error === null ? '' : row.run_time},
    {name: 'Error', digits: 3, of: row => row.error ?? row.status, mark: row => row.on_front ? ' *' : ''}], view.settings),
    element('p', {class: 'faint'}, '* No other setting has both less time and a smaller error.')));
  if (!view.reductions.length) return;
  place.append(element('h3', {}, 'Reduced bodies against full ones'), unitTable([{name: 'Body', of: row => row.body, text: true},
    {name: 'Frequency', units: 'Hz', of: row => row.frequency}, {name: 'Error', digits: 3, of: row => row.error}], view.reductions));
}

function drawErrors(place, view, useful, methods) {
  const levels = [view.reference_error, view.wanted_error].filter(level => level > 0);
  const figure = element('figure');
  place.append(element('h3', {}, 'Error against run time'), figure);
  figure.append(element('div', {class: 'legend'}, methods.map((method, k) => {
    const box = element('i');
    box.style.background = lineColour(k);
    return element('span', {}, box, method);
  })));
  const chart = new Chart(figure, {
    x: new Axis('run time', 's', ...rangeOf([useful.map(row => row.run_time)], true), true),
    y: new Axis('relative error', '1', ...rangeOf([useful.map(row => row.error), levels], true), true), height: 340,
    name: 'Relative error of each setting over the time that it takes',
    paint: chart => {
      const c = chart.context;
      c.setLineDash([5, 4]);
      for (const level of levels) chart.line([chart.x.from, chart.x.to], [level, level], colour('faint'));
      c.setLineDash([]);
      methods.forEach((method, k) => {
        const rows = useful.filter(row => row.method === method);
        chart.line(rows.map(row => row.run_time), rows.map(row => row.error), lineColour(k));
        for (const row of rows) chart.dot(row.run_time, row.error, lineColour(k), row.on_front ? 5 : 3, row.on_front ? colour('text') : undefined);
      });
    },
    hover: (x, y) => {
      const far = row => Math.hypot(chart.px(row.run_time) - chart.px(x), chart.py(row.error) - chart.py(y));
      const row = useful.reduce((a, b) => far(b) < far(a) ? b : a);
      if (far(row) > 30) return '';
      const setting = row.tolerance === null ? `step ${shown(row.step, 's', 4)}, ${digits(row.modes, 6)} modes` : `tolerance ${digits(row.tolerance, 2)}`;
      return `${row.method}, ${setting}: ${shown(row.run_time, 's', 4)}, error ${digits(row.error, 3)}`;
    },
  });
  place.errors = chart;  // for those who test the page
  figure.append(element('figcaption', {}, `Relative error ${normNames[view.norm] || ''}${view.channel ? ` (${view.channel})` : ''}. Large dots: no other setting has both less time and a smaller error. `,
    view.reference_error > 0 ? `Dashed: error of the reference${view.wanted_error > 0 ? ', and the error asked for' : ''}.` : ''));
  chart.draw();
}
