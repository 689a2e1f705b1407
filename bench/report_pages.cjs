// Report pages in Firefox and Chromium, both measured alike: size of the file, time from navigation to the first
// picture and to all of them, and memory of all processes of the browser.
//
//   npm install --prefix build/browsers puppeteer-core@25.16.0
//   NODE_PATH=build/browsers/node_modules node bench/report_pages.cjs [OPTION...] PAGE.html...
//
//   --times N          loads of each page, each in a browser started anew; medians are printed (default: 3)
//   --browser NAME     chromium or firefox only
//   --pictures FOLDER  keeps a PNG of the whole page, all of it made, of each browser
//   --json             prints every load as a line of JSON instead of the table
//   --wait SECONDS     gives up on a page after this long (default: 120)
//
// The browsers are those of Debian; STRIDOR_CHROMIUM and STRIDOR_FIREFOX name others. Both are headless,
// driven by WebDriver BiDi, with an empty profile, a window of 1200 by 900 and pictures drawn without a graphics card.
//
// What is measured, in the page, on its own clock, whose zero is the start of the navigation:
//   text      the first text is painted (first-contentful-paint)
//   picture   some canvas has at least three colours, seen in the first frame in which it does. Until then every frame
//             looks at each canvas, made as small as 48 x 48 pixels; what that costs is included.
//   all       every view is made, with none of them scrolled to; on pages with bodies in space it holds what the first
//             WebGL context costs where there is one. Chromium draws WebGL 2 by software; headless Firefox has none and
//             draws on canvases
// and outside it, from /proc/*/smaps_rollup:
//   memory    proportional set size (Pss) of the process tree of the browser two seconds after all is made; "blank" is
//             that of the same browser with an empty page, and what the page takes is the difference. Pages of memory
//             that other browsers of the system use too count in parts, so nothing else of the kind should run
//   processor user and system time of the process tree from before the navigation until all is made
// Messages on the console, a page that says that it failed and one wider than its window end with 1.
'use strict';
const fs = require('fs');
const path = require('path');
const {pathToFileURL} = require('url');

function fail(text) {
  console.error(text);
  process.exit(2);
}

let puppeteer;
try {
  puppeteer = require('puppeteer-core');
} catch {
  fail('no puppeteer-core: install it as the head of this file says, and set NODE_PATH');
}

const options = {times: 3, browser: '', pictures: '', json: false, wait: 120};
const files = [];
for (let words = process.argv.slice(2); words.length;) {
  const word = words.shift();
  if (word === '--json') options.json = true;
  else if (['--times', '--browser', '--pictures', '--wait'].includes(word)) {
    const value = words.shift();
    if (value === undefined) fail(`${word} needs a value`);
    options[word.slice(2)] = ['--times', '--wait'].includes(word) ? Number(value) : value;
  } else if (word.startsWith('-')) fail(`unknown option ${word}`);
  else files.push(path.resolve(word));
}
if (!files.length) fail('Usage: node report_pages.cjs [--times N] [--browser NAME] [--pictures FOLDER] [--wait SECONDS] [--json] PAGE.html...');
if (!(options.times >= 1 && options.wait > 0)) fail('--times and --wait are numbers above 0');
for (const file of files) if (!fs.existsSync(file)) fail(`${file}: does not exist`);
if (options.pictures) fs.mkdirSync(options.pictures, {recursive: true});

const launches = {
  chromium: {
    browser: 'chrome', protocol: 'webDriverBiDi', executablePath: process.env.STRIDOR_CHROMIUM || '/usr/bin/chromium',
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic', '--mute-audio'],
  },
  firefox: {
    browser: 'firefox', protocol: 'webDriverBiDi', executablePath: process.env.STRIDOR_FIREFOX || '/usr/bin/firefox-esr',
    // The clock of pages is otherwise in whole milliseconds.
    extraPrefsFirefox: {'privacy.reduceTimerPrecision': false},
  },
};
if (options.browser && !launches[options.browser]) fail(`--browser is one of ${Object.keys(launches).join(', ')}`);

const pause = milliseconds => new Promise(done => setTimeout(done, milliseconds));
const median = numbers => {
  const known = numbers.filter(Number.isFinite).sort((a, b) => a - b);
  if (known.length < numbers.length) return NaN;
  return 0.5 * (known[(known.length - 1) >> 1] + known[known.length >> 1]);
};

// The process and all that descend from it, with the fields of /proc/PID/stat behind the name.
function processTree(root) {
  const stats = new Map();
  for (const name of fs.readdirSync('/proc')) {
    if (!/^\d+$/.test(name)) continue;
    try {
      const text = fs.readFileSync(`/proc/${name}/stat`, 'utf8');
      stats.set(Number(name), text.slice(text.lastIndexOf(')') + 2).split(' '));
    } catch {}  // It ended meanwhile.
  }
  const found = stats.has(root) ? [root] : [];
  for (let i = 0; i < found.length; ++i) {
    for (const [pid, stat] of stats) if (Number(stat[1]) === found[i]) found.push(pid);
  }
  return found.map(pid => ({pid, stat: stats.get(pid)}));
}

// Megabytes (1e6).
function memoryOf(root) {
  let kibibytes = 0;
  for (const {pid} of processTree(root)) {
    try {
      kibibytes += Number(/^Pss:\s+(\d+) kB/m.exec(fs.readFileSync(`/proc/${pid}/smaps_rollup`, 'utf8'))[1]);
    } catch {}
  }
  return kibibytes * 1024 / 1e6;
}

// Seconds of the living and of the children that they have waited for; clock ticks are hundredths everywhere on Linux.
const processorOf = root => processTree(root).reduce((sum, {stat}) => sum + [11, 12, 13, 14].reduce((part, i) => part + Number(stat[i]), 0), 0) / 100;

// Runs in the page before its own scripts.
function watchForPictures() {
  window.firstPicture = null;
  const copy = document.createElement('canvas');
  const context = copy.getContext('2d', {willReadFrequently: true});
  const shows = canvas => {
    if (!canvas.clientWidth || !canvas.width || !canvas.height) return false;
    copy.width = Math.min(48, canvas.width);
    copy.height = Math.min(48, canvas.height);
    context.imageSmoothingEnabled = false;
    context.drawImage(canvas, 0, 0, copy.width, copy.height);
    const {data} = context.getImageData(0, 0, copy.width, copy.height);
    return new Set(new Uint32Array(data.buffer)).size > 2;
  };
  const look = () => {
    if ([...document.querySelectorAll('canvas')].some(shows)) window.firstPicture = performance.now();
    else requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
}

async function load(name, file, picture) {
  const browser = await puppeteer.launch({...launches[name], headless: true, protocolTimeout: 1000 * options.wait});
  const result = {browser: name, page: path.basename(file), bytes: fs.statSync(file).size};
  try {
    const root = browser.process().pid;
    const page = await browser.newPage();
    const messages = [];
    page.on('console', message => messages.push(message.text()));
    page.on('pageerror', error => messages.push(String(error.stack || error)));
    await page.setViewport({width: 1200, height: 900});
    await page.goto('about:blank');
    await pause(2000);
    result.blank = memoryOf(root);
    await page.evaluateOnNewDocument(watchForPictures);
    const before = processorOf(root);
    await page.goto(pathToFileURL(file).href, {timeout: 1000 * options.wait});
    await page.waitForFunction(() => document.documentElement.dataset.ready && window.firstPicture !== null, {timeout: 1000 * options.wait});
    // Some views are made only when others are.
    result.all = await page.evaluate(async () => {
      for (let rounds = 0; waiting.size && rounds < 10; ++rounds) await makeAll();
      return performance.now();
    }) / 1000;
    result.processor = processorOf(root) - before;
    Object.assign(result, await page.evaluate(() => ({
      version: navigator.userAgent.match(/(Firefox|Chrome)\/[\d.]+/)[0],
      ready: document.documentElement.dataset.ready,
      text: (performance.getEntriesByName('first-contentful-paint')[0] || {startTime: NaN}).startTime / 1000,
      picture: window.firstPicture / 1000,
      canvases: [...document.querySelectorAll('canvas')].filter(one => one.clientWidth).length,
      wide: document.documentElement.scrollWidth - document.documentElement.clientWidth,
    })));
    await pause(2000);
    result.memory = memoryOf(root);
    if (picture) {
      await page.evaluate(() => window.scrollTo(0, 0));
      await page.screenshot({path: picture, fullPage: true});
    }
    result.messages = messages;
  } finally {
    await browser.close();
  }
  return result;
}

async function main() {
  if (!options.json) console.log('browser   page                        MB   text (s)  picture (s)  all (s)  processor (s)  memory (MB)  blank (MB)  of the page (MB)');
  let is_bad = false;
  for (const file of files) {
    for (const name of options.browser ? [options.browser] : Object.keys(launches)) {
      const loads = [];
      for (let i = 0; i < options.times; ++i) {
        const picture = options.pictures && i === 0 ? path.join(options.pictures, `${path.basename(file, '.html')}_${name}.png`) : '';
        const one = await load(name, file, picture);
        loads.push(one);
        if (options.json) console.log(JSON.stringify(one));
      }
      const middle = key => median(loads.map(one => one[key]));
      if (!options.json) {
        console.log([name.padEnd(9), path.basename(file).padEnd(24), (loads[0].bytes / 1e6).toFixed(1).padStart(5), middle('text').toFixed(2).padStart(10),
          middle('picture').toFixed(2).padStart(12), middle('all').toFixed(2).padStart(8), middle('processor').toFixed(2).padStart(14),
          middle('memory').toFixed(0).padStart(12), middle('blank').toFixed(0).padStart(11),
          median(loads.map(one => one.memory - one.blank)).toFixed(0).padStart(17)].join(' '));
      }
      for (const one of loads) {
        const faults = [...one.messages, ...(one.ready === 'yes' ? [] : ['the page says that it failed']),
          ...(one.wide > 0 ? [`it is ${one.wide} px wider than the window`] : [])];
        for (const fault of faults) console.error(`${name}, ${one.page}: ${fault}`);
        is_bad = is_bad || faults.length > 0;
      }
    }
  }
  process.exitCode = is_bad ? 1 : 0;
}

main().catch(error => { console.error(error); process.exit(1); });
