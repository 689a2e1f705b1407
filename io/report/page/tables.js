// What is said in words and numbers: verdicts, bursts, windows, results, where all comes from.

function rowThat(act, cells) {
  return element('tr', {tabindex: '0', role: 'button', onclick: act,
    onkeydown: event => { if (event.key === 'Enter' || event.key === ' ') { event.preventDefault(); act(); } }}, cells);
}

function cell(text, isText = false) { return element('td', isText ? {class: 'text'} : {}, text); }

function headRow(names) {
  return element('thead', {}, element('tr', {}, names.map(name => element('th', {scope: 'col'}, name))));
}

const verdictSigns = {calm: ['✓', 'Calm.'], loud: ['!', 'Loud.'], failed: ['✗', 'Failed.'], told: ['·', '']};

function makeVerdict(verdict) {
  const [sign, word] = verdictSigns[verdict.level] || verdictSigns.told;
  return element('p', {class: `verdict ${verdict.level}`}, element('b', {}, `${sign} ${word}`), verdict.text);
}

// The window to which a burst belongs.
function windowOf(view, burst) { return view.predicted.find(row => row.burst === burst.number); }

function explanation(view, burst) {
  const window = windowOf(view, burst);
  return window ? `window of ${shown(window.frequency, 'Hz', 5)} from ${shown(window.from, 's')}` : 'no window';
}

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
    place.append(element('h3', {}, 'Bursts of vibration'), element('div', {class: 'scroll'}, element('table', {},
      headRow(['Burst', 'From', 'To', 'Frequency', 'Peak', 'Gain (ln)', ...(view.predicted.length ? ['Explained by'] : [])]),
      element('tbody', {}, view.bursts.map(burst => rowThat(act(burst.start, burst.end, windowOf(view, burst) || {frequency: burst.frequency}),
        [cell(burst.number), cell(shown(burst.start, 's')), cell(shown(burst.end, 's')), cell(shown(burst.frequency, 'Hz', 5) + harmonicOf(burst) + (isDoubtful(burst, view.resolved) ? ' ?' : '')), cell(shown(burst.peak, 'm/s^2')), cell(digits(burst.gain, 3)), ...(view.predicted.length ? [cell(explanation(view, burst))] : [])]))))));
  }
  if (view.predicted.length) {
    place.append(element('h3', {}, 'Unstable windows that the run passes'), element('div', {class: 'scroll'}, element('table', {},
      headRow(['From', 'To', 'Frequency', 'Fastest growth', 'Gain', 'Burst', 'its frequency', 'its gain']),
      element('tbody', {}, view.predicted.map(row => rowThat(act(row.from, row.to, row),
        [cell(shown(row.from, 's')), cell(shown(row.to, 's')), cell(shown(row.frequency, 'Hz', 5)), cell(digits(row.growth_max, 3) + ' 1/s'), cell(digits(row.gain, 3)),
          cell(row.burst ?? 'not heard'), cell(row.burst === null ? '' : shown(row.burst_frequency, 'Hz', 5)), cell(row.burst === null ? '' : digits(row.burst_gain, 3))]))))));
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
  place.append(element('h3', {}, 'Unstable windows'), element('div', {class: 'scroll'}, element('table', {},
    headRow(['From', 'To', 'Frequency', 'Fastest growth', ...(hasTimes ? ['Gain', 'Passed'] : [])]),
    element('tbody', {}, view.windows.map(window => rowThat(() => section.place && section.place.follow(window.value_max, window.frequency),
      [cell(shown(window.from, view.units, 6)), cell(shown(window.to, view.units, 6)), cell(shown(window.frequency, 'Hz', 6)), cell(digits(window.growth_max, 4) + ' 1/s'),
        ...(hasTimes ? [cell(digits(window.gain, 3)), cell(window.from_time === null ? 'not passed' : `${shown(window.from_time, 's')} to ${shown(window.to_time, 's')}`)] : [])]))))),
  element('p', {class: 'faint'}, `Of ${view.parameter}; a click moves the position to the fastest growth.`));
}

function makeResults(results) {
  const rows = Object.entries(results).map(([name, value]) => element('tr', {}, cell(name, true), cell(typeof value === 'number' ? digits(value, 6) : String(value ?? '–'))));
  return element('details', {open: rows.length < 12}, element('summary', {}, 'Checks and results of the run'), element('div', {class: 'scroll'}, element('table', {}, element('tbody', {}, rows))));
}

function makeExpectations(rows) {
  const met = rows.filter(row => row.is_met).length;
  return element('details', {open: met < rows.length}, element('summary', {}, `${met} of ${rows.length} expectations of the scene are met`),
    element('div', {class: 'scroll'}, element('table', {}, headRow(['Result', 'Expected', 'Within', 'Got', '']),
      element('tbody', {}, rows.map(row => element('tr', {}, cell(row.result, true), cell(digits(row.expected, 6)), cell(digits(row.tolerance, 3)),
        cell(digits(row.value, 6)), cell(row.is_met ? '✓' : '✗ not met')))))));
}

function makeSource(section) {
  const lines = [['Command', section.command], ['Made', section.date], ['By', section.version ? `stridor ${section.version} (${section.commit})` : null],
    ['Scene', section.scene], ['Scene hash', section.scene_hash], ['About', section.about ? `the ${section.about} geometry` : null], ['Method', section.method]];
  const place = element('details', {}, element('summary', {}, 'How to repeat this'), element('table', {}, element('tbody', {}, lines.filter(([, value]) => value)
    .map(([name, value]) => element('tr', {}, cell(name, true), element('td', {class: 'text'}, element('code', {}, value)))))));
  if (section.scene_text) place.append(element('h3', {}, 'The scene as written'), element('pre', {tabindex: '0'}, section.scene_text));
  if (section.scene_resolved) place.append(element('h3', {}, 'The scene with all defaults and settings'), element('pre', {tabindex: '0'}, section.scene_resolved));
  return place;
}
