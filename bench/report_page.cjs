// Time to the first picture, to all of them, of a zoom, and memory of reports in Chromium:
// NODE_PATH=build/browsers/node_modules node bench/report_page.cjs $PWD/report.html …
const {chromium} = require('playwright-core');
(async () => {
  const browser = await chromium.launch({executablePath: '/usr/bin/chromium', args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic', '--enable-precise-memory-info']});
  for (const f of process.argv.slice(2)) {
    const page = await browser.newPage({viewport: {width: 1200, height: 900}});
    const t0 = Date.now();
    await page.goto('file://' + f);
    await page.waitForFunction(() => [...document.querySelectorAll('div')].some(d => d.spectrogram), null, {timeout: 60000});
    const t1 = Date.now();
    await page.evaluate(() => makeAll());
    await page.evaluate(() => makeAll());
    await page.waitForFunction(() => [...document.querySelectorAll('div')].filter(d => d.diagram).length >= 3, null, {timeout: 60000});
    const t2 = Date.now();
    const zoom = await page.evaluate(() => { const t = performance.now(); for (let i = 0; i < 20; ++i) report.sections[0].run.view.set(0.1 * i, 0.1 * i + 0.3); return (performance.now() - t) / 20; });
    const client = await page.context().newCDPSession(page);
    const m = await page.evaluate(() => performance.memory.usedJSHeapSize / 1e6);
    console.log(f, 'first picture', t1 - t0, 'ms, all', t2 - t0, 'ms; zoom of all', zoom.toFixed(1), 'ms; heap', m.toFixed(0), 'MB');
    await page.close();
  }
  await browser.close();
})();
