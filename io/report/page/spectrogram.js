// Levels over time and frequency, with bursts and predicted windows.

async function makeSpectrogram(place, view, run) {
  const levels = await numbersOf(view.levels);
  const {time, frequency} = view;
  const timeEnd = time.from + time.step * time.count, frequencyEnd = frequency.from + frequency.step * frequency.count;
  const picture = element('canvas', {width: time.count, height: frequency.count});
  const settings = {top: 0, range: 80, palette: 'viridis'};

  const level = (moment, hertz) => {
    const i = Math.floor((moment - time.from) / time.step), k = Math.floor((hertz - frequency.from) / frequency.step);
    if (i < 0 || k < 0 || i >= time.count || k >= frequency.count) return null;
    const byte = levels[i * frequency.count + k];
    return byte === 0 ? null : view.top - (255 - byte) * view.step;
  };
  const paintPicture = () => {
    const c = picture.getContext('2d');
    const image = c.createImageData(time.count, frequency.count);
    const palette = new Uint32Array(256);
    for (let byte = 0; byte < 256; ++byte) {
      const below = (255 - byte) * view.step + settings.top;
      const [r, g, b] = paletteColour(palettes[settings.palette], 1 - below / settings.range);
      palette[byte] = (255 << 24 | b << 16 | g << 8 | r) >>> 0;
    }
    const pixels = new Uint32Array(image.data.buffer);
    for (let i = 0; i < time.count; ++i)
      for (let k = 0; k < frequency.count; ++k)
        pixels[(frequency.count - 1 - k) * time.count + i] = palette[levels[i * frequency.count + k]];
    c.putImageData(image, 0, 0);
  };
  const x = new Axis('time', 's', run.view.from, run.view.to);
  x.first = run.view.first;
  x.last = run.view.last;
  const chart = new Chart(place, {
    x, y: new Axis('frequency', 'Hz', Math.max(0, frequency.from), frequencyEnd), height: 360, isPicture: true,
    name: `Spectrogram of ${view.channel}`,
    under: chart => {
      const c = chart.context;
      c.imageSmoothingEnabled = false;
      const left = chart.px(time.from), right = chart.px(timeEnd), low = chart.py(frequency.from), high = chart.py(frequencyEnd);
      c.fillStyle = `rgb(${paletteColour(palettes[settings.palette], 0)})`;
      const f = chart.inner;
      c.fillRect(f.x, f.y, f.width, f.height);
      c.drawImage(picture, left, high, right - left, low - high);
    },
    paint: chart => {
      const c = chart.context;
      c.lineWidth = 1.4;
      for (const window of run.predicted) {
        const half = 0.012 * (chart.y.to - chart.y.from);
        c.setLineDash([3, 3]);
        c.strokeStyle = '#ffffff';
        const y0 = chart.py(window.frequency + half), y1 = chart.py(window.frequency - half);
        c.strokeRect(chart.px(window.from), y0, Math.max(2, chart.px(window.to) - chart.px(window.from)), y1 - y0);
      }
      if (run.resolved > chart.y.from && run.resolved < chart.y.to) {
        c.fillStyle = '#ffffff';
        c.fillRect(chart.inner.x, chart.py(run.resolved), chart.inner.width, 1);
      }
      c.setLineDash([]);
      c.font = 'bold 12px system-ui';
      c.textBaseline = 'bottom';
      c.textAlign = 'left';
      for (const burst of run.bursts) {
        c.strokeStyle = '#ff9d5c';
        const half = 0.02 * (chart.y.to - chart.y.from);
        const sounds = [burst.frequency, burst.start_frequency, burst.end_frequency].filter(isFinite).filter(Boolean);
        const y0 = chart.py(Math.max(...sounds) + half), y1 = chart.py(Math.min(...sounds) - half);
        c.strokeRect(chart.px(burst.start), y0, Math.max(2, chart.px(burst.end) - chart.px(burst.start)), y1 - y0);
        c.beginPath();
        burst.course.times.forEach((time, i) => c.lineTo(chart.px(time), chart.py(burst.course.frequencies[i])));
        c.stroke();
        c.fillStyle = '#ffffff';
        c.fillText(String(burst.number), chart.px(burst.start) + 2, y0 - 1);
      }
    },
    marks: chart => {
      if (run.view.moment === null) return;
      chart.context.fillStyle = '#ffffff';
      chart.context.fillRect(chart.px(run.view.moment) - 1, chart.inner.y, 2, chart.inner.height);
    },
    click: moment => run.view.mark(moment),
    play: () => run.player && run.player.motion.toggle(),
    hover: (moment, hertz) => {
      const db = level(moment, hertz);
      const burst = run.bursts.find(b => moment >= b.start && moment <= b.end && Math.abs(hertz - frequencyAt(b, moment)) < 0.03 * (chart.y.to - chart.y.from));
      const words = [`${shown(moment, 's', 5)}, ${shown(hertz, 'Hz')}`];
      if (db !== null) words.push(`${db.toFixed(1)} dB, ${shown(view.reference * 10 ** (db / 20), view.units, 3)}`);
      else words.push('below all levels kept');
      if (burst) words.push(`burst ${burst.number}: ${shown(frequencyAt(burst, moment), 'Hz')}${harmonicOf(burst)}, gain ${digits(burst.gain, 3)}${isDoubtful(burst, run.resolved) ? ', above what the bodies resolve' : ''}`);
      return words.join(': ');
    },
    zoomed: () => run.view.set(chart.x.from, chart.x.to),
  });
  const slider = (label, min, max, key) => {
    const input = element('input', {type: 'range', min, max, step: '1', value: settings[key], 'aria-label': label,
      oninput: () => { settings[key] = Number(input.value); paintPicture(); chart.draw(); }});
    return element('label', {}, label, input);
  };
  const choice = element('select', {'aria-label': 'Colours', onchange: () => { settings.palette = choice.value; paintPicture(); chart.draw(); }},
    ['viridis', 'heat', 'grey'].map(name => element('option', {value: name}, name)));
  place.append(element('div', {class: 'tools'}, slider('Shift of levels', -40, 60, 'top'), slider('Range of levels (dB)', 20, 127, 'range'), element('label', {}, 'Colours', choice)),
  element('figcaption', {}, `${view.channel}; 0 dB is ${shown(view.reference, view.units)}, the highest level ${digits(view.top, 4)} dB. ${view.caption || ''} `,
    run.bursts.length ? 'Framed: bursts, the line in the frame their frequency over time. ' : '', run.predicted.length ? 'Dotted: predicted windows. ' : '',
      run.resolved !== null && run.resolved > frequency.from && run.resolved < frequencyEnd ? `White line: ${shown(run.resolved, 'Hz', 4)}, up to which the bodies are resolved. ` : '',
    'Click to mark a time, drag to zoom, double click to see all, Ctrl and wheel or + and − to scale.'));
  run.view.listeners.add(() => { chart.x.set(run.view.from, run.view.to); chart.draw(); });
  run.view.momentListeners.add(() => chart.mark());
  paintPicture();
  chart.draw();
  place.spectrogram = chart;  // for those who test the page
}
