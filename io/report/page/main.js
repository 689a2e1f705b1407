// The page as a whole.

function viewOf(section, type) { return section.views.find(view => view.type === type); }

// What is shared by the views of each section: the stretch of time of a run, the value of a key.
function prepare(sections) {
  for (const section of sections) {
    const histories = viewOf(section, 'histories'), picture = viewOf(section, 'spectrogram'), bursts = viewOf(section, 'bursts');
    if (histories || picture) {
      const time = histories && !histories.time.values ? histories.time : picture ? picture.time : null;
      const view = time ? new TimeView(time.from, time.from + (time.step || 1) * Math.max(1, time.count - 1)) : null;
      section.run = {view: null, clock: null, player: null, bursts: bursts ? bursts.bursts : [],
        resolved: bursts ? bursts.resolved : null, predicted: bursts ? bursts.predicted : [], places: []};
      // Times that are listed are known when they are unpacked.
      section.run.timed = new Promise(resolve => { section.run.isTimed = resolve; });
      if (view) { section.run.view = view; section.run.player = timePlayer(view); }
    }
    const modes = viewOf(section, 'modes');
    if (modes && modes.parameter && modes.frames.length > 1) section.place = new Place(modes.frames.map(frame => frame.value), modes.frames.map(frame => frame.time));
    const locus = viewOf(section, 'locus');
    if (section.place && locus && locus.windows.length)
      section.place.set(locus.windows.reduce((a, b) => b.growth_max > a.growth_max ? b : a).value_max);
    if (section.place) section.place.isFresh = true;
  }
  const runs = sections.filter(section => section.kind === 'run' && section.run);
  for (const section of sections) {
    if (!section.place) continue;
    for (const other of runs) {
      if (section.mechanics === undefined || other.mechanics !== section.mechanics) continue;
      other.run.places.push(section.place);
      linkPlace(section.place, other.run.view);
    }
  }
}

// Where a run is when, both ways; each leads the other once.
function linkPlace(place, view) {
  let isLed = false;
  const lead = act => {
    if (isLed) return;
    isLed = true;
    try { act(); } finally { isLed = false; }
  };
  place.listeners.add(() => lead(() => { if (place.moment !== null) view.mark(place.moment); }));
  view.momentListeners.add(() => lead(() => {
    const value = place.valueAt(view.moment);
    if (value !== null) place.set(value);
  }));
}

async function completePlace(section) {
  const locus = viewOf(section, 'locus');
  if (!locus || section.place) return;
  const values = await numbersOf(locus.value);
  let low = Infinity, high = -Infinity;
  for (const value of values) { low = Math.min(low, value); high = Math.max(high, value); }
  if (!(low < high)) return;
  section.place = new Place([low, high], [null, null]);
  section.place.isFresh = true;
}

function framed(parent, title, minHeight, make) {
  const place = element('div');
  place.style.minHeight = minHeight + 'px';
  if (title) parent.append(element('h3', {}, title));
  parent.append(place);
  whenSeen(place, async () => { await make(place); place.style.minHeight = ''; });
}

function makeView(parent, view, section) {
  const run = section.run;
  switch (view.type) {
    case 'bursts': makeBursts(parent, view, run, section); break;
    case 'table': makeTable(parent, view, section); break;
    case 'windows': makeWindows(parent, view, section); break;
    case 'slide': framed(parent, 'The slide', 340, place => makeSlide(place, view, run, section)); break;
    case 'spectrogram': framed(parent, 'Spectrogram', 430, place => makeSpectrogram(place, view, run)); break;
    case 'histories':
      framed(parent, 'Histories', 60, async place => {
        if (!run.view) {
          const clock = await clockOf(view.time);
          run.view = new TimeView(clock.first, clock.last);
          run.player = timePlayer(run.view);
          parent.insertBefore(timeTools(run.view, run.player), place);
        }
        await makeHistories(place, view, run);
        run.isTimed();
        const sound = element('div');
        if (section.kind === 'run') { place.append(element('h3', {}, 'Sound'), sound); makeSound(sound, view, run, section); }
      });
      break;
    case 'locus':
      framed(parent, 'Root locus', 440, async place => {
        await completePlace(section);
        if (!section.place) { place.append(element('p', {class: 'faint'}, 'One value alone makes no locus.')); return; }
        place.append(placeTools(section, view));
        await makeLocus(place, view, section);
      });
      break;
    case 'modes':
      framed(parent, 'Shapes of modes', 340, async place => {
        if (section.place && !viewOf(section, 'locus')) place.append(placeTools(section, view));
        await makeModes(place, view, section);
      });
      break;
    case 'field': framed(parent, null, 480, place => makeField(place, view, section)); break;
    case 'errors': framed(parent, null, 400, place => makeErrors(place, view)); break;
    case 'curves': framed(parent, null, 260, place => makeCurves(place, view, section)); break;
    case 'responses': framed(parent, null, 480, place => makeResponses(place, view)); break;
  }
}

function makeSection(section, number) {
  const place = element('section', {id: `section-${number}`, 'aria-label': section.title});
  if (report.sections.length > 1) place.append(element('h2', {}, section.title));
  if (section.purpose) place.append(element('p', {class: 'faint'}, section.purpose));
  // Of several files the verdicts stand at the head of the page, each with the way to its section.
  if (report.sections.length === 1) place.append(makeVerdict(section.verdict));
  for (const remark of section.remarks || []) place.append(element('p', {class: 'faint'}, remark));
  if (section.run && section.run.view && section.kind === 'run') place.append(timeTools(section.run.view, section.run.player));
  for (const view of section.views) makeView(place, view, section);
  if (section.results && Object.keys(section.results).length) place.append(makeResults(section.results));
  if (section.expectations) place.append(makeExpectations(section.expectations));
  place.append(makeSource(section));
  return place;
}

// Numbers by which a program can tell that the page shows what the files hold.
function selfCheck(sections) {
  return {sections: sections.length, bursts: sections.flatMap(section => section.run ? section.run.bursts.map(burst => burst.frequency) : []),
    peaks: sections.flatMap(section => (viewOf(section, 'histories') || {series: []}).series.map(series => Math.max(Math.abs(series.min ?? 0), Math.abs(series.max ?? 0))))};
}

async function makePage() {
  const {sections} = report;
  prepare(sections);
  document.getElementById('head').append(element('h1', {}, sections.length === 1 ? sections[0].title : report.title.replace(/ – stridor$/, '')));
  if (sections.length > 1) {
    document.getElementById('contents').append(...sections.map((section, number) => {
      const place = makeVerdict(section.verdict);
      place.querySelector('b').after(element('a', {href: `#section-${number}`}, section.title), '. ');
      return place;
    }));
  }
  const main = document.getElementById('sections');
  sections.forEach((section, number) => main.append(makeSection(section, number)));
  document.getElementById('foot').append(element('p', {class: 'faint'}, `stridor ${report.version} (${report.commit}); page made by `, element('code', {}, report.command),
    '. Everything shown is in this file; it asks nothing of the network.'));
  if (location.hash === '#all') await makeAll();
  let rounds = 0;
  while (location.hash === '#all' && waiting.size && ++rounds < 10) await makeAll();
  document.documentElement.dataset.check = JSON.stringify(selfCheck(sections));
  document.documentElement.dataset.ready = 'yes';
  makeRestWhenIdle();
}

makePage().catch(error => {
  document.getElementById('head').append(element('p', {class: 'verdict failed', role: 'alert'}, `The page cannot be shown: ${error.message || error}`));
  document.documentElement.dataset.ready = 'failed';
});
