// What is said in words and numbers: verdicts, bursts, windows, results, where all comes from.

function rowThat(act, cells) {
  return element('tr', {tabindex: '0', role: 'button', onclick: act,
    onkeydown: event => { if (event.key === 'Enter' || event.key === ' ') { event.preventDefault(); act(); } }}, cells);
}

function cell(text, isText = false) { return element('td', isText ? {class: 'text'} : {}, text); }

function headRow(names) {
  return element('thead', {}, element('tr', {}, names.map(name => element('th', {scope: 'col'}, name))));
}

// A table with one unit for each column, that of its largest number; it scrolls inside itself.
// columns: [{name, units, of(row): a number, words or null, digits, text, as, mark(row)}]; columns of the same
// `as` share their unit. act(row): what a click does
function unitTable(columns, rows, act = null) {
  const values = columns.map(column => rows.map(column.of));
  const largest = k => values[k].reduce((most, value) => typeof value === 'number' && isFinite(value) ? Math.max(most, Math.abs(value)) : most, 0);
  const scales = columns.map((column, k) => scaleFor(Math.max(...columns.map((other, j) =>
    j === k || (column.as && other.as === column.as) ? largest(j) : 0)), column.units));
  const text = (value, k, row) => typeof value !== 'number' ? String(value ?? '–')
    : digits(value / scales[k][0], columns[k].digits || 4) + (columns[k].mark ? columns[k].mark(row) : '');
  return element('div', {class: 'scroll'}, element('table', {},
    element('thead', {}, element('tr', {}, columns.map((column, k) => element('th', column.text ? {scope: 'col', class: 'text'} : {scope: 'col'},
      column.name + (scales[k][1] ? ` (${scales[k][1]})` : ''))))),
    element('tbody', {}, rows.map((row, i) => {
      const cells = columns.map((column, k) => cell(text(values[k][i], k, row), column.text));
      return act ? rowThat(act(row), cells) : element('tr', {}, cells);
    }))));
}

// Of a row of numbers and words for each entry; a click on one shows the mode of its frequency.
function makeTable(place, view, section) {
  const indices = Array.from({length: (view.columns[0].texts || view.columns[0].values).length}, (_, i) => i);
  const columns = view.columns.map(column => ({name: column.name, units: column.units, digits: column.digits, text: !!column.texts,
    of: column.texts ? i => column.texts[i] : i => column.values[i]}));
  const column = name => view.columns.find(one => one.name === name);
  const act = view.follows ? i => () => {
    section.shownMode = {frequency: column('Frequency').values[i], growth: column('Growth rate').values[i]};
    if (section.showMode) section.showMode();
  } : null;
  place.append(element('h3', {}, view.title), unitTable(view.follows ? [{name: 'Number', of: i => i + 1}, ...columns] : columns, indices, act));
  if (view.follows && viewOf(section, 'modes')) place.append(element('p', {class: 'faint'}, 'A click on a row shows its mode below.'));
}

const verdictSigns = {calm: ['✓', 'Calm.'], loud: ['!', 'Loud.'], stable: ['✓', 'Stable.'], unstable: ['!', 'Unstable.'],
  failed: ['✗', 'Failed.'], told: ['·', '']};

function makeVerdict(verdict) {
  const [sign, word] = verdictSigns[verdict.level] || verdictSigns.told;
  return element('p', {class: `verdict ${verdict.level}`}, element('b', {}, `${sign} ${word}`), verdict.text);
}

// The window to which a burst belongs.
function windowOf(view, burst) { return view.predicted.find(row => row.burst === burst.number); }

// Above what the reduced bodies resolve.
// "", or that a burst is a harmonic of another.
function harmonicOf(burst) { return burst.harmonic ? `, ${burst.harmonic.order} times that of burst ${burst.harmonic.of}` : ''; }
// The frequency of a burst at a moment, by its course.
function frequencyAt(burst, moment) {
  const {times, frequencies} = burst.course;
  const i = times.findIndex(time => time >= moment);
  if (!times.length) return burst.frequency;
  return i < 0 ? frequencies[times.length - 1] : frequencies[i];
}
function isDoubtful(burst, resolved) { return resolved > 0 && burst.frequency > resolved; }

function makeBursts(place, view, run, section) {
  // Shows a stretch of time and, where it is known, the motion that grows then.
  const act = (from, to, window) => () => {
    run.view.show(from, to);
    const moment = 0.5 * (from + to);
    run.view.mark(moment);
    for (const place of run.places) {
      const value = window && window.value_max !== undefined ? window.value_max : place.valueAt(moment);
      if (value !== null && window) place.follow(value, window.frequency);
      else if (value !== null) place.set(value);
    }
  };
  if (view.bursts.length) {
    place.append(element('h3', {}, 'Bursts of vibration'), unitTable([
      {name: 'Burst', of: burst => burst.number}, {name: 'From', units: 's', as: 'time', of: burst => burst.start},
      {name: 'To', units: 's', as: 'time', of: burst => burst.end},
      {name: 'Frequency', units: 'Hz', digits: 5, of: burst => burst.frequency, mark: burst => harmonicOf(burst) + (isDoubtful(burst, view.resolved) ? ' ?' : '')},
      {name: 'Peak', units: 'm/s^2', of: burst => burst.peak}, {name: 'Gain (ln)', digits: 3, of: burst => burst.gain},
      ...(view.predicted.length ? [{name: 'Explained by', of: burst => windowOf(view, burst) ? 'a window' : 'no window', text: true},
        {name: 'which is of', units: 'Hz', digits: 5, of: burst => windowOf(view, burst)?.frequency},
        {name: 'and begins', units: 's', as: 'time', of: burst => windowOf(view, burst)?.from}] : [])],
    view.bursts, burst => act(burst.start, burst.end, windowOf(view, burst) || {frequency: burst.frequency})));
  }
  if (view.predicted.length) {
    place.append(element('h3', {}, 'Unstable windows that the run passes'), unitTable([
      {name: 'From', units: 's', as: 'time', of: row => row.from}, {name: 'To', units: 's', as: 'time', of: row => row.to},
      {name: 'Frequency', units: 'Hz', as: 'frequency', digits: 5, of: row => row.frequency}, {name: 'Fastest growth', units: '1/s', digits: 3, of: row => row.growth_max},
      {name: 'Gain', digits: 3, of: row => row.gain}, {name: 'Burst', of: row => row.burst ?? 'not heard'},
      {name: 'its frequency', units: 'Hz', as: 'frequency', digits: 5, of: row => row.burst === null ? '' : row.burst_frequency},
      {name: 'its gain', digits: 3, of: row => row.burst === null ? '' : row.burst_gain}], view.predicted, row => act(row.from, row.to, row)));
  }
  const doubtful = view.bursts.filter(burst => isDoubtful(burst, view.resolved)).length;
  if (doubtful)
    place.append(element('p', {class: 'faint'}, `? ${doubtful === 1 ? 'One burst lies' : doubtful + ' bursts lie'} above ${shown(view.resolved, 'Hz', 4)}, more than the bodies resolve: keep more modes in their reductions to be sure of ${doubtful === 1 ? 'it' : 'them'}.`));
  if (view.bursts.length || view.predicted.length)
    place.append(element('p', {class: 'faint'}, 'A click on a row shows that time in all views. The gain is the logarithm of how many times the vibration has grown.'));
}

function makeWindows(place, view, section) {
  if (!view.windows.length) return;
  const hasTimes = view.windows.some(window => window.from_time !== null);
  place.append(element('h3', {}, 'Unstable windows'), unitTable([
    {name: 'From', units: view.units, as: 'value', digits: 6, of: window => window.from}, {name: 'To', units: view.units, as: 'value', digits: 6, of: window => window.to},
    {name: 'Frequency', units: 'Hz', digits: 6, of: window => window.frequency}, {name: 'Fastest growth', units: '1/s', of: window => window.growth_max},
    ...(hasTimes ? [{name: 'Gain', digits: 3, of: window => window.gain},
      {name: 'Passed from', units: 's', as: 'time', of: window => window.from_time ?? 'not passed'},
      {name: 'to', units: 's', as: 'time', of: window => window.to_time ?? ''}] : [])],
  view.windows, window => () => section.place && section.place.follow(window.value_max, window.frequency)),
  element('p', {class: 'faint'}, `Of ${view.parameter}; a click moves the position to the fastest growth.`));
}

function makeResults(results) {
  const rows = Object.entries(results).map(([name, value]) => element('tr', {}, cell(name, true), cell(typeof value === 'number' ? digits(value, 6) : String(value ?? '–'))));
  return element('details', {open: rows.length < 12}, element('summary', {}, 'Checks and results of the run, in SI units'), element('div', {class: 'scroll'}, element('table', {}, element('tbody', {}, rows))));
}

function makeExpectations(rows) {
  const met = rows.filter(row => row.is_met).length;
  return element('details', {open: met < rows.length}, element('summary', {}, `${met} of ${rows.length} expectations of the scene are met (in SI units)`),
    element('div', {class: 'scroll'}, element('table', {}, headRow(['Result', 'Expected', 'Within', 'Got', '']),
      element('tbody', {}, rows.map(row => element('tr', {}, cell(row.result, true), cell(digits(row.expected, 6)), cell(digits(row.tolerance, 3)),
        cell(digits(row.value, 6)), cell(row.is_met ? '✓' : '✗ not met')))))));
}

function makeSource(section) {
  const lines = [['File', section.file], ['Command', section.command], ['Made', section.date], ['By', section.version ? `stridor ${section.version} (${section.commit})` : null],
    ['Scene', section.scene], ['Scene hash', section.scene_hash], ['About', section.about ? `the ${section.about} geometry` : null], ['Method', section.method]];
  const place = element('details', {}, element('summary', {}, 'How to repeat this'), element('div', {class: 'scroll'}, element('table', {}, element('tbody', {}, lines.filter(([, value]) => value)
    .map(([name, value]) => element('tr', {}, cell(name, true), element('td', {class: 'text'}, element('code', {}, value))))))));
  if (section.scene_text) place.append(element('h3', {}, 'The scene as written'), element('pre', {tabindex: '0'}, section.scene_text));
  if (section.scene_resolved) place.append(element('h3', {}, 'The scene with all defaults and settings'), element('pre', {tabindex: '0'}, section.scene_resolved));
  return place;
}
