// What moves on the page: one loop of pictures for all, which rests where nothing is seen to move.

const moving = new Set();
let nextPicture = 0;

// Canvases out of sight are drawn when they come into view, or before a print.
const late = new Map();
const sightings = 'IntersectionObserver' in window ? new IntersectionObserver(entries => {
  for (const {target, isIntersecting} of entries) {
    target.isSeen = isIntersecting;
    if (isIntersecting) drawLate(target);
  }
  keepMoving();
}) : null;

function watchSight(canvas) { if (sightings) sightings.observe(canvas); }

function drawLate(canvas) {
  const draw = late.get(canvas);
  late.delete(canvas);
  if (draw) draw();
}

function drawWhenSeen(canvas, draw) {
  if (canvas.isSeen === false) late.set(canvas, draw);
  else draw();
}

function keepMoving() {
  const isWanted = !document.hidden && [...moving].some(motion => motion.isSeen);
  if (isWanted && !nextPicture) nextPicture = requestAnimationFrame(showMotions);
  if (isWanted || !nextPicture) return;
  cancelAnimationFrame(nextPicture);
  nextPicture = 0;
}

function showMotions(now) {
  nextPicture = 0;
  for (const motion of [...moving]) {
    // After a pause, as of a hidden tab, motions go on where they were.
    const seconds = motion.former === null || !motion.isSeen ? 0 : Math.min(0.5, (now - motion.former) / 1000);
    motion.former = motion.isSeen ? now : null;
    if (motion.isSeen) motion.step(seconds);
  }
  keepMoving();
}

document.addEventListener('visibilitychange', () => {
  moving.forEach(motion => { motion.former = null; });
  keepMoving();
});

// Paper shows where a motion is when the print begins.
addEventListener('beforeprint', () => {
  [...moving].forEach(motion => motion.stop());
  [...late.keys()].forEach(drawLate);
});

class Motion {
  // step(seconds): shows what has changed since the picture before.
  // view: with the canvas of the only thing that moves; out of sight nothing is to be done
  constructor(step, view = null) {
    Object.assign(this, {step, view, former: null});
    this.listeners = new Set();
  }
  get isRunning() { return moving.has(this); }
  get isSeen() { return !this.view || this.view.canvas.isSeen !== false; }
  start() {
    if (this.isRunning) return;
    moving.add(this);
    this.former = null;
    this.listeners.forEach(listen => listen());
    keepMoving();
  }
  stop() {
    if (!moving.delete(this)) return;
    keepMoving();
    this.listeners.forEach(listen => listen());
  }
  toggle() { if (this.isRunning) this.stop(); else this.start(); }
}

// A way that is run through, of which the page plays one at a time.
class Slide extends Motion {
  start() {
    for (const other of [...moving]) if (other instanceof Slide && other !== this) other.stop();
    super.start();
  }
}

function motionButton(motion, words, says) {
  const button = element('button', {type: 'button', onclick: () => motion.toggle()});
  const tell = () => {
    button.textContent = words[motion.isRunning ? 1 : 0];
    button.title = motion.isRunning ? '' : says;
    button.setAttribute('aria-label', button.textContent + (motion.isRunning ? '' : ': ' + says));
  };
  motion.listeners.add(tell);
  tell();
  return button;
}

// How long a way takes; asItWas: there is a time that it took.
function paceChoice(asItWas) {
  const paces = [[4, '4 s'], [12, '12 s'], [40, '40 s'], [120, '2 minutes'], ...(asItWas ? [[0, 'as long as it did']] : [])];
  return element('select', {'aria-label': 'Time that playing takes'}, paces.map(([seconds, text]) => element('option', {value: seconds, selected: seconds === 12}, text)));
}

// Plays what a view of time shows.
function timePlayer(view) {
  const pace = paceChoice(true);
  const motion = new Slide(seconds => {
    const isInside = view.moment !== null && view.moment >= view.from && view.moment < view.to;
    const rate = Number(pace.value) ? view.length / Number(pace.value) : 1;
    const moment = isInside ? view.moment + rate * seconds : view.from;
    view.mark(Math.min(moment, view.to));
    if (moment >= view.to) motion.stop();
  });
  return {motion, pace};
}

// Plays the way along a key.
function placePlayer(where) {
  const pace = paceChoice(false);
  const low = where.values[0], high = where.values[where.values.length - 1];
  const motion = new Slide(seconds => {
    const value = where.isFresh || where.value >= high ? low : where.value + (high - low) / Number(pace.value) * seconds;
    where.set(value);
    if (value >= high) motion.stop();
  });
  return {motion, pace};
}
