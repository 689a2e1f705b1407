// Chromium (playwright-core) and Firefox (puppeteer-core by WebDriver BiDi) behind one face, both those of
// Debian. Exits with 77 where something is missing.
//
// What a driver cannot do: that of Firefox sets neither the colour scheme nor reduced motion of a page; they
// are preferences of the browser, which is started anew for each pair of them. Headless Firefox has no
// WebGL, so that it shows the canvas in its place; Chromium draws WebGL 2 by software. Neither driver hides
// a tab: document.hidden is set by the test.
'use strict';
const fs = require('fs');
const assert = require('assert/strict');

const skipped = why => { console.log(`skipped: ${why}`); process.exit(77); };
const load = name => { try { return require(name); } catch { return skipped(`no ${name} (NODE_PATH)`); } };
const found = names => names.find(name => fs.existsSync(name)) || skipped(`none of ${names.join(', ')}`);
const {chromium} = load('playwright-core');
const puppeteer = load('puppeteer-core');
const chromiumPath = found(['/usr/bin/chromium']);
const firefoxPath = found(['/usr/bin/firefox-esr', '/usr/bin/firefox']);

// An open page; coordinates are those of the window.
class Tab {
  constructor(page, until) { Object.assign(this, {page, until}); }
  evaluate(act, argument) { return this.page.evaluate(act, argument); }
  wait(milliseconds) { return new Promise(done => setTimeout(done, milliseconds)); }
  move(x, y) { return this.page.mouse.move(x, y); }
  async drag(from, to) {
    await this.page.mouse.move(...from);
    await this.page.mouse.down();
    await this.page.mouse.move(...to, {steps: 4});
    await this.page.mouse.up();
  }
  press(key) { return this.page.keyboard.press(key); }
  // The button of a name within what a selector finds first.
  async click(name, within = 'body') {
    const spot = await this.evaluate(([name, within]) => {
      const button = [...document.querySelector(within).querySelectorAll('button')].find(one => one.textContent === name);
      if (!button) return null;
      button.scrollIntoView({block: 'center'});
      const box = button.getBoundingClientRect();
      return [box.left + 0.5 * box.width, box.top + 0.5 * box.height];
    }, [name, within]);
    assert.ok(spot, `no button '${name}'`);
    await this.page.mouse.click(...spot);
  }
  close() { return this.page.close(); }
}

class Driver {
  constructor(name, start, prepare) { Object.assign(this, {name, start, prepare, browsers: new Map(), messages: [], requests: []}); }
  // look: {width, dark, still}
  async open(url, look = {}) {
    const {width = 1200, dark = false, still = false} = look;
    const key = this.name === 'Firefox' ? `${dark} ${still}` : '';
    if (!this.browsers.has(key)) this.browsers.set(key, await this.start(dark, still));
    const page = await this.prepare(this.browsers.get(key), {width, height: 900}, dark, still);
    page.on('console', message => this.messages.push(message.text()));
    page.on('pageerror', error => this.messages.push(String(error.stack || error)));
    page.on('request', request => this.requests.push(request.url()));
    await page.goto(url);
    const until = this.name === 'Firefox' ? (act, argument) => page.waitForFunction(act, {timeout: 60000}, argument)
      : (act, argument) => page.waitForFunction(act, argument, {timeout: 60000});
    await until(() => document.documentElement.dataset.ready === 'yes');
    return new Tab(page, until);
  }
  // Nothing is said on the console, and nothing asked of the network.
  async close() {
    for (const browser of this.browsers.values()) await browser.close();
    assert.deepEqual(this.messages, []);
    for (const one of this.requests) assert.match(one, /^(file|blob|data):/);
    assert.ok(this.requests.length > 0, 'no request was seen, not even that of the page');
  }
}

const drivers = [
  new Driver('Chromium', () => chromium.launch({executablePath: chromiumPath, args: ['--no-sandbox', '--use-angle=swiftshader',
    '--enable-unsafe-swiftshader', '--disable-quic', '--autoplay-policy=no-user-gesture-required']}),
  (browser, viewport, dark, still) => browser.newPage({viewport, colorScheme: dark ? 'dark' : 'light', reducedMotion: still ? 'reduce' : 'no-preference'})),
  new Driver('Firefox', (dark, still) => puppeteer.launch({browser: 'firefox', executablePath: firefoxPath, headless: true, extraPrefsFirefox: {
    'layout.css.prefers-color-scheme.content-override': dark ? 0 : 1, 'ui.prefersReducedMotion': still ? 1 : 0, 'media.autoplay.default': 0}}),
  async (browser, viewport) => {
    const page = await browser.newPage();
    await page.setViewport(viewport);
    return page;
  }),
];

module.exports = {drivers};
