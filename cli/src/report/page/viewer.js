"use strict";
// The 3-D view. A colour that stands for a value is drawn as it is in the legend; only triangles without a value, and the
// tool, are shaded. Shape shows by edges, found between neighbouring samples as in the pictures of `picture/render.rs`.
(() => {
  const element = id => document.getElementById(id);
  const scene = JSON.parse(element("scene").textContent);
  const canvas = element("canvas");
  const gl = scene && canvas.getContext("webgl2", { antialias: false });
  if (!gl) return;

  const SURFACE = `#version 300 es
    in vec3 position; in float value;
    uniform mat3 frame; uniform vec3 centre; uniform vec2 scale; uniform float range;
    out vec3 seen; flat out float shade;
    void main() {
      seen = (position - centre) * frame;
      shade = value;
      gl_Position = vec4(seen.xy * scale, -seen.z / range, 1.0);
    }`;
  const PAINT = `#version 300 es
    precision highp float;
    in vec3 seen; flat in float shade;
    uniform sampler2D ramp; uniform float cut; uniform bool glass; uniform vec3 own;
    layout(location = 0) out vec4 colour; layout(location = 1) out vec4 normal;
    void main() {
      if (seen.z > cut) discard;
      vec3 n = normalize(cross(dFdx(seen), dFdy(seen)));
      n = n.z < 0.0 ? -n : n;
      float bright = 0.72 + 0.28 * max(dot(n, normalize(vec3(-0.4, 0.5, 1.0))), 0.0);
      vec3 plain = glass ? (shade > 0.5 ? vec3(0.84, 0.525, 0.118) : vec3(0.392, 0.463, 0.588)) : own;
      bool valued = !glass && shade > 0.5;
      colour = vec4(valued ? texelFetch(ramp, ivec2(int(shade + 0.5), 0), 0).rgb : plain * bright, 1.0);
      normal = vec4(n * 0.5 + 0.5, 1.0);
    }`;
  // A line per instance, as four corners: from one vertex of a path to the next.
  const LINES = `#version 300 es
    in vec3 start, end; in float way, from, to;
    uniform mat3 frame; uniform vec3 centre; uniform vec2 scale; uniform float range, width;
    out vec2 seen; flat out float kind;
    void main() {
      vec3 a = (start - centre) * frame, b = (end - centre) * frame;
      float share = float(gl_VertexID & 1), side = float(gl_VertexID >> 1) - 0.5;
      vec2 along = b.xy - a.xy;
      along = length(along) > 0.0 ? normalize(along) : vec2(1.0, 0.0);
      vec3 at = mix(a, b, share) + vec3(side * width * vec2(-along.y, along.x), width);
      seen = vec2(at.z, mix(from, to, share));
      kind = way;
      gl_Position = way < 0.5 ? vec4(2.0, 2.0, 2.0, 1.0) : vec4(at.xy * scale, -at.z / range, 1.0);
    }`;
  const DASHES = `#version 300 es
    precision highp float;
    in vec2 seen; flat in float kind;
    uniform float cut, dash; uniform vec3 colours[6];
    layout(location = 0) out vec4 colour;
    void main() {
      int way = int(kind + 0.5) - 1;
      if (seen.x > cut || (way & 1) == 1 && fract(seen.y / dash) > 0.55) discard;
      colour = vec4(colours[way >> 1], 1.0);
    }`;
  const SHEET = `#version 300 es
    void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }`;
  const COMPOSE = `#version 300 es
    precision highp float; precision highp sampler2D;
    uniform sampler2D colours, normals, depths, paneColours, paneNormals, paneDepths;
    uniform float samples; uniform int finer;
    out vec4 shown;
    const vec3 EDGE = vec3(0.133);
    bool edge(sampler2D normals, sampler2D depths, ivec2 at) {
      ivec2 size = textureSize(depths, 0);
      float here = texelFetch(depths, at, 0).r;
      vec3 n = texelFetch(normals, at, 0).xyz * 2.0 - 1.0;
      for (int axis = 0; axis < 2; axis++) {
        ivec2 next = at + ivec2(1 - axis, axis);
        if (next.x >= size.x || next.y >= size.y) continue;
        float there = texelFetch(depths, next, 0).r;
        if (here == 1.0 && there == 1.0) continue;
        if (here == 1.0 || there == 1.0) return true;
        vec3 m = texelFetch(normals, next, 0).xyz * 2.0 - 1.0;
        if (dot(n, m) < 0.82) return true;
        float a = -n[axis] / max(n.z, 0.05), b = -m[axis] / max(m.z, 0.05), step = (here - there) * samples;
        if (step < min(a, b) - 4.0 || step > max(a, b) + 4.0) return true;
      }
      return false;
    }
    void main() {
      vec3 sum = vec3(0.0);
      for (int k = 0; k < finer * finer; k++) {
        ivec2 at = ivec2(gl_FragCoord.xy) * finer + ivec2(k % finer, k / finer);
        float near = texelFetch(depths, at, 0).r, pane = texelFetch(paneDepths, at, 0).r;
        vec3 one = texelFetch(colours, at, 0).rgb;
        if (edge(normals, depths, at)) one = mix(one, EDGE, 0.8);
        if (pane < near) {
          one = mix(one, texelFetch(paneColours, at, 0).rgb, 0.35);
          if (edge(paneNormals, paneDepths, at)) one = mix(one, EDGE, 0.8);
        }
        sum += one;
      }
      shown = vec4(sum / float(finer * finer), 1.0);
    }`;

  function program(vertex, fragment) {
    const made = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(made, shader);
    }
    gl.bindAttribLocation(made, 0, "position");
    gl.bindAttribLocation(made, 1, "value");
    gl.linkProgram(made);
    if (!gl.getProgramParameter(made, gl.LINK_STATUS)) return null;
    const uniforms = {};
    for (let k = gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS); k-- > 0;) {
      const { name } = gl.getActiveUniform(made, k);
      uniforms[name.replace("[0]", "")] = gl.getUniformLocation(made, name);
    }
    return { made, uniforms };
  }
  const surface = program(SURFACE, PAINT), composer = program(SHEET, COMPOSE), liner = program(LINES, DASHES);
  if (!surface || !composer || !liner) return;

  const bytes = text => Uint8Array.from(atob(text), character => character.charCodeAt(0));
  /** Uploads triangles, each with three corners of its own, and a value per corner. */
  function shape(positions, values) {
    const array = gl.createVertexArray(), [corners, shades] = [gl.createBuffer(), gl.createBuffer()];
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, corners);
    gl.bufferData(gl.ARRAY_BUFFER, positions, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, shades);
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(1, 1, gl.UNSIGNED_BYTE, false, 0, 0);
    return { array, shades, count: positions.length / 3 };
  }
  const bodies = scene.bodies.map(body => {
    const rounded = new Uint16Array(bytes(body.vertices).buffer), triangles = new Uint32Array(bytes(body.triangles).buffer);
    const positions = new Float32Array(3 * triangles.length);
    const box = [[0, 1, 2].map(k => body.low[k]), [0, 1, 2].map(k => body.low[k] + 65535 * body.step[k])];
    triangles.forEach((vertex, at) => {
      for (let k = 0; k < 3; k++) positions[3 * at + k] = body.low[k] + rounded[3 * vertex + k] * body.step[k];
    });
    return { ...body, ...shape(positions, new Uint8Array(triangles.length)), box };
  });
  /** Shows a layer's values on its body, or none. */
  function paint(body, layer) {
    const values = new Uint8Array(body.count);
    if (layer) bytes(layer.values).forEach((value, triangle) => values.fill(value, 3 * triangle, 3 * triangle + 3));
    gl.bindBuffer(gl.ARRAY_BUFFER, body.shades);
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
  }
  /** Returns a tool in its own frame: its profile turned about z. */
  function lathe(tool) {
    const SIDES = 64, positions = [], values = [];
    const corner = (d, z, side) => {
      const angle = side * 2 * Math.PI / SIDES;
      return [d * Math.cos(angle), d * Math.sin(angle), z];
    };
    for (const [d, z, e, w, cuts] of tool.lines)
      for (let side = 0; side < SIDES; side++) {
        const [a, b] = [corner(d, z, side), corner(d, z, side + 1)], [p, q] = [corner(e, w, side), corner(e, w, side + 1)];
        positions.push(...a, ...b, ...q, ...a, ...q, ...p);
        for (let k = 0; k < 6; k++) values.push(cuts);
      }
    return { positions, values };
  }
  const tools = scene.tools.map(lathe);
  const pane = shape(new Float32Array(0), new Uint8Array(0));
  /** Places the tool of a finding. */
  function place({ tool, tip, axis }) {
    const { positions, values } = tools[tool], placed = new Float32Array(positions.length);
    const aside = Math.abs(axis[0]) < 0.6 ? [1, 0, 0] : [0, 1, 0];
    const right = unit(cross(axis, aside)), front = cross(axis, right);
    for (let at = 0; at < positions.length; at += 3)
      for (let k = 0; k < 3; k++)
        placed[at + k] = tip[k] + positions[at] * right[k] + positions[at + 1] * front[k] + positions[at + 2] * axis[k];
    Object.assign(pane, shape(placed, new Uint8Array(values)));
  }

  /** Uploads the path of the tools: tips, and the length in rapid traverse up to each, at which dashes begin. */
  function uploadPath({ low, step, vertices, ways: encoded, colours }) {
    const rounded = new Uint16Array(bytes(vertices).buffer), ways = bytes(encoded), tips = new Float32Array(4 * ways.length);
    ways.forEach((way, at) => {
      for (let k = 0; k < 3; k++) tips[4 * at + k] = low[k] + rounded[3 * at + k] * step[k];
      const length = [0, 1, 2].map(k => tips[4 * at + k] - tips[4 * at - 4 + k]);
      tips[4 * at + 3] = way > 0 && way % 2 === 0 ? tips[4 * at - 1] + Math.hypot(...length) : 0;
    });
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const attribute = (name, ...layout) => {
      const place = gl.getAttribLocation(liner.made, name);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, ...layout);
      gl.vertexAttribDivisor(place, 1);
    };
    for (const data of [tips, ways]) {
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
      if (data === ways) attribute("way", 1, gl.UNSIGNED_BYTE, false, 1, 1);
      else [["start", 3, 0], ["end", 3, 16], ["from", 1, 12], ["to", 1, 28]].forEach(([name, size, offset]) => {
        attribute(name, size, gl.FLOAT, false, 16, offset);
      });
    }
    const box = [low, low.map((part, k) => part + 65535 * step[k])];
    return { array, count: ways.length - 1, box, colours: colours.flat().map(part => part / 255) };
  }
  const path = scene.path && uploadPath(scene.path);

  const ramp = gl.createTexture();
  const ramped = Array.from({ length: 256 }, (_, value) => {
    const at = Math.max(value - 1, 0) / 254 * (scene.colours.length - 1), low = Math.min(Math.floor(at), scene.colours.length - 2);
    return [...[0, 1, 2].map(k => Math.round(scene.colours[low][k] + (at - low) * (scene.colours[low + 1][k] - scene.colours[low][k]))), 255];
  });
  gl.bindTexture(gl.TEXTURE_2D, ramp);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(ramped.flat()));
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);

  // Two layers of colour, normal and depth: what is solid, and the tool.
  let layers = [], finer = 2;
  function resize() {
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map(side => Math.max(1, Math.round(side * ratio)));
    if (layers.length && canvas.width === width && canvas.height === height) return;
    [canvas.width, canvas.height] = [width, height];
    finer = width * height > 2e6 ? 1 : 2;
    layers.forEach(layer => [gl.deleteFramebuffer(layer.target), ...layer.textures.map(texture => gl.deleteTexture(texture))]);
    layers = [0, 1].map(() => {
      const target = gl.createFramebuffer();
      gl.bindFramebuffer(gl.FRAMEBUFFER, target);
      const formats = [gl.RGBA8, gl.RGBA8, gl.DEPTH_COMPONENT24];
      const places = [gl.COLOR_ATTACHMENT0, gl.COLOR_ATTACHMENT1, gl.DEPTH_ATTACHMENT];
      const textures = formats.map((format, k) => {
        const texture = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, texture);
        gl.texStorage2D(gl.TEXTURE_2D, 1, format, width * finer, height * finer);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
        gl.framebufferTexture2D(gl.FRAMEBUFFER, places[k], gl.TEXTURE_2D, texture, 0);
        return texture;
      });
      gl.drawBuffers(places.slice(0, 2));
      return { target, textures };
    });
  }

  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const unit = a => a.map(part => part / Math.hypot(...a));
  const state = { centre: [0, 0, 0], yaw: -0.98, pitch: 0.62, extent: 1, cut: Infinity, main: 0, layer: 0, finding: null };
  /** Returns the directions to the right, upward, and toward the eye. */
  function frame({ yaw, pitch }) {
    const toward = [Math.cos(pitch) * Math.cos(yaw), Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch)];
    const right = [-Math.sin(yaw), Math.cos(yaw), 0];
    return [right, cross(toward, right), toward];
  }
  const pixelsPerLength = () => 0.92 * Math.min(canvas.clientWidth, canvas.clientHeight) / state.extent;
  function visible() {
    const main = scene.bodies[state.main];
    return bodies.filter((body, index) => index === state.main || (!main.own_frame && !body.own_frame
      && ((index === 0 && main.fixture) || (body.fixture && switches.get(index).checked))));
  }

  let due = false;
  const redraw = () => { if (!due) { due = true; requestAnimationFrame(draw); } };
  function draw() {
    due = false;
    resize();
    const axes = frame(state), shown = visible(), cut = element("cut").checked ? state.cut : Infinity;
    const drawn = path && !scene.bodies[state.main].own_frame && element("path").checked ? [path] : [];
    const corners = [...shown, ...drawn].flatMap(({ box }) => [0, 1, 2, 3, 4, 5, 6, 7].map(k => [0, 1, 2].map(axis => box[k >> axis & 1][axis])));
    const size = tools.flatMap(tool => tool.positions).reduce((size, part) => Math.max(size, Math.abs(part)), 0);
    const range = 2 * size + 1.01 * Math.max(...corners.map(corner => Math.hypot(...corner.map((part, k) => part - state.centre[k]))));
    const pixels = pixelsPerLength();
    const scale = [2 * pixels / canvas.clientWidth, 2 * pixels / canvas.clientHeight];
    gl.viewport(0, 0, canvas.width * finer, canvas.height * finer);
    gl.enable(gl.DEPTH_TEST);
    // Both programs see the scene through one camera.
    const look = ({ made, uniforms }) => {
      gl.useProgram(made);
      gl.uniformMatrix3fv(uniforms.frame, false, axes.flat());
      gl.uniform3fv(uniforms.centre, state.centre);
      gl.uniform2fv(uniforms.scale, scale);
      gl.uniform1f(uniforms.range, range);
      gl.uniform1f(uniforms.cut, Math.min(cut, 2 * range));
    };
    look(surface);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, ramp);
    gl.uniform1i(surface.uniforms.ramp, 0);
    [shown, state.finding !== null && scene.places[state.finding].tip ? [pane] : []].forEach((shapes, k) => {
      gl.bindFramebuffer(gl.FRAMEBUFFER, layers[k].target);
      gl.clearColor(1, 1, 1, 1);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.uniform1i(surface.uniforms.glass, k);
      for (const { array, count, colour } of shapes) {
        gl.uniform3fv(surface.uniforms.own, colour ? colour.map(part => part / 255) : [0, 0, 0]);
        gl.bindVertexArray(array);
        gl.drawArrays(gl.TRIANGLES, 0, count);
      }
    });
    // Lines on the picture of what is solid leave normals and depths as they are, so that they have no edges.
    for (const { array, count, colours } of drawn) {
      gl.bindFramebuffer(gl.FRAMEBUFFER, layers[0].target);
      gl.drawBuffers([gl.COLOR_ATTACHMENT0, gl.NONE]);
      gl.depthMask(false);
      look(liner);
      gl.uniform1f(liner.uniforms.width, 1.6 / pixels);
      gl.uniform1f(liner.uniforms.dash, 10 / pixels);
      gl.uniform3fv(liner.uniforms.colours, colours);
      gl.bindVertexArray(array);
      gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
      gl.depthMask(true);
      gl.drawBuffers([gl.COLOR_ATTACHMENT0, gl.COLOR_ATTACHMENT1]);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.disable(gl.DEPTH_TEST);
    gl.useProgram(composer.made);
    const textures = layers.flatMap(layer => layer.textures);
    ["colours", "normals", "depths", "paneColours", "paneNormals", "paneDepths"].forEach((name, k) => {
      gl.activeTexture(gl.TEXTURE0 + k);
      gl.bindTexture(gl.TEXTURE_2D, textures[k]);
      gl.uniform1i(composer.uniforms[name], k);
    });
    // The length of the depth range in samples.
    gl.uniform1f(composer.uniforms.samples, 2 * range * pixels * finer * canvas.width / canvas.clientWidth);
    gl.uniform1i(composer.uniforms.finer, finer);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    label(axes, pixels);
  }

  /** Draws the axes and the scale of length over the picture. */
  function label(axes, pixels) {
    const order = [0, 1, 2].sort((one, other) => axes[2][one] - axes[2][other]);
    const lines = order.map(axis => {
      const [x, y] = [axes[0][axis], -axes[1][axis]], colour = ["#b3261e", "#1b7a34", "#1f4fbf"][axis];
      const name = Math.hypot(x, y) > 0.3 ? `<text x="${x * 54}" y="${y * 54}" fill="${colour}">${"xyz"[axis]}</text>` : "";
      return `<path d="M0 0L${x * 40} ${y * 40}" stroke="${colour}" stroke-width="3"/>${name}`;
    });
    element("axes").innerHTML = `<svg viewBox="-65 -65 130 130" font-size="15" text-anchor="middle" dominant-baseline="central"
      stroke-linecap="round">${lines.join("")}</svg>`;
    const room = 0.22 * canvas.clientWidth / pixels, power = 10 ** Math.floor(Math.log10(room));
    const length = [5, 2, 1].map(factor => factor * power).find(length => length <= room);
    element("scale").style.width = `${length * pixels}px`;
    element("scale").firstChild.textContent = `${+length.toPrecision(1)} ${scene.unit}`;
  }

  /** Shows the names and the legend of what is seen. */
  function describe() {
    const layer = scene.layers[state.layer], { finding } = state;
    const row = finding === null ? null : document.querySelector(`[data-finding="${finding}"]`).closest("tr");
    document.querySelectorAll(".current").forEach(old => old.classList.remove("current"));
    row?.classList.add("current");
    const text = row ? `${finding + 1}. line ${row.cells[3].textContent}: ${row.querySelector(".said").textContent}` : "";
    element("heading").textContent = `${scene.title}\n${text}`;
    const ends = layer.ends ?? ["", ""];
    [element("low").textContent, element("high").textContent] = ends;
    element("ramp").style.background = layer.ends ? `linear-gradient(to right, ${scene.colours.map(colour => `rgb(${colour})`)})` : "none";
    element("nothing").textContent = layer.nothing;
    element("nothing").previousElementSibling.style.background = `rgb(${scene.bodies[state.main].colour})`;
    element("layer").value = state.layer;
  }
  function colour(layer) {
    state.layer = layer;
    state.main = scene.layers[layer].body;
    bodies.forEach((body, index) => paint(body, index === state.main ? scene.layers[layer] : null));
  }

  let flight = 0;
  /** Moves the camera, in a third of a second. */
  function fly(goal) {
    const from = { ...state }, start = performance.now(), current = ++flight;
    const turn = ((goal.yaw - from.yaw + Math.PI) % (2 * Math.PI) + 2 * Math.PI) % (2 * Math.PI) - Math.PI;
    state.cut = goal.cut;
    const step = now => {
      if (current !== flight) return;
      const time = Math.min((now - start) / 350, 1), share = time * time * (3 - 2 * time);
      state.centre = from.centre.map((part, k) => part + share * (goal.centre[k] - part));
      state.yaw = from.yaw + share * turn;
      state.pitch = from.pitch + share * (goal.pitch - from.pitch);
      state.extent = from.extent * (goal.extent / from.extent) ** share;
      redraw();
      if (time < 1) requestAnimationFrame(step);
    };
    step(start);
  }
  function whole() {
    const { box } = bodies[state.main], view = { yaw: -0.98, pitch: 0.62 };
    const half = box[1].map((high, k) => (high - box[0][k]) / 2), extents = frame(view).slice(0, 2);
    const extent = 2 * Math.max(...extents.map(axis => dot(axis.map(Math.abs), half)), 1e-9);
    state.finding = null;
    describe();
    fly({ ...view, centre: box[0].map((low, k) => low + half[k]), extent, cut: Infinity });
  }
  function show(finding) {
    const target = scene.places[finding];
    if (!target) return;
    if (target.body !== null && target.body !== state.main) {
      const layer = scene.layers.findIndex(layer => layer.body === target.body);
      if (layer >= 0) colour(layer);
      state.main = target.body;
    }
    state.finding = finding;
    if (target.tip) place(target);
    describe();
    const program = document.querySelector(`#finding-${finding + 1} details`);
    if (program) program.open = true;
    const [x, y, z] = target.toward;
    fly({ centre: target.target, yaw: Math.atan2(y, x), pitch: Math.asin(z), extent: target.extent, cut: target.cut });
  }

  const pointers = new Map();
  const move = (x, y) => {
    const [right, up] = frame(state), pixels = pixelsPerLength();
    state.centre = state.centre.map((part, k) => part - (x * right[k] - y * up[k]) / pixels);
  };
  const turn = (x, y) => {
    state.yaw -= x;
    state.pitch = Math.max(-1.55, Math.min(1.55, state.pitch + y));
  };
  const zoom = factor => { state.extent = Math.max(state.extent * factor, 1e-9); };
  canvas.addEventListener("pointerdown", event => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, event);
    flight++;
  });
  canvas.addEventListener("pointermove", event => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const [x, y] = [event.clientX - before.clientX, event.clientY - before.clientY];
    const other = [...pointers.values()].find(pointer => pointer.pointerId !== event.pointerId);
    if (other) {
      const distance = pointer => Math.hypot(pointer.clientX - other.clientX, pointer.clientY - other.clientY);
      move(x / 2, y / 2);
      zoom(Math.max(distance(before), 1) / Math.max(distance(event), 1));
    } else if (event.shiftKey || event.buttons & 6) move(x, y);
    else turn(x / 150, y / 150);
    pointers.set(event.pointerId, event);
    redraw();
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, event => pointers.delete(event.pointerId));
  canvas.addEventListener("contextmenu", event => event.preventDefault());
  canvas.addEventListener("wheel", event => {
    // The wheel scrolls the page until the view is in use.
    if (document.activeElement !== canvas) return;
    event.preventDefault();
    flight++;
    zoom(Math.exp(Math.sign(event.deltaY) * Math.min(Math.abs(event.deltaY), 100) * 0.0016));
    redraw();
  }, { passive: false });
  canvas.addEventListener("keydown", event => {
    const act = {
      ArrowLeft: () => turn(0.1, 0), ArrowRight: () => turn(-0.1, 0), ArrowUp: () => turn(0, -0.1), ArrowDown: () => turn(0, 0.1),
      "+": () => zoom(0.85), "-": () => zoom(1 / 0.85),
    }[event.key];
    if (!act) return;
    event.preventDefault();
    act();
    redraw();
  });

  /** Adds a colour and its name to a legend. */
  function explain(legend, colour, name, kind) {
    const [entry, swatch] = [kind, "span"].map(name => document.createElement(name));
    swatch.className = "swatch";
    swatch.style.background = `rgb(${colour})`;
    entry.append(swatch, name);
    element(legend).append(entry);
    return entry;
  }
  // A switch with the colour and the name of each fixture.
  const switches = new Map(scene.bodies.map((body, index) => [index, body]).filter(([, body]) => body.fixture).map(([index, body]) => {
    const box = Object.assign(document.createElement("input"), { type: "checkbox", checked: true });
    explain("bodies", body.colour, body.name, "label").prepend(box);
    box.addEventListener("change", redraw);
    return [index, box];
  }));
  scene.path?.tools.forEach(tool => explain("paths", scene.path.colours[tool.colour], tool.name, "span"));
  const select = element("layer");
  scene.layers.forEach((layer, index) => select.add(new Option(layer.quantity, index)));
  select.addEventListener("change", () => {
    const body = state.main;
    colour(+select.value);
    if (state.main === body) { describe(); redraw(); } else whole();
  });
  element("whole").addEventListener("click", whole);
  for (const id of ["cut", "path"]) element(id).addEventListener("change", redraw);
  document.querySelectorAll("button.show").forEach(button => button.addEventListener("click", () => {
    show(+button.dataset.finding);
    element("view").scrollIntoView();
  }));
  const linked = () => { const [, number] = location.hash.match(/^#finding-(\d+)$/) ?? []; if (number) show(number - 1); };
  window.addEventListener("hashchange", linked);
  canvas.addEventListener("webglcontextlost", () => document.documentElement.classList.remove("live"));

  document.documentElement.classList.add("live");
  new ResizeObserver(redraw).observe(canvas);
  colour(0);
  whole();
  linked();
})();
