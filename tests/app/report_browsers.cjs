// Reports opened in Chromium (playwright-core) and Firefox (puppeteer-core): what they show, and that they
// ask nothing of the network. Both browsers are those of Debian. Exits with 77 where something is missing.
'use strict';
const {execFileSync} = require('child_process');
const fs = require('fs');
const os = require('os');
const path = require('path');
const assert = require('assert/strict');

const skipped = why => { console.log(`skipped: ${why}`); process.exit(77); };
const load = name => { try { return require(name); } catch { return skipped(`no ${name} (NODE_PATH)`); } };
const found = names => names.find(name => fs.existsSync(name)) || skipped(`none of ${names.join(', ')}`);
const {chromium} = load('playwright-core');
const puppeteer = load('puppeteer-core');
const chromiumPath = found(['/usr/bin/chromium']);
const firefoxPath = found(['/usr/bin/firefox-esr', '/usr/bin/firefox']);
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

// How many colours a canvas shows: a blank one has one.
const coloursOf = `canvas => {
  const copy = document.createElement('canvas');
  copy.width = canvas.width; copy.height = canvas.height;
  const context = copy.getContext('2d');
  context.drawImage(canvas, 0, 0);
  return new Set(new Uint32Array(context.getImageData(0, 0, copy.width, copy.height).data.buffer)).size;
}`;
const url = (name, hash = '#all') => `file://${at(name)}${hash}`;
const near = (a, b, share) => assert.ok(Math.abs(a - b) <= share * Math.abs(b), `${a} is not ${b}`);

function sameAsTheFile(check) {
  assert.deepEqual(check.bursts, info.bursts.map(burst => burst.frequency));
  assert.ok(check.peaks.length >= 3);
}

async function opened(browser, name, messages, requests, options = {}, hash = '#all') {
  const page = await browser.newPage({viewport: {width: 1200, height: 900}, ...options});
  page.on('console', message => messages.push(message.text()));
  page.on('pageerror', error => messages.push(String(error.stack)));
  page.on('request', request => requests.push(request.url()));
  await page.goto(url(name, hash));
  await page.waitForFunction(() => document.documentElement.dataset.ready === 'yes', null, {timeout: 60000});
  return page;
}

// Waits until the mode shown is the one that grows in a window.
async function showsMode(page, window) {
  await page.waitForFunction(({frequency, growth_max}) => {
    const told = [...document.querySelectorAll('div.readout')].map(d => d.textContent).find(t => t.startsWith('Mode ')) || '';
    const [, number, unit, growth] = told.match(/Mode \d+: ([\d.]+) (k?Hz), growth rate ([−-]?[\d.]+)/) || [];
    return Math.abs(number * (unit === 'kHz' ? 1000 : 1) / frequency - 1) < 0.01 && Math.abs(growth / growth_max - 1) < 0.01;
  }, window, {timeout: 10000});
}

async function inChromium() {
  const browser = await chromium.launch({executablePath: chromiumPath, args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic', '--autoplay-policy=no-user-gesture-required']});
  const messages = [], requests = [];
  const page = await opened(browser, 'beams.html', messages, requests);
  sameAsTheFile(JSON.parse(await page.evaluate(() => document.documentElement.dataset.check)));

  // Every canvas shows something.
  for (const canvas of await page.$$('canvas')) {
    if (await canvas.isVisible()) assert.ok(await canvas.evaluate(eval(coloursOf)) > 2, 'a canvas is blank');
  }

  // The pointer on a burst in the spectrogram tells its frequency.
  const burst = info.bursts[info.bursts.length - 1];
  await page.evaluate(() => [...document.querySelectorAll('div')].find(d => d.spectrogram).scrollIntoView({block: 'center'}));
  const spot = await page.evaluate(([moment, hertz]) => {
    const chart = [...document.querySelectorAll('div')].find(d => d.spectrogram).spectrogram;
    const box = chart.canvas.getBoundingClientRect();
    return [box.left + chart.px(moment), box.top + chart.py(hertz)];
  }, [0.5 * (burst.start + burst.end), burst.frequency]);
  await page.mouse.move(...spot);
  const told = await page.evaluate(() => [...document.querySelectorAll('div')].find(d => d.spectrogram).spectrogram.readout.textContent);
  assert.match(told, /burst \d+: [\d.]+ k?Hz/);
  assert.match(told, /dB/);

  // A drag zooms all views to the same stretch, Back returns.
  const drag = await page.evaluate(() => {
    const box = [...document.querySelectorAll('div')].find(d => d.spectrogram).spectrogram.canvas.getBoundingClientRect();
    return [box.left + 0.5 * box.width, box.left + 0.7 * box.width, box.top + 0.5 * box.height];
  });
  await page.mouse.move(drag[0], drag[2]);
  await page.mouse.down();
  await page.mouse.move(drag[1], drag[2], {steps: 4});
  await page.mouse.up();
  const views = await page.evaluate(() => {
    const run = report.sections[0].run;
    const diagram = [...document.querySelectorAll('div')].find(d => d.diagram).diagram;
    return {from: run.view.from, to: run.view.to, low: diagram.scales.x.min, high: diagram.scales.x.max, all: run.view.last};
  });
  assert.ok(views.to - views.from < 0.5 * views.all && views.to > views.from);
  near(views.low, views.from, 1e-9);
  near(views.high, views.to, 1e-9);
  await page.getByRole('button', {name: 'Back'}).first().click();
  assert.ok(await page.evaluate(() => report.sections[0].run.view.to - report.sections[0].run.view.from) > 0.9 * views.all);

  // Below one sample per pixel the very samples are drawn.
  const shownSamples = await page.evaluate(() => {
    const run = report.sections[0].run;
    run.view.set(1.9, 1.904);
    const place = [...document.querySelectorAll('div')].find(d => d.diagram);
    return [Array.from(place.diagram.data[0]), Array.from(place.diagram.data[1])];
  });
  const python = `
import h5py, json
f = h5py.File(${JSON.stringify(at('run.h5'))}, 'r')
name = '/channels/${info.results['free_end_acceleration.channel']}'
t = f['/time'][()]; keep = (t >= 1.8999) & (t <= 1.9041)
print(json.dumps([t[keep].tolist(), f[name][()][keep].tolist()]))`;
  let recorded = null;
  try { recorded = JSON.parse(execFileSync('/usr/bin/python3', ['-c', python], {encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore']})); } catch { console.log('no h5py: samples not compared'); }
  if (recorded) {
    const scale = await page.evaluate(() => scaleFor(report.sections[0].views.find(v => v.type === 'histories').series[0].max, 'm/s^2')[0]);
    let compared = 0;
    shownSamples[0].forEach((moment, i) => {
      const k = recorded[0].findIndex(t => Math.abs(t - moment) < 1e-7);
      if (k < 0) return;
      assert.ok(Math.abs(shownSamples[1][i] * scale - recorded[1][k]) < 1e-4, `sample at ${moment}`);
      ++compared;
    });
    assert.ok(compared > 300, `${compared} samples`);
  }

  // A row of the table, by the keyboard, moves all views to the burst.
  await page.locator('tr[tabindex]').first().focus();
  await page.keyboard.press('Enter');
  const first = await page.evaluate(() => ({from: report.sections[0].run.view.from, to: report.sections[0].run.view.to, moment: report.sections[0].run.view.moment}));
  assert.ok(first.from < info.bursts[0].start && first.to > info.bursts[0].end && first.to - first.from < 1);
  assert.ok(first.moment > info.bursts[0].start && first.moment < info.bursts[0].end);

  // The slider moves the markers, the shape and the moment of the run.
  const place = () => page.evaluate(() => {
    const mesh = [...document.querySelectorAll('div')].find(d => d.mesh).mesh;
    return {value: report.sections[1].place.value, moment: report.sections[0].run.view.moment, middle: mesh.places[3 * mesh.parts[1].first]};
  });
  await page.getByRole('button', {name: 'Pause'}).click();
  const slider = page.locator('input[type=range][aria-label="contact.start"]').first();
  await slider.fill('100');
  await page.waitForTimeout(200);
  const before = await place();
  await slider.fill('900');
  await page.waitForTimeout(300);
  const after = await place();
  near(after.value, 0.03 + 0.9 * 0.068, 1e-3);
  assert.ok(after.moment > before.moment + 1);
  assert.ok(after.middle - before.middle > 0.03, 'the sliding body moves with the slider');

  // A click on a window shows the motion that grows there.
  const windows = await page.evaluate(() => report.sections[1].views.find(v => v.type === 'windows').windows);
  assert.ok(windows.length > 5);
  for (let i = 0; i < windows.length; ++i) {
    await page.evaluate(number => {
      const table = [...document.querySelectorAll('h3')].find(h => h.textContent === 'Unstable windows').nextElementSibling;
      table.querySelectorAll('tbody tr')[number].click();
    }, i);
    await showsMode(page, windows[i]);
  }
  // So does one on a burst that a window explains.
  const explained = await page.evaluate(() => report.sections[0].run.predicted.find(row => row.burst === report.sections[0].run.bursts.length));
  await page.evaluate(() => [...document.querySelectorAll('h3')].find(h => h.textContent === 'Bursts of vibration').nextElementSibling.querySelector('tbody tr:last-child').click());
  await showsMode(page, explained);

  // The hover of the locus names the branch.
  const branch = await page.evaluate(() => {
    const plane = [...document.querySelectorAll('div')].find(d => d.locus).locus.plane;
    plane.canvas.scrollIntoView({block: 'center'});
    const box = plane.canvas.getBoundingClientRect();
    const one = [...document.querySelectorAll('div')].find(d => d.locus).locus.branches.find(b => b.frequency[0] > 3000 && b.frequency[0] < 4000);
    return [box.left + plane.px(one.growth[0]), box.top + plane.py(one.frequency[0])];
  });
  await page.mouse.move(...branch);
  assert.match(await page.evaluate(() => [...document.querySelectorAll('div')].find(d => d.locus).locus.plane.readout.textContent), /branch \d+ at contact.start = .*kHz, growth/);

  // Sound: a tone comes through at its level, and what is shown is played.
  const tone = await page.evaluate(() => {
    const {resampled} = [...document.querySelectorAll('div')].find(d => d.sound).sound;
    const samples = Float64Array.from({length: 4000}, (_, i) => Math.sin(2 * Math.PI * 0.05 * i));
    const heard = resampled(samples, 0.48);
    let off = 0;
    for (let i = 200; i < heard.length - 200; ++i) off = Math.max(off, Math.abs(heard[i] - Math.sin(2 * Math.PI * 0.05 * i / 0.48)));
    return off;
  });
  assert.ok(tone < 1e-2, `resampled tone off by ${tone}`);
  await page.getByRole('button', {name: 'Play what is shown'}).click();
  await page.waitForFunction(() => /loudest/.test([...document.querySelectorAll('div')].find(d => d.sound).textContent), null, {timeout: 20000});
  await page.close();

  // Narrow, dark, in space, a map.
  for (const name of ['beams.html', 'disc.html', 'map.html', 'study.html', 'frf.html', 'cycles.html', 'eig.html', 'law.html']) {
    const narrow = await opened(browser, name, messages, requests, {viewport: {width: 400, height: 800}, colorScheme: 'dark'});
    assert.ok(await narrow.evaluate(() => document.documentElement.scrollWidth) <= 400, `${name} is wider than 400 px`);
    assert.equal(await narrow.evaluate(() => getComputedStyle(document.body).backgroundColor), 'rgb(20, 23, 28)');
    // With all that is folded open, tables scroll inside themselves.
    await narrow.evaluate(() => document.querySelectorAll('details').forEach(one => { one.open = true; }));
    assert.ok(await narrow.evaluate(() => document.documentElement.scrollWidth) <= 400, `${name}, all open, is wider than 400 px`);
    // Every column has one unit, which stands in its head.
    assert.deepEqual(await narrow.evaluate(() => [...document.querySelectorAll('tbody td:not(.text)')].map(cell => cell.textContent).filter(text => /\d (k?Hz|[mµ]?s|[mµk]?m|1\/s)$/.test(text))), [], name);
    await narrow.close();
  }
  const disc = await opened(browser, 'disc.html', messages, requests);
  assert.ok(await disc.evaluate(() => !![...document.querySelectorAll('div')].find(d => d.mesh).mesh.gl), 'WebGL 2 is used where it is');
  assert.ok(await disc.evaluate(`(${coloursOf})([...document.querySelectorAll('div')].find(d => d.mesh).mesh.canvas)`) > 10);
  await disc.close();
  const map = await opened(browser, 'map.html', messages, requests);
  await map.evaluate(() => [...document.querySelectorAll('div')].find(d => d.field).field.chart.click(0.03, 0.03));
  assert.match(await map.evaluate(() => document.body.textContent), /Repeat it with stridor eig .*viscoelastic_sphere.yaml --about undeformed --method \w+ --set parameters.v=0.03\d* --set parameters.tau0=0.03/);
  await map.close();
  const failed = await opened(browser, 'failed.html', messages, requests);
  const [known, unknown] = await failed.evaluate(() => {
    const field = [...document.querySelectorAll('div')].find(d => d.field).field;
    return [field.describe(-0.1, 0.3).text, field.describe(0.05, 0.3).text];
  });
  assert.match(known, /largest growth rate/);
  assert.match(unknown, /failed: no sliding equilibrium: .*free to move/);
  assert.match(await failed.evaluate(() => document.body.textContent), /points failed: no sliding equilibrium/);
  await failed.close();

  // Small vibrations are stable or not; nothing of a locus is loud. The verdict is said once.
  const verdicts = await opened(browser, 'map.html', messages, requests);
  assert.equal(await verdicts.evaluate(() => [...document.querySelectorAll('.verdict')].map(one => one.querySelector('b').textContent).join()), '! Unstable.');
  await verdicts.close();

  // A response in the complex plane has one length for one number, units of its own, and no chords.
  const frf = await opened(browser, 'frf.html', messages, requests);
  const planes = await frf.evaluate(() => [...document.querySelectorAll('div')].find(d => d.responses).responses.map(({plane, magnitude}) => {
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

  // Up and down are one picture, whose hover says the state in words.
  const cycles = await opened(browser, 'cycles.html', messages, requests);
  assert.match(await cycles.evaluate(() => {
    const [chart] = [...document.querySelectorAll('div')].find(d => d.curves).curves;
    return chart.name + ': ' + chart.hover(0.01);
  }), /^amplitude: up, .*at rest; equilibrium \w+ – down, /);
  await cycles.close();

  // A row of eigenvalues shows its mode.
  const eig = await opened(browser, 'eig.html', messages, requests);
  await showsMode(eig, {frequency: 3515.52, growth_max: 76.54});
  await eig.locator('tbody tr').nth(4).click();
  await showsMode(eig, {frequency: 1139.06, growth_max: -7.228});
  await eig.close();

  const study = await opened(browser, 'study.html', messages, requests);
  assert.match(await study.evaluate(() => {
    const chart = [...document.querySelectorAll('div')].find(d => d.errors).errors;
    const first = report.sections[0].views[0].settings[0];
    return chart.hover(first.run_time, first.error);
  }), /^event_driven, tolerance .*: [\d.]+ m?s, error [\d.]+·10⁻/);
  await study.close();

  // Not everything is unpacked at once, but before a page is printed that nobody has scrolled.
  const lazy = await opened(browser, 'beams.html', messages, requests, {}, '');
  assert.ok(await lazy.evaluate(() => waiting.size) > 0);
  await lazy.waitForFunction(() => waiting.size === 0, null, {timeout: 60000});
  await lazy.waitForTimeout(500);
  await lazy.emulateMedia({media: 'print'});
  for (const canvas of await lazy.$$('canvas'))
    if (await canvas.isVisible()) assert.ok(await canvas.evaluate(eval(coloursOf)) > 2, 'a canvas is printed blank');
  await lazy.close();
  assert.deepEqual(messages, []);
  for (const one of requests) assert.match(one, /^(file|blob):/);
  await browser.close();
}

async function inFirefox() {
  const browser = await puppeteer.launch({browser: 'firefox', executablePath: firefoxPath, headless: true});
  const errors = [];
  for (const name of ['beams.html', 'disc.html', 'map.html', 'study.html', 'frf.html', 'cycles.html', 'eig.html', 'law.html']) {
    const page = await browser.newPage();
    page.on('pageerror', error => errors.push(String(error)));
    await page.goto(url(name));
    await page.waitForFunction(() => document.documentElement.dataset.ready === 'yes', {timeout: 60000});
    if (name === 'beams.html') sameAsTheFile(JSON.parse(await page.evaluate(() => document.documentElement.dataset.check)));
    const colours = await page.evaluate(`[...document.querySelectorAll('canvas')].filter(c => c.clientWidth && c.isConnected).map(${coloursOf})`);
    assert.ok(colours.length >= 1 && colours.every(count => count > 2), `${name}: ${colours}`);
    await page.close();
  }
  assert.deepEqual(errors, []);
  await browser.close();
}

inChromium().then(() => console.log('Chromium: met')).then(inFirefox).then(() => console.log('Firefox: met'))
  .then(() => process.exit(0), error => { console.error(error); process.exit(1); });
