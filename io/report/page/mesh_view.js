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

class MeshView {
  // parts: [{name, first, count, faces: loops, lines: loops}]
  constructor(place, parts, isPlanar) {
    Object.assign(this, {parts, isPlanar, angle: [0.6, 0.5], closeness: 1, amplitude: 1, phase: 0, shift: [0, 0]});
    this.canvas = element('canvas', {tabindex: '0', role: 'img', 'aria-label': 'Bodies displaced by the mode'});
    place.append(this.canvas);
    this.edges = this.uniqueEdges();
    if (!isPlanar && parts.some(part => part.faces.length)) this.startWebGl();
    this.listen();
    redrawn.add(() => this.draw());
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
      else if (turn) { this.angle[0] += 0.1 * turn[0]; this.angle[1] += 0.1 * turn[1]; } else return;
      event.preventDefault();
      this.draw();
    });
  }
  // places: x, y, z of all nodes; motion: real parts of all, then imaginary parts, or null
  show(places, motion) {
    Object.assign(this, {places, motion});
    if (!this.box) this.fit(places);
    if (this.gl) this.upload();
    this.draw();
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
    const x = Math.cos(a) * point[0] + Math.sin(a) * point[1], y = -Math.sin(a) * point[0] + Math.cos(a) * point[1];
    return [x, Math.cos(b) * point[2] + Math.sin(b) * y, Math.cos(b) * y - Math.sin(b) * point[2]];
  }
  draw() {
    if (!this.canvas.isConnected || !this.places) return;
    if (this.gl) this.drawWebGl();
    else this.drawFlat();
  }
  get height() { return this.isPlanar ? 260 : 380; }
  drawFlat() {
    const [c, width, height] = sharp(this.canvas, this.height);
    // Room for displacements of the usual size on all sides.
    const size = (this.isPlanar ? this.box.size : [this.box.extent, this.box.extent]).map(v => 1.04 * v + 0.16 * this.box.extent);
    const factor = this.closeness * Math.min(width / size[0], height / size[1]);
    const project = (points, node) => {
      const p = this.turned([0, 1, 2].map(k => points[3 * node + k] - this.box.middle[k]));
      return [width / 2 + this.shift[0] + factor * p[0], height / 2 + this.shift[1] - factor * p[1]];
    };
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
        c.fillRect(x - 3, y - 3, 6, 6);
      }
    });
    if (this.motion) layer(this.places, true);
    layer(this.moved(), false);
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
        gl_PointSize = 9.0;
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
  upload() {
    const {gl, buffers, places, motion} = this;
    const fill = (buffer, values) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(values), gl.DYNAMIC_DRAW);
    };
    const none = new Float32Array(places.length);
    fill(buffers.place, places);
    fill(buffers.re, motion ? motion.subarray(0, places.length) : none);
    fill(buffers.im, motion ? motion.subarray(places.length) : none);
  }
  drawWebGl() {
    const {gl, program, buffers} = this;
    const ratio = devicePixelRatio || 1, width = this.canvas.clientWidth || 600, height = this.height;
    this.canvas.style.height = height + 'px';
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
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
    const scale = this.closeness * 2 / (Math.min(this.box.extent, 1.1 * Math.max(...this.box.size)) + 0.1 * this.box.extent);
    gl.uniform2f(at('factor'), scale * Math.min(1, height / width), scale * Math.min(1, width / height));
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
