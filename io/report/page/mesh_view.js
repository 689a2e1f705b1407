// Bodies in motion: in their plane on a canvas, in space by WebGL 2, or on a canvas where there is none.

const partColours = [[0.04, 0.33, 0.58], [0.76, 0.25, 0.05], [0.18, 0.49, 0.2], [0.48, 0.12, 0.64], [0.55, 0.43, 0]];

function loopsOf(sizes, nodes) {
  const loops = [];
  let begin = 0;
  for (const size of sizes) {
    loops.push(Array.from(nodes.subarray(begin, begin + size)));
    begin += size;
  }
  return loops;
}

// The parts of a view with what is drawn between their nodes.
async function partsOf(view) {
  const loops = async one => one ? loopsOf(await numbersOf(one.sizes), await numbersOf(one.nodes)) : [];
  return Promise.all(view.parts.map(async part => ({...part, faces: await loops(part.faces), lines: await loops(part.lines)})));
}

function partLegend(parts) {
  return element('div', {class: 'legend'}, parts.map((part, number) => {
    const box = element('i');
    box.style.background = `rgb(${partColours[number % partColours.length].map(v => Math.round(255 * v))})`;
    return element('span', {}, box, part.name);
  }));
}

// Of a face as WebGL lights it.
function lightOn(places, loop) {
  const [a, b, d] = [places[loop[0]], places[loop[1]], places[loop[2]]];
  const u = b.map((x, k) => x - a[k]), v = d.map((x, k) => x - a[k]);
  const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  return Math.abs(0.3 * n[0] + 0.5 * n[1] - 0.8 * n[2]) / (Math.hypot(...n) * Math.hypot(0.3, 0.5, 0.8) || 1);
}

// Of a face seen, positive where its nodes run as those of a closed body do on the side of the viewer.
function facing(places, loop) {
  let area = 0;
  loop.forEach((node, i) => {
    const a = places[node], b = places[loop[(i + 1) % loop.length]];
    area += a[0] * b[1] - a[1] * b[0];
  });
  return area;
}

// 1 or -1 of a closed body, each edge of which is of two faces, by the way in which these run; 0 of others.
function outwardOf(part, places) {
  const uses = new Map();
  let volume = 0;
  const at = node => [places[3 * node] - places[3 * part.first], places[3 * node + 1] - places[3 * part.first + 1], places[3 * node + 2] - places[3 * part.first + 2]];
  for (const loop of part.faces) {
    loop.forEach((node, i) => {
      const other = loop[(i + 1) % loop.length], key = node < other ? `${node} ${other}` : `${other} ${node}`;
      uses.set(key, (uses.get(key) || 0) + 1);
      if (i < 2) return;
      const [a, b, c] = [at(loop[0]), at(loop[i - 1]), at(node)];
      volume += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
    });
  }
  return part.faces.length && [...uses.values()].every(count => count === 2) ? Math.sign(volume) : 0;
}

class MeshView {
  // parts: [{name, first, count, faces: loops, lines: loops}]; view: {planar, up}.
  // marks(context, screen), where it is set, draws over the bodies; play(), where it is set, answers the space bar
  constructor(place, parts, view, label) {
    Object.assign(this, {parts, isPlanar: view.planar, up: view.up ?? 2, angle: [0.6, 0.5], closeness: 1, amplitude: 1, phase: 0, shift: [0, 0]});
    this.canvas = element('canvas', {tabindex: '0', role: 'img', 'aria-label': label});
    this.over = element('canvas', {class: 'over', 'aria-hidden': 'true'});
    place.append(element('div', {class: 'layers'}, this.canvas));
    this.edges = this.uniqueEdges();
    if (!this.isPlanar && parts.some(part => part.faces.length)) this.startWebGl();
    this.listen();
    watchSight(this.canvas);
    redrawn.add(() => this.draw());
  }
  get help() {
    return `${this.isPlanar ? 'Drag to move' : 'Drag to turn'}, Ctrl and wheel or + and − to scale, double click to begin anew; the space bar plays.`;
  }
  uniqueEdges() {
    return this.parts.map(part => {
      const seen = new Set(), edges = [];
      const add = (a, b) => {
        const key = a < b ? `${a} ${b}` : `${b} ${a}`;
        if (!seen.has(key)) { seen.add(key); edges.push([a, b]); }
      };
      for (const loop of part.faces) loop.forEach((node, i) => add(node, loop[(i + 1) % loop.length]));
      for (const line of part.lines) line.forEach((node, i) => { if (i) add(line[i - 1], node); });
      return edges;
    });
  }
  listen() {
    let start = null;
    this.canvas.addEventListener('pointerdown', event => { start = [event.clientX, event.clientY]; this.canvas.setPointerCapture(event.pointerId); });
    this.canvas.addEventListener('pointermove', event => {
      if (!start) return;
      const dx = event.clientX - start[0], dy = event.clientY - start[1];
      start = [event.clientX, event.clientY];
      if (this.isPlanar) { this.shift[0] += dx; this.shift[1] += dy; } else {
        this.angle[0] += dx * 0.01;
        this.angle[1] = Math.max(-1.55, Math.min(1.55, this.angle[1] + dy * 0.01));
      }
      this.draw();
    });
    this.canvas.addEventListener('pointerup', () => { start = null; });
    this.canvas.addEventListener('dblclick', () => { this.closeness = 1; this.shift = [0, 0]; this.angle = [0.6, 0.5]; this.draw(); });
    this.canvas.addEventListener('wheel', event => {
      if (!event.ctrlKey && !event.shiftKey) return;
      event.preventDefault();
      this.closeness *= event.deltaY > 0 || event.deltaX > 0 ? 0.85 : 1.18;
      this.draw();
    }, {passive: false});
    this.canvas.addEventListener('keydown', event => {
      const turn = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}[event.key];
      if (event.key === '+') this.closeness *= 1.18;
      else if (event.key === '-') this.closeness *= 0.85;
      else if (turn && this.isPlanar) { this.shift[0] -= 20 * turn[0]; this.shift[1] -= 20 * turn[1]; }
      else if (turn) { this.angle[0] += 0.1 * turn[0]; this.angle[1] += 0.1 * turn[1]; }
      else if (event.key === ' ' && this.play) this.play();
      else return;
      event.preventDefault();
      this.draw();
    });
  }
  // places: x, y, z of all nodes; motion: real parts of all, then imaginary parts, or null
  show(places, motion) {
    Object.assign(this, {places, motion});
    if (!this.box) this.fit(places);
    if (this.gl) this.upload();
    this.redraw();
  }
  // The same bodies elsewhere.
  move(places) {
    this.places = places;
    if (this.gl) this.uploadPlaces();
    this.redraw();
  }
  // The box about all places that the view will show.
  fit(...lists) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (const places of lists)
      for (let i = 0; i < places.length; ++i) {
        low[i % 3] = Math.min(low[i % 3], places[i]);
        high[i % 3] = Math.max(high[i % 3], places[i]);
      }
    this.box = {middle: low.map((v, k) => 0.5 * (v + high[k])), extent: Math.hypot(...low.map((v, k) => high[k] - v)) || 1,
      size: low.map((v, k) => high[k] - v)};
  }
  get scale() { return this.motion ? 0.06 * this.amplitude * this.box.extent : 0; }
  moved() {
    const {places, motion, scale} = this;
    if (!motion) return places;
    const count = places.length, moved = new Float32Array(count);
    const a = scale * Math.cos(this.phase), b = -scale * Math.sin(this.phase);
    for (let i = 0; i < count; ++i) moved[i] = places[i] + a * motion[i] + b * motion[count + i];
    return moved;
  }
  turned(point) {
    if (this.isPlanar) return point;
    const [a, b] = this.angle;
    // Into axes of which the last one shows upwards.
    const [u, v, w] = this.up === 2 ? point : this.up === 1 ? [point[0], -point[2], point[1]] : [-point[2], point[1], point[0]];
    const x = Math.cos(a) * u + Math.sin(a) * v, y = -Math.sin(a) * u + Math.cos(a) * v;
    return [x, Math.cos(b) * w + Math.sin(b) * y, Math.cos(b) * y - Math.sin(b) * w];
  }
  // At first at once, so that there always is a picture.
  redraw() {
    if (this.isDrawn) drawWhenSeen(this.canvas, () => this.draw());
    else this.draw();
  }
  draw() {
    if (!this.canvas.isConnected || !this.places) return;
    late.delete(this.canvas);
    this.isDrawn = true;
    if (this.gl) this.drawWebGl();
    else this.drawFlat();
    if (this.marks) this.drawMarks();
  }
  // Pixels of a canvas for a metre, without those by which a screen is sharper.
  get perMetre() {
    const width = this.canvas.clientWidth || 600, {height, box} = this;
    if (!this.isPlanar) return this.closeness * Math.min(width, height) / (Math.min(box.extent, 1.1 * Math.max(...box.size)) + 0.1 * box.extent);
    // Room for displacements of the usual size on all sides.
    const size = box.size.map(v => 1.04 * v + 0.16 * box.extent);
    return this.closeness * Math.min(width / size[0], height / size[1]);
  }
  screen(point) {
    const p = this.turned(point.map((x, k) => x - this.box.middle[k])), factor = this.perMetre;
    return [(this.canvas.clientWidth || 600) / 2 + this.shift[0] + factor * p[0], this.height / 2 + this.shift[1] - factor * p[1]];
  }
  // On the canvas itself, or on one above it where it is one of WebGL.
  drawMarks() {
    if (this.gl && !this.over.isConnected) this.canvas.after(this.over);
    const c = this.gl ? sharp(this.over, this.height)[0] : this.canvas.getContext('2d');
    this.marks(c, point => this.screen(point));
  }
  get height() { return this.isPlanar ? 260 : 380; }
  drawFlat() {
    const [c] = sharp(this.canvas, this.height);
    const project = (points, node) => this.screen([points[3 * node], points[3 * node + 1], points[3 * node + 2]]);
    const layer = (points, faint) => this.parts.forEach((part, number) => {
      const [r, g, b] = partColours[number % partColours.length].map(v => Math.round(255 * v));
      c.strokeStyle = faint ? colour('line') : darkness.matches ? `rgb(${r / 2 + 127},${g / 2 + 127},${b / 2 + 127})` : `rgb(${r},${g},${b})`;
      c.lineWidth = faint ? 0.8 : 1.1;
      c.beginPath();
      for (const [from, to] of this.edges[number]) { c.moveTo(...project(points, from)); c.lineTo(...project(points, to)); }
      c.stroke();
      if (this.edges[number].length) return;
      c.fillStyle = c.strokeStyle;
      for (let node = part.first; node < part.first + part.count; ++node) {
        const [x, y] = project(points, node);
        c.fillRect(x - 4, y - 4, 8, 8);
      }
    });
    if (this.motion && this.isPlanar) layer(this.places, true);
    if (this.isPlanar || !this.paintFaces(c, this.moved())) layer(this.moved(), false);
  }
  // Faces in space without WebGL, farther ones first. Of too many only the edges are drawn.
  paintFaces(c, points) {
    const most = 6000;
    if (this.parts.reduce((sum, part) => sum + part.faces.length, 0) > most) return false;
    const count = points.length / 3, seen = new Array(count), onScreen = new Array(count);
    for (let node = 0; node < count; ++node) {
      const point = [points[3 * node], points[3 * node + 1], points[3 * node + 2]];
      seen[node] = this.turned(point.map((x, k) => x - this.box.middle[k]));
      onScreen[node] = this.screen(point);
    }
    const pieces = [];
    this.outward = this.outward || this.parts.map(part => outwardOf(part, this.places));
    this.parts.forEach((part, number) => {
      const side = this.outward[number];
      for (const loop of part.faces)
        if (!side || side * facing(seen, loop) > 0) pieces.push({number, loop, depth: loop.reduce((sum, node) => sum + seen[node][2], 0) / loop.length});
      if (!part.faces.length) for (const loop of this.edges[number].length ? this.edges[number] : Array.from({length: part.count}, (_, i) => [part.first + i]))
        pieces.push({number, loop, depth: loop.reduce((sum, node) => sum + seen[node][2], 0) / loop.length});
    });
    c.lineWidth = 0.7;
    c.lineJoin = 'round';
    for (const {number, loop} of pieces.sort((a, b) => b.depth - a.depth)) {
      const dye = partColours[number % partColours.length];
      const rgb = light => `rgb(${dye.map(v => Math.round(255 * light * (0.25 + 0.75 * v)))})`;
      if (loop.length < 3) {
        c.fillStyle = c.strokeStyle = rgb(1);
        if (loop.length === 1) c.fillRect(onScreen[loop[0]][0] - 4, onScreen[loop[0]][1] - 4, 8, 8);
        else { c.beginPath(); loop.forEach(node => c.lineTo(...onScreen[node])); c.stroke(); }
        continue;
      }
      c.fillStyle = rgb(0.35 + 0.65 * lightOn(seen, loop));
      c.strokeStyle = rgb(0.3);
      c.beginPath();
      loop.forEach(node => c.lineTo(...onScreen[node]));
      c.closePath();
      c.fill();
      c.stroke();
    }
    return true;
  }
  startWebGl() {
    const gl = this.canvas.getContext('webgl2', {antialias: true, preserveDrawingBuffer: true});
    if (!gl) return;
    const shader = (type, text) => {
      const one = gl.createShader(type);
      gl.shaderSource(one, text);
      gl.compileShader(one);
      return one;
    };
    const program = gl.createProgram();
    gl.attachShader(program, shader(gl.VERTEX_SHADER, `#version 300 es
      in vec3 place; in vec3 re; in vec3 im; in vec3 tint;
      uniform mat3 turn; uniform vec3 middle; uniform vec2 factor; uniform vec2 motion; uniform float depth; uniform float nearer;
      out vec3 seen; out vec3 dye;
      void main() {
        vec3 p = turn * (place + motion.x * re + motion.y * im - middle);
        seen = p; dye = tint;
        gl_Position = vec4(p.x * factor.x, p.y * factor.y, -p.z * depth - nearer, 1.0);
        gl_PointSize = 12.0;
      }`));
    gl.attachShader(program, shader(gl.FRAGMENT_SHADER, `#version 300 es
      precision highp float;
      in vec3 seen; in vec3 dye; uniform float flat_; uniform float flat_shade; out vec4 colour;
      void main() {
        if (flat_ > 0.5) { colour = vec4(dye * flat_shade, 1.0); return; }
        vec3 n = normalize(cross(dFdx(seen), dFdy(seen)));
        float light = 0.35 + 0.65 * abs(dot(n, normalize(vec3(0.3, 0.5, 0.8))));
        colour = vec4(mix(vec3(1.0), dye, 0.75) * light, 1.0);
      }`));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) return;
    const triangles = [], edges = [];
    const tints = [];
    this.parts.forEach((part, number) => {
      for (const loop of part.faces) for (let i = 2; i < loop.length; ++i) triangles.push(loop[0], loop[i - 1], loop[i]);
      for (const edge of this.edges[number]) edges.push(...edge);
      for (let node = 0; node < part.count; ++node) tints.push(...partColours[number % partColours.length]);
    });
    this.gl = gl;
    this.canvas.addEventListener('webglcontextlost', () => this.loseWebGl(), {once: true});
    this.program = program;
    this.buffers = {place: gl.createBuffer(), re: gl.createBuffer(), im: gl.createBuffer(), tint: gl.createBuffer(), triangles: gl.createBuffer(), edges: gl.createBuffer()};
    this.counts = {triangles: triangles.length, edges: edges.length};
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers.tint);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(tints), gl.STATIC_DRAW);
    for (const [name, list] of [['triangles', triangles], ['edges', edges]]) {
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.buffers[name]);
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(list), gl.STATIC_DRAW);
    }
  }
  // A browser keeps so many contexts of WebGL, and takes the oldest one for another. Its canvas
  // cannot be drawn on any more.
  loseWebGl() {
    const fresh = this.canvas.cloneNode(false);
    this.canvas.replaceWith(fresh);
    this.over.remove();
    this.gl = null;
    this.canvas = fresh;
    this.listen();
    watchSight(fresh);
    this.draw();
  }
  fill(buffer, values) {
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, buffer);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, new Float32Array(values), this.gl.DYNAMIC_DRAW);
  }
  uploadPlaces() { this.fill(this.buffers.place, this.places); }
  upload() {
    const {buffers, places, motion} = this;
    const none = motion ? null : new Float32Array(places.length);
    this.uploadPlaces();
    this.fill(buffers.re, motion ? motion.subarray(0, places.length) : none);
    this.fill(buffers.im, motion ? motion.subarray(places.length) : none);
  }
  drawWebGl() {
    const {gl, program, buffers} = this;
    const ratio = devicePixelRatio || 1, width = this.canvas.clientWidth || 600, height = this.height;
    this.canvas.style.height = height + 'px';
    const size = [Math.round(width * ratio), Math.round(height * ratio)];
    if (this.canvas.width !== size[0] || this.canvas.height !== size[1]) [this.canvas.width, this.canvas.height] = size;
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    const ground = colour('panel');
    const [r, g, b] = [1, 3, 5].map(i => parseInt(ground.slice(i, i + 2), 16) / 255);
    gl.clearColor(r, g, b, 1);
    gl.enable(gl.DEPTH_TEST);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.useProgram(program);
    for (const name of ['place', 're', 'im', 'tint']) {
      const at = gl.getAttribLocation(program, name);
      if (at < 0) continue;
      gl.bindBuffer(gl.ARRAY_BUFFER, buffers[name]);
      gl.enableVertexAttribArray(at);
      gl.vertexAttribPointer(at, 3, gl.FLOAT, false, 0, 0);
    }
    const columns = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(v => this.turned(v));
    const at = name => gl.getUniformLocation(program, name);
    gl.uniformMatrix3fv(at('turn'), false, new Float32Array(columns.flat().map((v, i) => i % 3 === 2 ? -v : v)));
    gl.uniform3fv(at('middle'), this.box.middle);
    gl.uniform2f(at('factor'), 2 * this.perMetre / width, 2 * this.perMetre / height);
    gl.uniform1f(at('depth'), 0.9 / this.box.extent);
    gl.uniform2f(at('motion'), this.scale * Math.cos(this.phase), -this.scale * Math.sin(this.phase));
    for (const [name, kind, flat] of [['triangles', gl.TRIANGLES, 0], ['edges', gl.LINES, 1]]) {
      if (!this.counts[name] || (name === 'edges' && this.counts.edges > 60000)) continue;
      gl.uniform1f(at('flat_'), flat);
      gl.uniform1f(at('nearer'), 0.003 * flat);  // edges before the faces that they bound
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffers[name]);
      gl.uniform1f(at('flat_shade'), 0.45);
      gl.drawElements(kind, this.counts[name], gl.UNSIGNED_INT, 0);
    }
    // Points alone, as of lumped masses.
    gl.uniform1f(at('flat_'), 1);
    gl.uniform1f(at('flat_shade'), 1);
    gl.uniform1f(at('nearer'), 0);
    this.parts.forEach((part, number) => { if (!this.edges[number].length) gl.drawArrays(gl.POINTS, part.first, part.count); });
  }
}
