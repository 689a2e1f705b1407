// Reports opened in Chromium and Firefox: what they show, how they move, and that they ask nothing of the
// network. Every check runs in both browsers; what their drivers cannot do stands in report_drivers.cjs.
'use strict';
const {execFileSync} = require('child_process');
const fs = require('fs');
const os = require('os');
const path = require('path');
const assert = require('assert/strict');
const {drivers} = require('./report_drivers.cjs');

const program = process.env.STRIDOR_PROGRAM;
const source = process.env.STRIDOR_SOURCE_DIR;

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'stridor-report-'));
process.on('exit', () => fs.rmSync(folder, {recursive: true, force: true}));
const at = name => path.join(folder, name);
const stridor = (...words) => execFileSync(program, words, {encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'], maxBuffer: 1 << 28});

const beams = path.join(source, 'scenes/beam_on_beam.yaml');
stridor('run', beams, '-o', at('run.h5'));
stridor('locus', beams, '--from', '30mm', '--to', '98mm', '--points', '137', '--about', 'deformed', '-o', at('locus.h5'));
stridor('report', at('run.h5'), at('locus.h5'), '-o', at('beams.html'));
stridor('run', path.join(source, 'scenes/examples/meshed_disc.yaml'), '-o', at('disc.h5'));
stridor('report', at('disc.h5'), '-o', at('disc.html'));
stridor('run', path.join(source, 'scenes/examples/sliding_block.yaml'), '-o', at('block.h5'));
stridor('report', at('block.h5'), '-o', at('block.html'));
stridor('run', path.join(source, 'scenes/examples/disc_squeal.yaml'), '-o', at('squeal.h5'));
stridor('report', at('squeal.h5'), '-o', at('squeal.html'));
stridor('cycle', path.join(source, 'scenes/viscoelastic_sphere.yaml'), '-o', at('cycle.h5'));
stridor('report', at('cycle.h5'), '-o', at('cycle.html'));
stridor('map', path.join(source, 'scenes/viscoelastic_sphere.yaml'), '--x', 'parameters.v', '1e-3', '1', '9', '--y', 'parameters.tau0', '1e-3', '1', '7', '--scale', 'log', '-o', at('map.h5'));
stridor('report', at('map.h5'), '-o', at('map.html'));
// Where the load pulls the beams apart nothing slides.
stridor('map', path.join(source, 'scenes/beam_on_beam.yaml'), '--about', 'deformed', '--x', 'drive.load', '-0.1', '0.05', '4', '--y',
  'contact.friction.coefficient', '0.29', '0.3', '2', '--set', 'contact.assumption=film', '--set', 'contact.start=75.2 mm', '-o', at('failed.h5'));
stridor('report', at('failed.h5'), '-o', at('failed.html'));
stridor('precision', path.join(source, 'scenes/viscoelastic_sphere.yaml'), '--points', '4', '--tune', '1e-3', '-o', at('study'));
stridor('report', at('study/precision.h5'), '-o', at('study.html'));
stridor('frf', beams, '--input', 'cantilever.free_end.y', '--output', 'cantilever.free_end.y.acceleration', '--output', 'cantilever.free_end.y.displacement', '--from', '10Hz', '--to', '12kHz', '-o', at('frf.h5'));
stridor('report', at('frf.h5'), '-o', at('frf.html'));
stridor('sweep', path.join(source, 'scenes/viscoelastic_sphere.yaml'), '--set', 'parameters.v=0.03', '--parameter', 'parameters.tau0', '--from', '0.01', '--to', '0.1', '--points', '4', '--up-down', '-o', at('cycles.h5'));
stridor('report', at('cycles.h5'), '-o', at('cycles.html'));
stridor('eig', beams, '--at', '82mm', '--about', 'deformed', '--explain', '-o', at('eig.h5'));
stridor('report', at('eig.h5'), '-o', at('eig.html'));
stridor('contact', path.join(source, 'scenes/viscoelastic_contact.yaml'), '--table', at('law.h5'), '--speeds', '0.1', '10', '5', '--indentations', '0.01', '0.1', '5', '--set', 'contacts.tip.normal.solver.grid=32');
stridor('report', at('law.h5'), '-o', at('law.html'));
const info = JSON.parse(stridor('info', at('run.h5'), '--json'));


const url = (name, hash = '#all') => `file://${at(name)}${hash}`;
const near = (a, b, share) => assert.ok(Math.abs(a - b) <= share * Math.abs(b), `${a} is not ${b}`);

// What checks find on a page, put there once: the place that has a member for tests, how many colours a
// canvas shows (a blank one has one), the heading and what follows it.
const helpers = `
  window.placeOf = name => [...document.querySelectorAll('div')].find(one => one[name]);
  window.pixelsOf = canvas => {
    const copy = document.createElement('canvas');
    copy.width = canvas.width; copy.height = canvas.height;
    const context = copy.getContext('2d', {willReadFrequently: true});
    context.drawImage(canvas, 0, 0);
    const {data} = context.getImageData(0, 0, copy.width, copy.height);
    return new Uint32Array(data.buffer);
  };
  window.coloursOf = canvas => new Set(pixelsOf(canvas)).size;
  // Whether a colour of the page is within some pixels of a place of a chart.
  window.hasColourAt = (chart, pixels, x, y, names) => {
    const {canvas} = chart, ratio = canvas.width / canvas.clientWidth, column = Math.round(ratio * chart.px(x)), row = Math.round(ratio * chart.py(y));
    const wanted = names.map(name => colour(name)).map(text => (0xff000000 | parseInt(text.slice(5, 7) + text.slice(3, 5) + text.slice(1, 3), 16)) >>> 0);
    for (let i = -3; i <= 3; ++i) for (let k = -3; k <= 3; ++k) if (wanted.includes(pixels[(row + k) * canvas.width + column + i])) return true;
    return false;
  };
  window.visibleCanvases = () => [...document.querySelectorAll('canvas')].filter(one => one.isConnected && one.clientWidth);
  window.tableUnder = title => [...document.querySelectorAll('h3')].find(one => one.textContent === title).nextElementSibling;
`;
async function opened(driver, name, look = {}, hash = '#all') {
  const tab = await driver.open(url(name, hash), look);
  await tab.evaluate(helpers);
  return tab;
}
const needle = `window.markSpot = (chart, x, y) => { chart.canvas.scrollIntoView({block: 'center'}); const box = chart.canvas.getBoundingClientRect(); return [box.left + chart.px(x), box.top + chart.py(y)]; }`;

async function sameAsTheFile(tab) {
  const check = JSON.parse(await tab.evaluate(() => document.documentElement.dataset.check));
  assert.deepEqual(check.bursts, info.bursts.map(burst => burst.frequency));
  assert.ok(check.peaks.length >= 3);
}

async function nothingIsBlank(tab, what) {
  const counts = await tab.evaluate(() => visibleCanvases().map(coloursOf));
  assert.ok(counts.length >= 1 && counts.every(count => count > 2), `${what}: a canvas is blank: ${counts}`);
}

// Waits until the mode shown is the one that grows in a window.
function showsMode(tab, {frequency, growth_max}) {
  return tab.until(([frequency, growth_max]) => {
    const told = [...document.querySelectorAll('div.readout')].map(d => d.textContent).find(t => t.startsWith('Mode ')) || '';
    const [, number, unit, growth] = told.match(/Mode \d+: ([\d.]+) (k?Hz), growth rate ([−-]?[\d.]+)/) || [];
    return Math.abs(number * (unit === 'kHz' ? 1000 : 1) / frequency - 1) < 0.01 && Math.abs(growth / growth_max - 1) < 0.01;
  }, [frequency, growth_max]);
}

// The pointer on a burst in the spectrogram tells its frequency; that on the locus names the branch.
async function hovers(tab) {
  await tab.evaluate(needle);
  const burst = info.bursts[info.bursts.length - 1];
  const spot = await tab.evaluate(([moment, hertz]) => markSpot(placeOf('spectrogram').spectrogram, moment, hertz), [0.5 * (burst.start + burst.end), burst.frequency]);
  await tab.move(...spot);
  const told = await tab.evaluate(() => placeOf('spectrogram').spectrogram.readout.textContent);
  assert.match(told, /burst \d+: [\d.]+ k?Hz/);
  assert.match(told, /dB/);
  const branch = await tab.evaluate(() => {
    const {plane, branches} = placeOf('locus').locus;
    const one = branches.find(branch => branch.frequency[0] > 3000 && branch.frequency[0] < 4000);
    return markSpot(plane, one.growth[0], one.frequency[0]);
  });
  await tab.move(...branch);
  assert.match(await tab.evaluate(() => placeOf('locus').locus.plane.readout.textContent), /branch \d+ at contact.start = .*kHz, growth/);
}

// A drag zooms all views to the same stretch, Back returns; a click marks a time in all of them.
async function zooms(tab) {
  const drag = await tab.evaluate(() => {
    const {canvas} = placeOf('spectrogram').spectrogram;
    canvas.scrollIntoView({block: 'center'});
    const box = canvas.getBoundingClientRect();
    return [box.left + 0.5 * box.width, box.left + 0.7 * box.width, box.top + 0.5 * box.height];
  });
  await tab.drag([drag[0], drag[2]], [drag[1], drag[2]]);
  const views = await tab.evaluate(() => {
    const {view} = report.sections[0].run, {diagram} = placeOf('diagram');
    return {from: view.from, to: view.to, low: diagram.scales.x.min, high: diagram.scales.x.max, all: view.last};
  });
  assert.ok(views.to - views.from < 0.5 * views.all && views.to > views.from);
  near(views.low, views.from, 1e-9);
  near(views.high, views.to, 1e-9);
  await tab.click('Back');
  assert.ok(await tab.evaluate(() => report.sections[0].run.view.length) > 0.9 * views.all);
  for (const place of ['spectrogram', 'diagram']) {
    const spot = await tab.evaluate(place => {
      const over = place === 'diagram' ? placeOf('diagram').diagram.over : placeOf('spectrogram').spectrogram.canvas;
      over.scrollIntoView({block: 'center'});
      const box = over.getBoundingClientRect();
      return [box.left + 0.4 * box.width, box.top + 0.5 * box.height];
    }, place);
    await tab.evaluate(() => { report.sections[0].run.view.mark(0); });
    await tab.page.mouse.click(...spot);
    const moment = await tab.evaluate(() => report.sections[0].run.view.moment);
    assert.ok(moment > 0.3 * views.all && moment < 0.5 * views.all, `a click in the ${place} marks ${moment} s`);
  }
  await tab.evaluate(() => { report.sections[0].run.view.reset(); });
}

// Below one sample per pixel the very samples are drawn.
async function drawsTheSamples(tab) {
  const drawn = await tab.evaluate(() => {
    report.sections[0].run.view.set(1.9, 1.904);
    const {diagram} = placeOf('diagram');
    return [Array.from(diagram.data[0]), Array.from(diagram.data[1])];
  });
  const python = `
import h5py, json
f = h5py.File(${JSON.stringify(at('run.h5'))}, 'r')
name = '/channels/${info.results['free_end_acceleration.channel']}'
t = f['/time'][()]; keep = (t >= 1.8999) & (t <= 1.9041)
print(json.dumps([t[keep].tolist(), f[name][()][keep].tolist()]))`;
  let recorded = null;
  try { recorded = JSON.parse(execFileSync('/usr/bin/python3', ['-c', python], {encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore']})); } catch { console.log('no h5py: samples not compared'); return; }
  const scale = await tab.evaluate(() => scaleFor(report.sections[0].views.find(v => v.type === 'histories').series[0].max, 'm/s^2')[0]);
  let compared = 0;
  drawn[0].forEach((moment, i) => {
    const k = recorded[0].findIndex(t => Math.abs(t - moment) < 1e-7);
    if (k < 0) return;
    assert.ok(Math.abs(drawn[1][i] * scale - recorded[1][k]) < 1e-4, `sample at ${moment}`);
    ++compared;
  });
  assert.ok(compared > 300, `${compared} samples`);
  await tab.evaluate(() => { report.sections[0].run.view.reset(); });
}

// A row of the table, by the keyboard, moves all views to the burst; the slider, too, is one of keys.
async function answersKeys(tab) {
  await tab.evaluate(() => { document.querySelector('tr[tabindex]').focus(); });
  await tab.press('Enter');
  const first = await tab.evaluate(() => ({from: report.sections[0].run.view.from, to: report.sections[0].run.view.to, moment: report.sections[0].run.view.moment}));
  assert.ok(first.from < info.bursts[0].start && first.to > info.bursts[0].end && first.to - first.from < 1);
  assert.ok(first.moment > info.bursts[0].start && first.moment < info.bursts[0].end);
  const now = () => tab.evaluate(() => {
    const {mesh} = placeOf('mesh');
    return {value: report.sections[1].place.value, moment: report.sections[0].run.view.moment, middle: mesh.places[3 * mesh.parts[1].first],
      slid: placeOf('slide').slide.moved[3 * placeOf('slide').slide.view.parts[1].first]};
  });
  await tab.evaluate(() => { document.querySelector('input[aria-label="contact.start"]').focus(); });
  await tab.press('Home');
  await tab.wait(200);
  const before = await now();
  near(before.value, 0.03, 1e-9);
  await tab.evaluate(() => { report.sections[0].run.view.reset(); });
  for (const key of ['PageUp', 'PageUp', 'PageUp', 'ArrowRight']) await tab.press(key);
  await tab.wait(300);
  const after = await now();
  assert.ok(after.value > before.value + 0.005, `keys moved the position to ${after.value}`);
  assert.ok(after.moment > before.moment + 0.1);
  near(after.middle - before.middle, after.value - before.value, 0.02);  // the sliding body moves with the slider
  near(after.slid - before.slid, after.value - before.value, 0.02);      // and so it does in the slide of the run
}

// A click on a window shows the motion that grows there, and so does one on a burst that a window explains.
async function followsWindows(tab) {
  const windows = await tab.evaluate(() => report.sections[1].views.find(v => v.type === 'windows').windows);
  assert.ok(windows.length > 5);
  for (let i = 0; i < windows.length; ++i) {
    await tab.evaluate(number => { tableUnder('Unstable windows').querySelectorAll('tbody tr')[number].click(); }, i);
    await showsMode(tab, windows[i]);
  }
  const explained = await tab.evaluate(() => report.sections[0].run.predicted.find(row => row.burst === report.sections[0].run.bursts.length));
  await tab.evaluate(() => { tableUnder('Bursts of vibration').querySelector('tbody tr:last-child').click(); });
  await showsMode(tab, explained);
}

// Of the loops that play, none runs before it is asked to.
async function restsAtFirst(tab) {
  assert.deepEqual(await tab.evaluate(() => [moving.size, nextPicture]), [0, 0]);
}

// Along the locus: a marker on every branch, the bodies, their mode and the time of the run move along.
async function playsTheLocus(tab) {
  const now = () => tab.evaluate(() => {
    const {mesh} = placeOf('mesh');
    return {value: report.sections[1].place.value, moment: report.sections[0].run.view.moment, middle: mesh.places[3 * mesh.parts[1].first],
      mode: Array.from(mesh.motion.subarray(0, 60)).join(), runs: report.sections[1].player.motion.isRunning};
  });
  await tab.evaluate(() => {
    report.sections[1].place.set(0.03);
    report.sections[1].player.pace.value = '4';
    const button = [...document.querySelectorAll('#section-1 button')].find(one => one.textContent === 'Play');
    button.focus();
  });
  await tab.wait(500);  // shapes are unpacked as they are come to
  const first = await now();
  await tab.press('Enter');
  await tab.until(() => report.sections[1].place.value > 0.045);
  await tab.press(' ');  // on the button, which now says Stop
  await tab.wait(500);
  const stopped = await now();
  assert.ok(!stopped.runs);
  assert.ok(stopped.moment > first.moment + 0.4 && stopped.middle > first.middle + 0.014 && stopped.mode !== first.mode);
  await tab.wait(300);
  assert.equal((await now()).value, stopped.value);
  // Where a marker is to be, the canvas has the colour of one.
  const markers = await tab.evaluate(() => {
    const {plane, branches} = placeOf('locus').locus;
    plane.mark();
    const pixels = pixelsOf(plane.canvas);
    return branches.map(branch => branchAt(branch, report.sections[1].place.value)).filter(one => one && one.frequency > 0)
      .map(one => hasColourAt(plane, pixels, one.growth, one.frequency, ['loud', 'accent']));
  });
  assert.ok(markers.length > 10 && markers.every(Boolean), `markers: ${markers}`);
  await tab.evaluate(() => { report.sections[1].place.set(0.0965); report.sections[1].player.motion.start(); });
  await tab.until(() => !report.sections[1].player.motion.isRunning);
  near((await now()).value, 0.098, 1e-9);
}

// In a run: bodies are where the drive was at that time, the locus follows, the lines of all views stand there.
async function playsTheRun(tab) {
  await tab.evaluate(() => { report.sections[0].run.view.reset(); report.sections[0].run.view.mark(0.4); report.sections[0].run.player.pace.value = '12'; });
  await tab.click('Play', '#section-0');
  await tab.until(() => report.sections[0].run.view.moment > 0.6);
  await tab.click('Stop', '#section-0');
  const now = await tab.evaluate(() => {
    const {view} = report.sections[0].run, {place} = report.sections[1], {slide} = placeOf('slide'), {diagram} = placeOf('diagram'), sliding = slide.view.parts.find(part => part.drive !== undefined);
    const mark = diagram.over.querySelector('.moment').getBoundingClientRect(), over = diagram.over.getBoundingClientRect();
    return {moment: view.moment, of_slide: slide.moment, way: slide.moved[3 * sliding.first] - slide.places[3 * sliding.first], still: slide.moved[0] - slide.places[0],
      value: place.value, wanted: place.valueAt(view.moment), line: (mark.left + 1 - over.left) / over.width, share: (view.moment - view.from) / view.length, running: moving.size};
  });
  assert.equal(now.running, 0);
  assert.equal(now.of_slide, now.moment);
  near(now.way, 0.03 * (now.moment - 0.05), 1e-3);  // 30 mm/s, reached along a ramp of 0.1 s
  assert.equal(now.still, 0);
  near(now.value, now.wanted, 1e-12);
  assert.ok(Math.abs(now.line - now.share) < 0.004, `line at ${now.line} instead of ${now.share}`);
  // To the end of what is shown, and from its beginning again; the space bar on the picture plays.
  await tab.evaluate(() => { report.sections[0].run.view.set(2, 2.01); report.sections[0].run.player.pace.value = '4'; report.sections[0].run.view.mark(2.0099); placeOf('slide').slide.mesh.canvas.focus(); });
  await tab.press(' ');
  await tab.until(() => !report.sections[0].run.player.motion.isRunning);
  near(await tab.evaluate(() => report.sections[0].run.view.moment), 2.01, 1e-9);
  await tab.press(' ');
  await tab.until(() => report.sections[0].run.view.moment < 2.008);
  // A tab that is hidden does nothing, and goes on where it was.
  const hide = hidden => tab.evaluate(isHidden => {
    Object.defineProperty(document, 'hidden', {value: isHidden, configurable: true});
    document.dispatchEvent(new Event('visibilitychange'));
    return [nextPicture, report.sections[0].run.view.moment];
  }, hidden);
  const [pictures, hiddenAt] = await hide(true);
  assert.equal(pictures, 0);
  await tab.wait(300);
  assert.deepEqual(await hide(true), [0, hiddenAt]);
  assert.ok((await hide(false))[0] !== 0);
  await tab.until(moment => report.sections[0].run.view.moment !== moment, hiddenAt);
  // Paper has a still.
  await tab.evaluate(() => { report.sections[0].run.player.motion.start(); });
  assert.ok((await tab.page.pdf()).length > 1e5);
  await restsAtFirst(tab);
  await tab.evaluate(() => { report.sections[0].run.view.reset(); });
}

// A mode vibrates when it is asked to, and out of sight costs nothing.
async function vibrates(tab) {
  await tab.click('Vibrate', '#section-1');
  await tab.until(() => placeOf('mesh').mesh.phase > 1);
  await tab.evaluate(() => { scrollTo(0, 0); });
  await tab.until(() => nextPicture === 0 && moving.size === 1);
  await tab.click('Pause', '#section-1');
  await restsAtFirst(tab);
}

// A tone comes through at its level; what is heard leads what is seen, and ends what was played.
async function sounds(tab, driver) {
  const tone = await tab.evaluate(() => {
    const {resampled} = placeOf('sound').sound;
    const samples = Float64Array.from({length: 4000}, (_, i) => Math.sin(2 * Math.PI * 0.05 * i));
    const heard = resampled(samples, 0.48);
    let off = 0;
    for (let i = 200; i < heard.length - 200; ++i) off = Math.max(off, Math.abs(heard[i] - Math.sin(2 * Math.PI * 0.05 * i / 0.48)));
    return off;
  });
  assert.ok(tone < 1e-2, `resampled tone off by ${tone}`);
  await tab.evaluate(() => { report.sections[0].run.view.set(1.5, 2.2); report.sections[0].run.player.motion.start(); });
  await tab.click('Play what is shown');
  await tab.until(() => /loudest/.test(placeOf('sound').textContent));
  assert.ok(await tab.evaluate(() => !report.sections[0].run.player.motion.isRunning && report.sections[0].run.sounds.isRunning));
  // Without a device for sound the clock of Firefox stands still.
  if (driver.name === 'Chromium') {
    await tab.until(() => report.sections[0].run.view.moment > 1.6 && placeOf('slide').slide.moment === report.sections[0].run.view.moment);
    await tab.until(() => !report.sections[0].run.sounds.isRunning);
  } else {
    await tab.until(() => placeOf('slide').slide.moment >= 1.5 && placeOf('slide').slide.moment <= 2.2);
    await tab.click('Stop', '#section-0');
    await tab.click('Play what is shown');
    await tab.click('Play', '#section-0');
    assert.ok(await tab.evaluate(() => report.sections[0].run.player.motion.isRunning && !report.sections[0].run.sounds.isRunning));
    await tab.click('Stop', '#section-0');
  }
  await restsAtFirst(tab);
}

// Narrow and dark: nothing is wider than the window, also with all that is folded open, of which tables scroll
// inside themselves; every column has one unit, which stands in its head.
async function fitsNarrowAndDark(driver) {
  for (const name of ['beams.html', 'disc.html', 'block.html', 'squeal.html', 'map.html', 'study.html', 'frf.html', 'cycle.html', 'cycles.html', 'eig.html', 'law.html']) {
    const tab = await opened(driver, name, {width: 400, dark: true});
    const width = () => tab.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(await width() <= 400, `${name} is wider than 400 px`);
    assert.equal(await tab.evaluate(() => getComputedStyle(document.body).backgroundColor), 'rgb(20, 23, 28)');
    await tab.evaluate(() => { document.querySelectorAll('details').forEach(one => { one.open = true; }); });
    assert.ok(await width() <= 400, `${name}, all open, is wider than 400 px`);
    assert.deepEqual(await tab.evaluate(() => [...document.querySelectorAll('tbody td:not(.text)')].map(cell => cell.textContent).filter(text => /\d (k?Hz|[mµ]?s|[mµk]?m|1\/s)$/.test(text))), [], name);
    await nothingIsBlank(tab, name);
    await tab.close();
  }
}

// In space: WebGL 2 where it is, else the canvas; what slides does, what spins turns.
async function playsInSpace(driver) {
  const seen = tab => tab.evaluate(() => {
    const {slide} = placeOf('slide'), {view, mesh} = slide;
    return {has_gl: !!mesh.gl, up: mesh.up, drawn: [coloursOf(mesh.canvas), mesh.gl ? coloursOf(mesh.over) : 3], picture: mesh.canvas.toDataURL(), parts: view.parts.map(part => {
      const of = list => Array.from(list.subarray(3 * part.first, 3 * part.first + 3));
      return {name: part.name, rest: of(slide.places), now: of(slide.moved)};
    })};
  });
  const played = async (name, until) => {
    const tab = await opened(driver, name);
    await tab.evaluate(() => { placeOf('slide').slide.mesh.canvas.scrollIntoView({block: 'center'}); });
    await tab.wait(200);
    const before = await seen(tab);
    await tab.evaluate(() => { report.sections[0].run.player.pace.value = '4'; });
    await tab.click('Play', '#section-0');
    await tab.until(time => report.sections[0].run.view.moment > time, until);
    await tab.click('Stop', '#section-0');
    await tab.evaluate(() => { placeOf('slide').slide.mesh.canvas.scrollIntoView({block: 'center'}); });
    await tab.wait(200);
    const after = await seen(tab), moment = await tab.evaluate(() => report.sections[0].run.view.moment);
    assert.equal(after.has_gl, driver.name === 'Chromium', 'WebGL 2 is used where it is');
    assert.ok(after.drawn[0] > 10 && after.drawn[1] > 2, `colours: ${after.drawn}`);
    assert.notEqual(after.picture, before.picture);
    await tab.close();
    return {moment, up: after.up, part: name => after.parts.find(part => part.name === name)};
  };
  // 1 m/s, reached along a ramp of 2 ms, along x; the rail lies below the block.
  const block = await played('block.html', 0.008);
  assert.equal(block.up, 1);
  const {rest, now} = block.part('slider');
  near(now[0] - rest[0], block.moment - 0.001, 2e-3);
  assert.deepEqual([now[1], now[2], ...block.part('rail').now], [rest[1], rest[2], ...block.part('rail').rest]);
  // 10 rad/s about z.
  const squeal = await played('squeal.html', 0.05);
  const disc = squeal.part('disc'), angle = Math.atan2(disc.now[1], disc.now[0]) - Math.atan2(disc.rest[1], disc.rest[0]);
  const off = angle - 10 * squeal.moment;
  assert.ok(Math.abs(off - 2 * Math.PI * Math.round(off / (2 * Math.PI))) < 1e-4, `turned by ${angle} at ${squeal.moment} s`);
}

// The dot on the orbit of a limit cycle is where its histories are.
async function playsACycle(driver) {
  const tab = await opened(driver, 'cycle.html');
  await tab.click('Play');
  await tab.until(() => report.sections[0].run.view.moment > 0.02);
  await tab.click('Stop');
  assert.ok(await tab.evaluate(() => {
    const [chart] = placeOf('curves').curves, {run} = report.sections[0], i = Math.round(run.clock.index(run.view.moment));
    const view = report.sections[0].views.find(view => view.type === 'curves');
    run.view.mark(run.clock.at(i));
    chart.draw();
    return hasColourAt(chart, pixelsOf(chart.canvas), view.sets[0].numbers[i], view.panels[0].curves[0].numbers[i], ['mark']);
  }));
  await tab.close();
}

// Where motion is to be reduced the page plays what it is asked to, and nothing else.
async function movesNothingUnasked(driver) {
  const tab = await opened(driver, 'beams.html', {still: true});
  assert.ok(await tab.evaluate(() => matchMedia('(prefers-reduced-motion: reduce)').matches));
  await tab.evaluate(() => { placeOf('mesh').mesh.canvas.scrollIntoView(); });
  await tab.wait(200);
  await restsAtFirst(tab);
  assert.equal(await tab.evaluate(() => placeOf('mesh').mesh.phase), 0);
  await tab.click('Play', '#section-0');
  await tab.until(() => report.sections[0].run.view.moment > 0);
  await tab.close();
}

async function tellsOfMaps(driver) {
  const map = await opened(driver, 'map.html');
  // Small vibrations are stable or not; nothing of a locus is loud. The verdict is said once.
  assert.equal(await map.evaluate(() => [...document.querySelectorAll('.verdict')].map(one => one.querySelector('b').textContent).join()), '! Unstable.');
  await map.evaluate(() => { placeOf('field').field.chart.click(0.03, 0.03); });
  assert.match(await map.evaluate(() => document.body.textContent), /Repeat it with stridor eig .*viscoelastic_sphere.yaml --about undeformed --method \w+ --set parameters.v=0.03\d* --set parameters.tau0=0.03/);
  await map.close();
  const failed = await opened(driver, 'failed.html');
  const [known, unknown] = await failed.evaluate(() => [placeOf('field').field.describe(-0.1, 0.3).text, placeOf('field').field.describe(0.05, 0.3).text]);
  assert.match(known, /largest growth rate/);
  assert.match(unknown, /failed: no sliding equilibrium: .*free to move/);
  assert.match(await failed.evaluate(() => document.body.textContent), /points failed: no sliding equilibrium/);
  await failed.close();
}

// A response in the complex plane has one length for one number, units of its own, and no chords.
async function tellsOfResponses(driver) {
  const frf = await opened(driver, 'frf.html');
  const planes = await frf.evaluate(() => placeOf('responses').responses.map(({plane, magnitude}) => {
    const f = plane.inner;
    return {across: f.width / (plane.x.to - plane.x.from), up: f.height / (plane.y.to - plane.y.from), units: magnitude.y.units,
      units_of_plane: [plane.x.text.label, plane.y.text.label].map(label => label.split('(')[1]), decades: Math.log10(magnitude.y.to / magnitude.y.from)};
  }));
  assert.deepEqual(planes.map(one => one.units).sort(), ['m/N', 'm/s^2/N']);
  for (const one of planes) {
    near(one.across, one.up, 1e-6);
    assert.equal(one.units_of_plane[0], one.units_of_plane[1]);
    assert.ok(one.decades <= 6.2, `${one.decades} decades`);
  }
  const chords = await frf.evaluate(() => report.sections[0].views.find(v => v.type === 'responses').groups.flatMap(group => group.curves.map(curve => {
    let longest = 0;
    const [xs, ys] = curve.plane;
    for (let i = 1; i < xs.length; ++i) { const step = Math.hypot(xs[i] - xs[i - 1], ys[i] - ys[i - 1]); if (step > longest) longest = step; }
    return longest / group.most;
  })));
  for (const one of chords) assert.ok(one > 0 && one <= 0.1, `a chord of ${one}`);
  await frf.close();
}

async function tellsOfTheOthers(driver) {
  // Up and down are one picture, whose hover says the state in words.
  const cycles = await opened(driver, 'cycles.html');
  assert.match(await cycles.evaluate(() => {
    const [chart] = placeOf('curves').curves;
    return chart.name + ': ' + chart.hover(0.01);
  }), /^amplitude: up, .*at rest; equilibrium \w+ – down, /);
  await cycles.close();
  // A row of eigenvalues shows its mode.
  const eig = await opened(driver, 'eig.html');
  await showsMode(eig, {frequency: 3515.52, growth_max: 76.54});
  await eig.evaluate(() => { document.querySelectorAll('tbody tr')[4].click(); });
  await showsMode(eig, {frequency: 1139.06, growth_max: -7.228});
  await eig.close();
  const study = await opened(driver, 'study.html');
  assert.match(await study.evaluate(() => {
    const first = report.sections[0].views[0].settings[0];
    return placeOf('errors').errors.hover(first.run_time, first.error);
  }), /^event_driven, tolerance .*: [\d.]+ m?s, error [\d.]+·10⁻/);
  await study.close();
}

// Not everything is unpacked at once, but before a page is printed that nobody has scrolled.
async function unpacksWhatIsSeen(driver) {
  const tab = await opened(driver, 'beams.html', {}, '');
  assert.ok(await tab.evaluate(() => waiting.size) > 0);
  await tab.until(() => waiting.size === 0);
  await tab.wait(500);
  assert.ok((await tab.page.pdf()).length > 1e5);
  await nothingIsBlank(tab, 'a page that was printed');
  await tab.close();
}

async function checkIn(driver) {
  const tab = await opened(driver, 'beams.html');
  await restsAtFirst(tab);
  await sameAsTheFile(tab);
  await nothingIsBlank(tab, 'beams.html');
  for (const check of [hovers, zooms, drawsTheSamples, answersKeys, followsWindows, playsTheLocus, playsTheRun, vibrates, sounds]) {
    await check(tab, driver);
    if (process.env.STRIDOR_SAYS_CHECKS) console.log(`${driver.name}: ${check.name}`);
  }
  await tab.close();
  for (const check of [fitsNarrowAndDark, playsInSpace, playsACycle, movesNothingUnasked, tellsOfMaps, tellsOfResponses, tellsOfTheOthers, unpacksWhatIsSeen]) {
    await check(driver);
    if (process.env.STRIDOR_SAYS_CHECKS) console.log(`${driver.name}: ${check.name}`);
  }
  await driver.close();
  console.log(`${driver.name}: met`);
}

drivers.reduce((before, driver) => before.then(() => checkIn(driver)), Promise.resolve())
  .then(() => process.exit(0), error => { console.error(error); process.exit(1); });
