// A run in motion: bodies where their drives have moved them, contacts with their forces, and what was
// recorded of points.

// Of a number over equally spaced times, straight between them.
function sampledAt(numbers, time, moment) {
  const place = (numbers.length - 1) * Math.min(1, Math.max(0, (moment - time.from) / (time.to - time.from || 1)));
  const i = Math.min(numbers.length - 2, Math.floor(place));
  return numbers[i] + (place - i) * (numbers[i + 1] - numbers[i]);
}

// Turned about an axis of length 1 through a point.
function turnedAbout(place, {axis, point}, angle) {
  const v = place.map((x, k) => x - point[k]);
  const along = v[0] * axis[0] + v[1] * axis[1] + v[2] * axis[2], c = Math.cos(angle), s = Math.sin(angle);
  return v.map((x, k) => {
    const [i, j] = [(k + 1) % 3, (k + 2) % 3];
    return point[k] + c * x + s * (axis[i] * v[j] - axis[j] * v[i]) + (1 - c) * along * axis[k];
  });
}

const circumference = {axis: [0, 0, 1], point: [0, 0, 0]};

// Where a place of a part is at a moment.
function slidPlace(view, part, place, moment) {
  let at = place;
  if (part.spin) at = turnedAbout(at, part.spin, part.spin.speed * moment);
  const drive = part.drive === undefined ? null : view.drives[part.drive];
  if (!drive) return at;
  let way = sampledAt(drive.numbers, view.time, moment);
  if (part.radius) return turnedAbout(at, circumference, way / part.radius);
  if (part.period) way -= part.period * Math.floor(way / part.period);  // teeth without end
  return [at[0] + way, at[1], at[2]];
}

// A recorded series between two moments: where it is, and its least and largest value on the way.
class SeriesInSlide {
  constructor(series, samples, clock) {
    Object.assign(this, {series, clock, pyramid: new Pyramid(samples, series.factor)});
    this.largest = Math.max(Math.abs(series.min ?? 0), Math.abs(series.max ?? 0));
  }
  between(from, to) {
    const {clock, pyramid} = this;
    const end = Math.min(clock.count - 1, Math.max(0, Math.round(clock.index(to))));
    const begin = Math.min(end, Math.max(0, Math.round(clock.index(Math.min(from, to)))));
    let low = Infinity, high = -Infinity, now = NaN;
    for (const value of pyramid.between(begin, end + 1, 40)[1]) {
      if (isNaN(value)) continue;
      low = Math.min(low, value);
      high = Math.max(high, value);
      now = value;
    }
    return low <= high ? {low, high, now} : null;
  }
}

async function seriesOfSlide(name, section, clock) {
  const histories = viewOf(section, 'histories');
  const series = histories && histories.series.find(one => one.name === name && !one.states);
  return series ? new SeriesInSlide(series, await numbersOf(series.samples), clock) : null;
}

function arrowOn(c, from, to, width = 2) {
  const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
  if (!(length > 1)) return;
  const [x, y] = [(to[0] - from[0]) / length, (to[1] - from[1]) / length], head = Math.min(8, 0.5 * length);
  c.lineWidth = width;
  c.beginPath();
  c.moveTo(...from);
  c.lineTo(to[0] - head * x, to[1] - head * y);
  c.stroke();
  c.beginPath();
  c.moveTo(...to);
  c.lineTo(to[0] - head * x + 0.45 * head * y, to[1] - head * y - 0.45 * head * x);
  c.lineTo(to[0] - head * x - 0.45 * head * y, to[1] - head * y + 0.45 * head * x);
  c.fill();
}

// A spring between two places on the screen.
function springOn(c, from, to) {
  const [x, y] = [to[0] - from[0], to[1] - from[1]], length = Math.hypot(x, y) || 1, turns = 8;
  c.beginPath();
  c.moveTo(...from);
  for (let i = 0; i <= turns; ++i) {
    const along = 0.15 + 0.7 * i / turns, off = i === 0 || i === turns ? 0 : i % 2 ? 5 : -5;
    c.lineTo(from[0] + along * x - off * y / length, from[1] + along * y + off * x / length);
  }
  c.lineTo(...to);
  c.stroke();
}

// Of the size of the picture.
const springLength = 0.16, forceLength = 0.14;

class SlidePicture {
  constructor(view, mesh, clock) {
    Object.assign(this, {view, mesh, clock, amplitude: 1, extent: 1, moment: clock.first, former: clock.first});
    this.places = view.places.numbers;
    this.moved = new Float32Array(this.places.length);
    this.forces = view.contacts.map(contact => contact.series).filter(Boolean);
    this.largestForce = Math.max(0, ...this.forces.map(force => force.largest));
    // Of some contacts alone they would look like all.
    this.showsForces = this.largestForce > 0 && view.contacts.every(contact => contact.series && contact.normal);
    const largest = isDisplacement => Math.max(0, ...view.points.filter(point => point.series && point.is_displacement === isDisplacement).map(point => point.series.largest));
    this.largestDisplacement = largest(true);
  }
  // m on the picture for m of a displacement
  get enlarged() {
    if (!(this.largestDisplacement > 0)) return 0;
    const times = 0.08 * this.extent / this.largestDisplacement;
    return this.amplitude * (times < 3 ? 1 : times);  // large ones stand to scale
  }
  // m on the picture for one unit of a recorded series
  lengthOf(point) { return point.is_displacement ? this.enlarged : point.series.largest > 0 ? 0.12 * this.amplitude * this.extent / point.series.largest : 0; }
  set(moment, former) {
    Object.assign(this, {moment, former});
    const {view, places, moved} = this;
    for (const part of view.parts) {
      const [x, y, z] = part.count === 1 ? this.shiftOf(part) : [0, 0, 0];
      const drives = part.spin || (part.drive !== undefined && view.drives[part.drive]);
      for (let i = 3 * part.first; i < 3 * (part.first + part.count); i += 3) {
        const at = drives ? slidPlace(view, part, [places[i], places[i + 1], places[i + 2]], moment) : [places[i], places[i + 1], places[i + 2]];
        moved[i] = at[0] + x;
        moved[i + 1] = at[1] + y;
        moved[i + 2] = at[2] + z;
      }
    }
    this.mesh.move(moved);
  }
  // A body that is one point moves as that point was recorded, enlarged.
  shiftOf(part) {
    const shift = [0, 0, 0];
    for (const point of this.view.points) {
      if (!point.series || !point.is_displacement || this.view.parts[point.part] !== part) continue;
      const range = point.series.between(this.moment, this.moment);
      if (range) point.along.forEach((along, k) => { shift[k] += this.enlarged * range.now * along; });
    }
    return shift;
  }
  slid(one, shift = [0, 0, 0]) { return slidPlace(this.view, this.view.parts[one.part], one.at, this.moment).map((x, k) => x + shift[k]); }
  paint(c, screen) {
    this.paintSprings(c, screen);
    this.paintContacts(c, screen);
    this.paintPoints(c, screen);
    this.paintRuler(c);
  }
  paintSprings(c, screen) {
    c.strokeStyle = colour('faint');
    c.lineWidth = 1.2;
    for (const spring of this.view.springs) {
      const part = this.view.parts[spring.part], shift = part.count === 1 ? this.shiftOf(part) : [0, 0, 0];
      const ground = spring.to || spring.at.map((x, k) => x + springLength * this.extent * spring.behind[k]);
      const from = screen(this.slid(spring, shift)), to = screen(this.slid({part: spring.part, at: ground}));
      springOn(c, from, to);
      if (spring.behind) { c.fillStyle = colour('faint'); c.fillRect(to[0] - 4, to[1] - 4, 8, 8); }
    }
  }
  paintContacts(c, screen) {
    for (const contact of this.view.contacts) {
      const part = this.view.parts[contact.part], at = this.slid(contact, part.count === 1 ? this.shiftOf(part) : [0, 0, 0]), on = screen(at);
      const force = contact.series && contact.series.between(this.moment, this.moment) || null;
      c.strokeStyle = c.fillStyle = colour('text');
      if (this.showsForces) {
        const length = forceLength * this.extent * (force ? force.now : 0) / this.largestForce;
        arrowOn(c, on, screen(at.map((x, k) => x + length * contact.normal[k])));
      }
      c.beginPath();
      c.arc(on[0], on[1], this.view.contacts.length > 4 || part.count === 1 ? 2.5 : 4, 0, 2 * Math.PI);
      c.lineWidth = 1.5;
      if (force && force.now === 0) c.stroke(); else c.fill();
    }
  }
  paintPoints(c, screen) {
    for (const point of this.view.points) {
      if (!point.series) continue;
      const range = point.series.between(this.former, this.moment);
      if (!range) continue;
      const factor = this.lengthOf(point), at = this.slid(point);
      const end = value => screen(at.map((x, k) => x + factor * value * point.along[k]));
      c.strokeStyle = c.fillStyle = lineColour(point.series.series.number || 0);
      c.lineWidth = 5;
      c.globalAlpha = 0.45;
      c.beginPath();
      c.moveTo(...end(range.low));
      c.lineTo(...end(range.high));
      c.stroke();
      c.globalAlpha = 1;
      arrowOn(c, screen(at), end(range.now));
      c.beginPath();
      c.arc(...screen(at), 3, 0, 2 * Math.PI);
      c.fill();
    }
  }
  // A length to compare with.
  paintRuler(c) {
    const perMetre = this.mesh.perMetre, power = 10 ** Math.floor(Math.log10(110 / perMetre));
    const length = [5, 2, 1].map(m => m * power).find(one => one * perMetre <= 110);
    const y = this.mesh.height - 12, x = 12;
    c.strokeStyle = c.fillStyle = colour('text');
    c.lineWidth = 1.5;
    c.beginPath();
    c.moveTo(x, y - 4); c.lineTo(x, y); c.lineTo(x + length * perMetre, y); c.lineTo(x + length * perMetre, y - 4);
    c.stroke();
    c.textAlign = 'left';
    c.textBaseline = 'bottom';
    c.fillText(shown(length, 'm'), x + 4, y - 3);
  }
}

// What the picture shows, in words.
function slideCaption(view, picture) {
  const says = ['Bodies undeformed' + (view.drives.some(Boolean) ? ', where their drives have moved them; ways are to scale' : '') +
    (view.parts.some(part => part.spin) ? ', turned as they spin' : '') + '.'];
  if (picture.showsForces) says.push(`Dots are contacts, empty where they are open; arrows from them are contact forces, the longest ${shown(picture.largestForce, 'N', 3)}.`);
  else if (view.contacts.length) says.push('Dots are contacts.');
  const points = view.points.filter(point => point.series);
  if (points.length) says.push(`Arrows at recorded points: ${points.map(point => `${point.channel}, at most ${shown(point.series.largest, point.series.series.units, 3)}`).join('; ')}. Bars are what they pass over between two pictures.`);
  return says.join(' ');
}

async function makeSlide(place, view, run, section) {
  const clock = await clockOf(viewOf(section, 'histories').time);
  const parts = await partsOf(view);
  view.places.numbers = await numbersOf(view.places);
  for (const drive of view.drives) if (drive) drive.numbers = await numbersOf(drive);
  for (const contact of view.contacts) contact.series = await seriesOfSlide(contact.name + '.force', section, clock);
  for (const point of view.points) point.series = await seriesOfSlide(point.channel, section, clock);
  place.append(partLegend(parts));
  const mesh = new MeshView(place, parts, view, 'Bodies at the time that is marked');
  const picture = new SlidePicture({...view, parts}, mesh, clock);
  const ends = [0, 0.25, 0.5, 0.75, 1].map(share => {
    const moment = clock.first + share * (clock.last - clock.first), list = [];
    for (const part of parts) for (let i = 3 * part.first; i < 3 * (part.first + part.count); i += 3) list.push(...slidPlace(view, part, Array.from(view.places.numbers.subarray(i, i + 3)), moment));
    return list;
  });
  mesh.fit(...ends);
  // Room for springs and arrows on the side to which they point.
  picture.extent = mesh.box.extent;
  const room = (at, along, length) => at.map((x, k) => x + length * picture.extent * along[k]);
  mesh.fit(...ends, ...view.springs.filter(spring => spring.behind).map(spring => room(spring.at, spring.behind, springLength)),
    ...(picture.showsForces ? view.contacts.map(contact => room(contact.at, contact.normal, forceLength)) : []));
  mesh.marks = (c, screen) => picture.paint(c, screen);
  const text = element('div', {class: 'readout'});
  const slider = element('input', {type: 'range', min: 0, max: 1000, step: 1, value: 0, 'aria-label': 'Time',
    oninput: () => run.view.mark(run.view.from + run.view.length * slider.value / 1000)});
  slider.style.width = 'min(420px, 60vw)';
  const size = element('input', {type: 'range', min: 0, max: 3, step: 0.05, value: 1, 'aria-label': 'Size of arrows and displacements',
    oninput: () => { picture.amplitude = Number(size.value); show(); }});
  const hasPoints = view.points.some(point => point.series);
  let former = null;
  const show = () => {
    const moment = run.view.moment ?? run.view.from;
    // Bars are of what is played; a jump has none.
    const isPlayed = run.player && run.player.motion.isRunning || run.sounds && run.sounds.isRunning;
    picture.set(moment, isPlayed && former !== null && former < moment ? former : moment);
    former = moment;
    slider.value = Math.round(1000 * (moment - run.view.from) / run.view.length);
    const ways = view.drives.map((drive, d) => drive ? `drive${view.drives.length > 1 ? ' ' + (d + 1) : ''} at ${shown(sampledAt(drive.numbers, view.time, moment), 'm', 4)}` : null).filter(Boolean);
    const enlarged = picture.enlarged > 0 && hasPoints ? `; displacements ${picture.enlarged === 1 ? 'to scale' : digits(picture.enlarged, 2) + ' times enlarged'}` : '';
    text.textContent = `${shown(moment, 's', 5)}${ways.length ? ': ' + ways.join(', ') : ''}${enlarged}`;
  };
  place.append(element('div', {class: 'tools'}, element('label', {}, 'Time', slider), hasPoints ? element('label', {}, 'Amplitude', size) : null), text,
    element('figcaption', {}, slideCaption(view, picture), ' ', mesh.help));
  mesh.play = () => run.player && run.player.motion.toggle();
  run.view.listeners.add(show);
  run.view.momentListeners.add(show);
  show();
  place.slide = picture;  // for those who test the page
}
