// A quantity over two others: stability maps, pressures.

// Edges between values, half-way; a logarithmic axis has them at equal ratios.
function edgesOf(values, isLog) {
  const inner = isLog ? Array.from(values, Math.log10) : Array.from(values);
  const edges = [];
  for (let i = 0; i + 1 < inner.length; ++i) edges.push(0.5 * (inner[i] + inner[i + 1]));
  const first = inner.length > 1 ? 2 * inner[0] - edges[0] : inner[0] - 0.5;
  const last = inner.length > 1 ? 2 * inner[inner.length - 1] - edges[edges.length - 1] : inner[0] + 0.5;
  const all = [first, ...edges, last];
  return isLog ? all.map(v => 10 ** v) : all;
}

function isGeometric(values) {
  if (values.length < 4 || values[0] <= 0) return false;
  const ratios = (values[1] / values[0]) / (values[values.length - 1] / values[values.length - 2]);
  return Math.abs(ratios - 1) < 1e-3 && values[values.length - 1] / values[0] > 3;
}

function nearestIndex(values, value, isLog) {
  let best = 0, least = Infinity;
  for (let i = 0; i < values.length; ++i) {
    const off = isLog ? Math.abs(Math.log(values[i] / value)) : Math.abs(values[i] - value);
    if (off < least) [best, least] = [i, off];
  }
  return best;
}

async function makeField(place, view, section) {
  const [xs, ys, values] = await Promise.all([view.x, view.y, view.value].map(one => numbersOf(one.values)));
  const lines = await Promise.all(view.lines.map(numbersOf));
  const failure = view.failure ? await numbersOf(view.failure) : null;
  const isLogX = isGeometric(xs), isLogY = isGeometric(ys);
  const edgesX = edgesOf(xs, isLogX), edgesY = edgesOf(ys, isLogY);
  let low = Infinity, high = -Infinity;
  for (const value of values) if (isFinite(value)) { low = Math.min(low, value); high = Math.max(high, value); }
  const isSigned = view.scale === 'signed', isLog = view.scale === 'log' && low > 0;
  const inner = value => isLog ? Math.log(value) : value;
  const size = Math.max(Math.abs(low), Math.abs(high)) || 1;
  // Growth rates span decades: the root of their size keeps small ones visible.
  const shareOf = value => isSigned ? 0.5 + 0.5 * Math.sign(value) * Math.sqrt(Math.abs(value) / size)
    : high > low ? (inner(value) - inner(low)) / (inner(high) - inner(low)) : 0.5;
  const stops = isSigned ? palettes.signed : palettes.viridis;
  let chosen = null;
  if (view.title) place.append(element('h3', {}, view.title));
  const note = element('div', {class: 'readout'});
  const chart = new Chart(place, {
    x: new Axis(view.x.name, view.x.units, edgesX[0], edgesX[edgesX.length - 1], isLogX),
    y: new Axis(view.y.name, view.y.units, edgesY[0], edgesY[edgesY.length - 1], isLogY),
    height: 420, isPicture: true, name: `${view.value.name} over ${view.x.name} and ${view.y.name}`,
    under: chart => {
      const c = chart.context;
      for (let j = 0; j < ys.length; ++j) {
        const top = chart.py(edgesY[j + 1]), bottom = chart.py(edgesY[j]);
        for (let i = 0; i < xs.length; ++i) {
          const value = values[j * xs.length + i];
          if (!isFinite(value)) c.fillStyle = colour('line');
          else c.fillStyle = `rgb(${paletteColour(stops, shareOf(value))})`;
          const left = chart.px(edgesX[i]), right = chart.px(edgesX[i + 1]);
          c.fillRect(left - 0.3, top - 0.3, right - left + 0.6, bottom - top + 0.6);
        }
      }
    },
    paint: chart => {
      for (const line of lines) {
        const x = [], y = [];
        for (let i = 0; i + 1 < line.length; i += 2) { x.push(line[i]); y.push(line[i + 1]); }
        chart.line(x, y, isSigned ? '#111111' : '#ffffff', 1.8);
      }
      if (chosen) chart.dot(xs[chosen.i], ys[chosen.j], 'transparent', 7, '#000000');
    },
    hover: (x, y) => describe(x, y).text,
    click: (x, y) => {
      chosen = describe(x, y);
      note.replaceChildren(`Nearest point computed: ${chosen.text}. `,
        ...(view.reproduce ? ['Repeat it with ', element('code', {}, command(chosen))] : []));
      chart.draw();
    },
  });
  const command = point => view.reproduce.replace('@X@', String(xs[point.i])).replace('@Y@', String(ys[point.j]));
  const describe = (x, y) => {
    const i = nearestIndex(xs, x, isLogX), j = nearestIndex(ys, y, isLogY);
    const value = values[j * xs.length + i];
    const reason = failure && view.reasons[failure[j * xs.length + i] - 1];
    const what = isFinite(value) ? `${view.value.name} ${shown(value, view.value.units)}`
      : reason ? `failed: ${reason}` : view.missing || 'none';
    return {i, j, text: `${view.x.name} = ${shown(xs[i], view.x.units, 6)}, ${view.y.name} = ${shown(ys[j], view.y.units, 6)}: ${what}`};
  };
  const bar = element('canvas', {'aria-hidden': 'true'});
  bar.style.maxWidth = '420px';
  place.append(note, bar, element('figcaption', {}, `${view.value.name} from ${shown(low, view.value.units)} to ${shown(high, view.value.units)}`,
    isSigned ? ' (colours by the root of its size); lines: where stability changes. ' : '. ',
    view.reproduce ? 'Click for the nearest point and its command.' : ''));
  const between = share => isLog ? low * (high / low) ** share : low + (high - low) * share;
  const paintBar = () => {
    const [c, width] = sharp(bar, 34);
    for (let px = 0; px < width; ++px) {
      const value = isSigned ? size * (2 * px / width - 1) : between(px / width);
      c.fillStyle = `rgb(${paletteColour(stops, shareOf(value))})`;
      c.fillRect(px, 0, 1.5, 14);
    }
    c.fillStyle = colour('text');
    c.textBaseline = 'top';
    const ends = isSigned ? [-size, 0, size] : [low, between(0.5), high];
    ends.forEach((value, k) => {
      c.textAlign = ['left', 'center', 'right'][k];
      c.fillText(shown(value, view.value.units, 3), [0, width / 2, width][k], 17);
    });
  };
  redrawn.add(paintBar);
  paintBar();
  chart.draw();
  place.field = {chart, describe};  // for those who test the page
}
