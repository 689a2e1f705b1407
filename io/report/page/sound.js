// A channel as sound, played from the page.

// Samples at another rate by a windowed sinc; `ratio` new samples come of each one.
function resampled(samples, ratio) {
  const count = Math.floor(samples.length * ratio);
  const heard = new Float32Array(count);
  const cut = Math.min(1, ratio), half = Math.ceil(16 / cut);
  for (let i = 0; i < count; ++i) {
    const centre = i / ratio, first = Math.max(0, Math.ceil(centre - half)), last = Math.min(samples.length - 1, Math.floor(centre + half));
    let sum = 0;
    for (let k = first; k <= last; ++k) {
      const x = (centre - k) * cut;
      const sinc = x === 0 ? 1 : Math.sin(Math.PI * x) / (Math.PI * x);
      sum += samples[k] * sinc * (0.5 + 0.5 * Math.cos(Math.PI * (centre - k) / (half + 1)));
    }
    heard[i] = sum * cut;
  }
  return heard;
}

function makeSound(place, view, run, section) {
  const playable = view.series.filter(series => !series.states && series.factor === 1 && !view.time.values);
  if (!playable.length || !(window.AudioContext || window.webkitAudioContext)) {
    place.append(element('p', {class: 'faint'}, playable.length ? 'This browser plays no sound. ' : 'The page holds extremes only, which are no sound. ',
      element('code', {}, `stridor sound ${section.file} -o sound.wav`), ' writes it.'));
    return;
  }
  const loudest = playable.find(series => series.name.endsWith('.acceleration')) || playable[0];
  const channel = element('select', {'aria-label': 'Channel'}, playable.map((series, i) => element('option', {value: i, selected: series === loudest}, series.name)));
  const slow = element('select', {'aria-label': 'Tempo'}, [[1, 'as fast as it was'], [2, 'half as fast'], [4, 'a quarter'], [10, 'a tenth']].map(([value, text]) => element('option', {value}, text)));
  const text = element('span', {class: 'readout'});
  let context = null, source = null, isBeginning = false;
  // What is heard leads all that is seen.
  let heardNow = null;
  const motion = new Slide(() => { if (heardNow) run.view.mark(Math.min(heardNow(), run.view.last)); });
  run.sounds = motion;
  motion.listeners.add(() => {
    if (motion.isRunning) return;
    if (source) source.stop();
    source = heardNow = null;
    button.textContent = 'Play what is shown';
  });
  const stop = () => motion.stop();
  const play = async () => {
    if (source || isBeginning) {
      stop();
      return;
    }
    isBeginning = true;
    try {
      await sound();
    } finally {
      isBeginning = false;
    }
  };
  const sound = async () => {
    const series = playable[Number(channel.value)], times = Number(slow.value);
    const samples = await numbersOf(series.samples);
    const first = Math.max(0, Math.floor(run.clock.index(run.view.from))),
          end = Math.min(samples.length, Math.ceil(run.clock.index(run.view.to)) + 1);
    if ((end - first) * run.clock.step * times > 120) {
      text.textContent = 'More than two minutes: zoom in first.';
      return;
    }
    let part = samples.subarray(first, end), mean = 0, largest = 0;
    for (const value of part) mean += (isFinite(value) ? value : 0) / part.length;
    part = part.map(value => isFinite(value) ? value - mean : 0);
    context = context || new (window.AudioContext || window.webkitAudioContext)();
    const heard = resampled(part, run.clock.step * times * context.sampleRate);
    for (const value of heard) largest = Math.max(largest, Math.abs(value));
    if (!(largest > 0)) {
      text.textContent = 'Nothing moves: the sound is silent.';
      return;
    }
    const fade = Math.min(heard.length >> 1, Math.round(0.005 * context.sampleRate));
    for (let i = 0; i < heard.length; ++i)
      heard[i] *= 0.9 / largest * Math.min(1, i / fade, (heard.length - 1 - i) / fade);
    const buffer = context.createBuffer(1, heard.length, context.sampleRate);
    buffer.copyToChannel(heard, 0);
    source = context.createBufferSource();
    source.buffer = buffer;
    source.connect(context.destination);
    const played = source;
    source.onended = () => {
      if (source !== played) return;  // it was stopped
      run.view.mark(Math.min(run.clock.at(end - 1), run.view.last));
      stop();
    };
    motion.start();
    const start = context.currentTime, from = run.clock.at(first);
    source.start();
    button.textContent = 'Stop';
    text.textContent = `${digits(heard.length / context.sampleRate, 3)} s, loudest ${shown(largest, series.units)}; up to ${shown(Math.min(0.5 / run.clock.step, 0.5 * context.sampleRate * times), 'Hz')} is heard`;
    // currentTime is that of what goes out, which is heard later.
    const delay = context.outputLatency || context.baseLatency || 0;
    heardNow = () => from + Math.max(0, context.currentTime - start - delay) / times;
  };
  const button = element('button', {type: 'button', onclick: () => play().catch(error => { text.textContent = String(error.message || error); })}, 'Play what is shown');
  place.append(element('div', {class: 'tools'}, button, element('label', {}, 'Channel', channel), element('label', {}, 'Tempo', slow), text),
    element('p', {class: 'faint'}, 'As a file: ', element('code', {}, `stridor sound ${section.file} -o sound.wav`)));
  place.sound = {resampled, play, isPlaying: () => source !== null};  // for those who test the page
}
