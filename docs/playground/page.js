// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Draws what the core says, and tells it where the object is. No number is computed here that the
// page shows as measured or true.

const $ = (id) => document.getElementById(id);

// ---- the core -----------------------------------------------------------------------------------

/** A module of one function with a vector instruction: valid where there are vectors. */
const VECTOR_PROBE = new Uint8Array([
  0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15,
  253, 98, 11,
]);
const KIND = WebAssembly.validate(VECTOR_PROBE) ? "vectors" : "plain";

const compiled = {};
function compile(kind) {
  const text = atob($(`${kind}-core`).textContent);
  return WebAssembly.compile(Uint8Array.from(text, (c) => c.charCodeAt(0)));
}

/** An instance with memory of its own; a refused parameter ends it. */
async function newCore(kind = KIND) {
  const module = await (compiled[kind] ??= compile(kind));
  const imports = {};
  for (const { module: from, name } of WebAssembly.Module.imports(module)) {
    (imports[from] ??= {})[name] = () => 0; // files and growth, of which nothing is needed
  }
  const { exports: core } = await WebAssembly.instantiate(module, imports);
  core._initialize?.();
  const array = (Type) => (at, count) => new Type(core.memory.buffer, at, count);
  return {
    ...core,
    bytes: array(Uint8Array),
    floats: array(Float32Array),
    doubles: array(Float64Array),
    text(at) {
      const all = new Uint8Array(core.memory.buffer, at);
      return new TextDecoder().decode(all.slice(0, all.indexOf(0)));
    },
  };
}

function namedNumbers(names, values) {
  return Object.fromEntries(names.map((name, k) => [name, values[k]]));
}

// ---- drawing ------------------------------------------------------------------------------------

const clamp = (x, low, high) => Math.min(Math.max(x, low), high);

/** With this many digits; no number is a dash, and no zero is negative. */
function shown(x, digits) {
  if (!Number.isFinite(x)) return "–";
  const text = x.toFixed(digits).replace("-", "−");
  return Number(x.toFixed(digits)) === 0 ? text.replace("−", "") : text;
}

const RIM_MM = 18.735;
const PITCH_MM = 0.152;
const BALL_MM = 20;
const DEEPEST_MM = 12;
const WINDOW_S = 8;

let colour = {};
const darkScheme = matchMedia("(prefers-color-scheme: dark)");
function readColours() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ["card", "ink", "soft", "rule", "pad", "object", "stick", "slip", "free", "edge", "force"]) {
    colour[name] = style.getPropertyValue(`--${name}`).trim();
  }
}

/** Sizes a canvas to the screen's pixels; draws in CSS pixels. */
function pen(canvas) {
  const ratio = devicePixelRatio || 1;
  const { clientWidth: width, clientHeight: height } = canvas;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const g = canvas.getContext("2d");
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.clearRect(0, 0, width, height);
  g.lineJoin = "round";
  return { g, width, height };
}

const opaque = (red, green, blue) => ((255 << 24) | (blue << 16) | (green << 8) | red) >>> 0;

/** 256 colours from dark violet over green to yellow (viridis), as canvases hold them. */
const DEPTH_COLOURS = Uint32Array.from({ length: 256 }, (_, k) => {
  const stops = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
  const at = (k / 255) * (stops.length - 1);
  const from = Math.min(Math.floor(at), stops.length - 2);
  return opaque(...stops[from].map((low, c) => low + (at - from) * (stops[from + 1][c] - low)));
});
const WHITE = opaque(255, 255, 255);
const BLACK = opaque(0, 0, 0);

const images = new Map();
/** Of a canvas, to be filled and shown again and again: a canvas that is sized anew costs more. */
function imageOf(canvas, cols, rows) {
  let image = images.get(canvas);
  if (image?.width !== cols || image.height !== rows) {
    canvas.width = cols;
    canvas.height = rows;
    images.set(canvas, (image = new ImageData(cols, rows)));
  }
  return image;
}

/** The depth in colours, and the edge of the contact in white. */
function drawDepth(canvas, depth, touching, cols, rows, deepest) {
  const image = imageOf(canvas, cols, rows);
  const pixels = new Uint32Array(image.data.buffer);
  for (let k = 0; k < depth.length; ++k) {
    const inside = touching[k] !== 0;
    const edge = inside && !(touching[k - 1] && touching[k + 1] && touching[k - cols] && touching[k + cols]);
    const z = depth[k];
    pixels[k] = edge ? WHITE : z === z ? DEPTH_COLOURS[clamp((255 * z) / deepest, 0, 255) | 0] : BLACK;
  }
  canvas.getContext("2d").putImageData(image, 0, 0);
}

function arrow(g, x, y, dx, dy, width) {
  const length = Math.hypot(dx, dy);
  if (length < 3) return;
  const head = Math.min(4 * width, 0.6 * length);
  const [ux, uy] = [dx / length, dy / length];
  const [bx, by] = [x + dx - head * ux, y + dy - head * uy];
  g.lineWidth = width;
  g.beginPath();
  g.moveTo(x, y);
  g.lineTo(bx, by);
  g.stroke();
  g.beginPath();
  g.moveTo(x + dx, y + dy);
  g.lineTo(bx - 0.55 * head * uy, by + 0.55 * head * ux);
  g.lineTo(bx + 0.55 * head * uy, by - 0.55 * head * ux);
  g.fill();
}

/** The plate's or the ball's outline from above. */
function objectPath(g, object, mm) {
  g.beginPath();
  if (object.ball) {
    g.arc(0, 0, 8 * mm, 0, 2 * Math.PI);
  } else {
    g.roundRect(-11 * mm, -11 * mm, 22 * mm, 22 * mm, 2 * mm);
  }
}

function drawPad(state) {
  const { g, width, height } = pen($("pad"));
  const mm = Math.min(width, height) / (2 * RIM_MM + 5);
  const { object, numbers, dots } = state;
  g.translate(width / 2, height / 2);
  g.fillStyle = colour.pad;
  g.strokeStyle = colour.soft;
  g.lineWidth = 2;
  g.beginPath();
  g.arc(0, 0, RIM_MM * mm, 0, 2 * Math.PI);
  g.fill();
  g.stroke();

  g.save();
  g.translate(object.x * mm, object.y * mm);
  g.rotate(object.turn);
  objectPath(g, object, mm);
  g.fillStyle = g.strokeStyle = colour.object;
  g.globalAlpha = object.press > 0 ? 0.22 : 0.08;
  g.fill();
  g.globalAlpha = object.press > 0 ? 0.9 : 0.5;
  g.lineWidth = 2;
  if (!(object.press > 0)) g.setLineDash([6, 5]);
  g.stroke();
  g.beginPath(); // which way it is turned
  g.moveTo(0, (object.ball ? -6.6 : -9.6) * mm);
  g.lineTo(0, (object.ball ? -7.9 : -10.9) * mm);
  g.lineWidth = 4;
  g.setLineDash([]);
  g.stroke();
  g.restore();

  drawEdge(g, state, mm);
  for (let k = 0; k < dots.length; k += 5) {
    const [x, y, , touches, doing] = dots.subarray(k, k + 5);
    if (!Number.isFinite(x)) continue;
    const sticks = touches && doing === 3, slips = touches && doing === 2;
    g.beginPath();
    g.arc(x * mm, y * mm, (touches ? 0.42 : 0.27) * mm, 0, 2 * Math.PI);
    g.fillStyle = sticks ? colour.stick : touches ? colour.soft : colour.free;
    if (slips) {
      g.strokeStyle = colour.slip;
      g.lineWidth = 0.24 * mm;
      g.stroke();
    } else {
      g.fill();
    }
  }

  if (object.press > 0 && Number.isFinite(numbers.force_x_n)) {
    g.strokeStyle = g.fillStyle = colour.force;
    const at = [numbers.middle_x_mm || 0, numbers.middle_y_mm || 0];
    const scale = 12 * mm; // px per N
    arrow(g, at[0] * mm, at[1] * mm, numbers.force_x_n * scale, numbers.force_y_n * scale, 0.55 * mm);
    const turn = clamp(numbers.moment_z_n_mm / 3, -1.4, 1.4);
    if (Math.abs(turn) > 0.05) {
      const radius = 14.6 * mm;
      const [from, to] = [-Math.PI / 2, -Math.PI / 2 + turn];
      g.lineWidth = 0.45 * mm;
      g.beginPath();
      g.arc(0, 0, radius, from, to, turn < 0);
      g.stroke();
      const way = Math.sign(turn) * 1.2 * mm;
      arrow(g, radius * Math.cos(to), radius * Math.sin(to), -way * Math.sin(to), way * Math.cos(to), 0.45 * mm);
    }
  }
}

/** The outermost pixels of the measured contact, where the film is. */
function drawEdge(g, { edge }, mm) {
  g.fillStyle = colour.edge;
  for (let k = 0; k < edge.length; k += 2) {
    g.fillRect(edge[k] * mm - 1, edge[k + 1] * mm - 1, 2, 2);
  }
}

function drawCamera(canvas, bytes, size) {
  const image = imageOf(canvas, size, size);
  image.data.set(bytes);
  canvas.getContext("2d").putImageData(image, 0, 0);
}

function drawSection({ object, section, numbers }) {
  const { g, width, height } = pen($("section"));
  const mm = Math.min(width / 44, height / 17);
  const x = (at) => width / 2 + at * mm;
  const z = (at) => height - 14 - at * mm;
  g.fillStyle = colour.rule;
  g.fillRect(x(-20.5), z(0), 41 * mm, 8);
  const line = (column, style, thick, dash) => {
    g.strokeStyle = style;
    g.lineWidth = thick;
    g.setLineDash(dash);
    g.beginPath();
    let drawing = false;
    for (let k = 0; k < section.length; k += 3) {
      const [at, high] = [section[k], section[k + column]];
      if (!Number.isFinite(high) || !Number.isFinite(at)) {
        drawing = false;
        continue;
      }
      drawing ? g.lineTo(x(at), z(high)) : g.moveTo(x(at), z(high));
      drawing = true;
    }
    g.stroke();
    g.setLineDash([]);
  };
  const low = numbers.free_top_mm + (object.press > 0 ? -object.press : 1.2);
  g.fillStyle = colour.object;
  g.globalAlpha = 0.25;
  g.beginPath();
  if (object.ball) {
    g.arc(x(numbers.dent_x_mm), z(low + BALL_MM), BALL_MM * mm, 0, 2 * Math.PI);
  } else {
    g.rect(x(clamp(object.x, -9, 9) - 11), z(low + 2.2), 22 * mm, 2.2 * mm);
  }
  g.fill();
  g.globalAlpha = 1;
  line(1, colour.stick, 4, []);
  line(2, colour.ink, 1.2, [6, 5]);
}

function drawChart(history, now) {
  const { g, width, height } = pen($("chart"));
  const left = 30, right = width - 6, top = 8, bottom = height - 18;
  const x = (t) => right - ((now - t) / WINDOW_S) * (right - left);
  const y = (ratio) => bottom - ratio * (bottom - top);
  g.font = "12px system-ui, sans-serif";
  g.fillStyle = colour.soft;
  g.strokeStyle = colour.rule;
  g.lineWidth = 1;
  g.textAlign = "right";
  g.textBaseline = "middle";
  for (const ratio of [0, 0.5, 1]) {
    g.beginPath();
    g.moveTo(left, y(ratio));
    g.lineTo(right, y(ratio));
    g.stroke();
    g.fillText(ratio, left - 6, y(ratio));
  }
  g.textBaseline = "alphabetic";
  for (let back = 0; back < WINDOW_S; back += 2) {
    g.fillText(back ? `−${back} s` : "now", x(now - back), height - 3);
  }
  const line = (key, style, thick, dash) => {
    g.strokeStyle = style;
    g.lineWidth = thick;
    g.setLineDash(dash);
    g.beginPath();
    let drawing = false;
    for (const point of history) {
      if (!Number.isFinite(point[key])) {
        drawing = false;
        continue;
      }
      drawing ? g.lineTo(x(point.t), y(point[key])) : g.moveTo(x(point.t), y(point[key]));
      drawing = true;
    }
    g.stroke();
    g.setLineDash([]);
  };
  line("measured", colour.stick, 3, []);
  line("truth", colour.ink, 1.2, [6, 5]);
}

const ROWS = [
  ["Press", "press_mm", "true_press_mm", "mm", 2],
  ["Contact area", "contact_mm2", "true_contact_mm2", "mm²", 0],
  ["Turn since touch", "turn_deg", "true_turn_deg", "°", 1],
  ["Stick ratio", "stick_ratio", "true_stick_ratio", "", 2],
  ["Force along x", "force_x_n", "true_force_x_n", "N", 2],
  ["Force along y", "force_y_n", "true_force_y_n", "N", 2],
  ["Force along z", "force_z_n", "true_force_z_n", "N", 2],
  ["Moment about z", "moment_z_n_mm", "true_moment_z_n_mm", "N mm", 2],
  ["Mean depth error", "depth_error_mm", null, "mm", 3],
];
const cells = ROWS.map(([label, , , unit]) => {
  const row = $("numbers").insertRow();
  const head = document.createElement("th");
  head.scope = "row";
  head.textContent = label;
  row.append(head);
  const pair = [row.insertCell(), row.insertCell()];
  row.insertCell().textContent = unit;
  return pair;
});
const STATUS = ["Every stage has an answer.", "A stage has no answer in this frame.", "Nothing touches the pad.", "Refused."];
function writeNumbers(numbers) {
  ROWS.forEach(([, measured, truth, , digits], k) => {
    cells[k][0].textContent = shown(numbers[measured], digits);
    cells[k][1].textContent = truth ? shown(numbers[truth], digits) : "0";
  });
  $("status").textContent = STATUS[numbers.status];
}

// ---- what the user does -------------------------------------------------------------------------

const object = { ball: false, x: 0, y: 0, turn: 0, press: 0 };
const wanted = { x: 0, y: 0, turn: 0, pressed: false };
const demo = { since: null };
const still = matchMedia("(prefers-reduced-motion: reduce)");
const FARTHEST_MM = 8;

function setPressed(pressed) {
  wanted.pressed = pressed;
  $("press").setAttribute("aria-pressed", pressed);
  $("press").textContent = pressed ? "Lift" : "Press";
}
function setDemo(on, now = performance.now() / 1000) {
  demo.since = on ? now : null;
  $("demo").setAttribute("aria-pressed", on);
  $("demo").textContent = on ? "Stop demo" : "Play demo";
  if (on) setPressed(false);
}
function setTurn(degrees) {
  const slider = $("turn");
  slider.value = clamp(degrees, slider.min, slider.max);
  wanted.turn = (slider.valueAsNumber * Math.PI) / 180;
  writeSliders();
}
function setDepth(mm) {
  $("depth").value = mm;
  writeSliders();
}
function drag(dx, dy) {
  setDemo(false);
  wanted.x = clamp(wanted.x + dx, -FARTHEST_MM, FARTHEST_MM);
  wanted.y = clamp(wanted.y + dy, -FARTHEST_MM, FARTHEST_MM);
}
function writeSliders() {
  const write = (id, digits, unit) => {
    const text = `${$(id).valueAsNumber.toFixed(digits)}${unit}`;
    $(`${id}-value`).textContent = text;
    $(id).setAttribute("aria-valuetext", text);
  };
  write("depth", 1, " mm");
  write("turn", 1, "°");
  write("friction", 2, "");
  write("noise", 1, " levels");
}

function listen() {
  const pad = $("pad");
  let last = null;
  const toMm = (px) => (px * (2 * RIM_MM + 5)) / Math.min(pad.clientWidth, pad.clientHeight);
  pad.addEventListener("pointerdown", (event) => {
    pad.setPointerCapture(event.pointerId);
    last = event;
    setDemo(false);
    setPressed(true);
  });
  pad.addEventListener("pointermove", (event) => {
    if (!last) return;
    drag(toMm(event.clientX - last.clientX), toMm(event.clientY - last.clientY));
    last = event;
  });
  for (const end of ["pointerup", "pointercancel"]) {
    pad.addEventListener(end, () => (last = null));
  }
  pad.addEventListener("wheel", (event) => {
    event.preventDefault();
    setDemo(false);
    setTurn($("turn").valueAsNumber + Math.sign(event.deltaY));
  }, { passive: false });
  const keys = {
    ArrowLeft: () => drag(-0.2, 0), ArrowRight: () => drag(0.2, 0),
    ArrowUp: () => drag(0, -0.2), ArrowDown: () => drag(0, 0.2),
    "[": () => setTurn($("turn").valueAsNumber - 1), "]": () => setTurn($("turn").valueAsNumber + 1),
    "+": () => setDepth($("depth").valueAsNumber + 0.2), "=": () => setDepth($("depth").valueAsNumber + 0.2),
    "-": () => setDepth($("depth").valueAsNumber - 0.2),
    " ": () => setPressed(!wanted.pressed),
  };
  pad.addEventListener("keydown", (event) => {
    if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    setDemo(false);
    keys[event.key]();
  });
  $("press").addEventListener("click", () => {
    setDemo(false);
    setPressed(!wanted.pressed);
  });
  $("demo").addEventListener("click", () => setDemo(demo.since === null));
  $("controls").addEventListener("input", (event) => {
    if (event.target.id !== "noise" && event.target.id !== "friction") setDemo(false);
    if (event.target.name === "object") {
      setPressed(false);
    }
    setTurn($("turn").valueAsNumber);
  });
  $("controls").addEventListener("submit", (event) => event.preventDefault());
  darkScheme.addEventListener("change", readColours);
}

/** Moves the object toward where it is wanted, no faster than a hand. */
function follow(dt) {
  const toward = (from, to, speed) => from + clamp(to - from, -speed * dt, speed * dt);
  const ball = document.querySelector("[name=object]:checked").value === "ball";
  if (ball !== object.ball && object.press > 0) {
    object.press = toward(object.press, 0, 12); // lifted before it is exchanged
    return;
  }
  object.ball = ball;
  object.press = toward(object.press, wanted.pressed ? $("depth").valueAsNumber : 0, 8);
  if (!(object.press > 0) && !wanted.pressed) {
    wanted.x = wanted.y = 0; // the next press begins at the top
  }
  object.x = toward(object.x, wanted.x, 15);
  object.y = toward(object.y, wanted.y, 15);
  object.turn = toward(object.turn, wanted.turn, 0.8);
}

/** Tells a screen reader what has changed, not each frame. */
const speech = { said: "", at: 0 };
function speak(numbers, now) {
  const touches = numbers.contact_mm2 > 0;
  const text = touches
    ? `${object.ball ? "Ball" : "Plate"} pressed ${shown(numbers.press_mm, 1)} millimetres, contact ` +
      `${shown(numbers.contact_mm2 / 10, 0)}0 square millimetres, stick ratio ${shown(numbers.stick_ratio, 1)}.`
    : "Nothing touches the pad.";
  if (text !== speech.said && now - speech.at > 2 && demo.since === null) {
    speech.said = $("live").textContent = text;
    speech.at = now;
  }
}

// ---- one frame after another --------------------------------------------------------------------

const DEMO_S = 8;

async function run() {
  const core = await newCore();
  core.pad_start();
  const size = core.pad_size_px();
  const names = core.text(core.pad_names()).split(",");
  const history = [];
  const speed = { frames: 0, busy: 0, since: performance.now() };
  let last = performance.now() / 1000;
  let restAt = 0;
  let writtenAt = 0;
  let freePicture = null;

  const read = () => {
    const pixels = size * size;
    return {
      numbers: namedNumbers(names, core.doubles(core.pad_numbers(), names.length)),
      image: core.bytes(core.pad_image(), 4 * pixels),
      depth: core.floats(core.pad_depth_mm(), pixels),
      touching: core.bytes(core.pad_touching(), pixels),
      dots: core.floats(core.pad_dots(), 5 * core.pad_dots_across() ** 2),
      edge: core.floats(core.pad_edge(), 2 * core.pad_edge_count()),
      section: core.floats(core.pad_section(), 3 * size),
      object,
    };
  };

  const step = (milliseconds) => {
    requestAnimationFrame(step);
    const now = milliseconds / 1000;
    const dt = clamp(now - last, 0, 0.1);
    last = now;
    const before = JSON.stringify(object);
    if (demo.since !== null) {
      const at = now - demo.since;
      if (at > DEMO_S) setDemo(true, now);
    } else {
      follow(dt);
    }
    const rests = before === JSON.stringify(object) && demo.since === null;
    restAt = rests ? restAt + 1 : 0;
    if (still.matches && restAt > 30) return; // a still picture for those who want none that flickers

    const from = performance.now();
    if (demo.since !== null) {
      core.pad_demo_frame(clamp(now - demo.since, 0, DEMO_S), object.ball, $("noise").valueAsNumber);
    } else {
      core.pad_frame(object.ball, object.x, object.y, object.turn, object.press,
        $("friction").valueAsNumber, $("noise").valueAsNumber, now);
    }
    speed.busy += performance.now() - from;
    const state = read();
    if (demo.since !== null) followDemo(state.numbers);
    freePicture ??= new Uint8ClampedArray(state.image);
    history.push({ t: now, measured: state.numbers.stick_ratio, truth: state.numbers.true_stick_ratio });
    while (history[0].t < now - WINDOW_S) history.shift();
    drawPad(state);
    drawCamera($("camera"), state.image, size);
    drawDepth($("depth-map"), state.depth, state.touching, size, size, DEEPEST_MM);
    drawSection(state);
    drawChart(history, now);
    if (now - writtenAt > 0.1) { // nobody reads faster
      writtenAt = now;
      writeNumbers(state.numbers);
      speak(state.numbers, now);
    }
    ++speed.frames;
    ++window.playground.frames;
    if (performance.now() - speed.since > 1000) {
      const seconds = (performance.now() - speed.since) / 1000;
      window.playground.fps = speed.frames / seconds;
      window.playground.busyMs = speed.busy / speed.frames;
      $("speed").textContent = `${shown(window.playground.fps, 0)} frames/s, ${shown(window.playground.busyMs, 1)} ms each, ` +
        (KIND === "vectors" ? "with vectors" : "without vectors");
      Object.assign(speed, { frames: 0, busy: 0, since: performance.now() });
    }
  };

  Object.assign(window.playground, { kind: KIND, newCore, object, read, names });
  $("borrow").addEventListener("click", () => borrow(freePicture, read(), size));
  readColours();
  writeSliders();
  listen();
  setDemo(!still.matches);
  requestAnimationFrame(step);
}

/** The object is where the demo has it. */
function followDemo(numbers) {
  Object.assign(object, { x: numbers.object_x_mm, y: numbers.object_y_mm, turn: numbers.object_turn_rad, press: numbers.object_press_mm });
  Object.assign(wanted, { x: 0, y: 0 });
}

// ---- one's own pictures -------------------------------------------------------------------------

const own = { free: null, pressed: null };

async function pictureOf(file) {
  const bitmap = await createImageBitmap(file, { colorSpaceConversion: "none", premultiplyAlpha: "none" });
  const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
  const g = canvas.getContext("2d");
  g.drawImage(bitmap, 0, 0);
  return g.getImageData(0, 0, bitmap.width, bitmap.height);
}
function showPicture(which) {
  const canvas = $(`own-${which}`);
  canvas.width = own[which].width;
  canvas.height = own[which].height;
  canvas.getContext("2d").putImageData(own[which], 0, 0);
  $("own-views").hidden = false;
}
async function take(which, file) {
  try {
    own[which] = await pictureOf(file);
    showPicture(which);
    if (own.free && own.pressed) await measureOwn();
    else $("own-message").textContent = `Now the ${own.free ? "pressed" : "free"} pad.`;
  } catch {
    $("own-message").textContent = `${file.name} is no picture that this browser reads.`;
  }
}
function borrow(free, { image, numbers }, size) {
  own.free = new ImageData(free, size, size);
  own.pressed = new ImageData(new Uint8ClampedArray(image), size, size);
  $("pitch").value = PITCH_MM;
  $("radius").value = RIM_MM;
  $("height").value = numbers.free_top_mm.toFixed(3);
  showPicture("free");
  showPicture("pressed");
  return measureOwn();
}

async function measureOwn() {
  const { free, pressed } = own;
  const say = (text) => ($("own-message").textContent = text);
  if (!free || !pressed) return say("Two pictures are needed: the free pad and the pressed one.");
  if (free.width !== pressed.width || free.height !== pressed.height) {
    return say("The two pictures differ in size.");
  }
  const { width, height } = free;
  const core = await newCore();
  try {
    core.own_start(height, width);
    core.bytes(core.own_free_image(), 4 * width * height).set(free.data);
    core.bytes(core.own_pressed_image(), 4 * width * height).set(pressed.data);
    core.own_measure($("pitch").valueAsNumber, $("radius").valueAsNumber, $("height").valueAsNumber);
  } catch {
    drawDepth($("own-depth"), new Float32Array([NaN]), new Uint8Array(1), 1, 1, 1);
    return say(`Refused. ${core.text(core.refusal_text())}`);
  }
  const names = core.text(core.own_names()).split(",");
  const numbers = namedNumbers(names, core.doubles(core.own_numbers(), names.length));
  const deepest = Math.ceil($("height").valueAsNumber);
  $("own-deepest").textContent = `${deepest} mm`;
  drawDepth($("own-depth"), core.floats(core.own_depth_mm(), width * height),
    core.bytes(core.own_touching(), width * height), width, height, deepest);
  window.playground.own = numbers;
  const found = numbers.contact_mm2 > 0
    ? `Contact ${shown(numbers.contact_mm2, 0)} mm², pressed ${shown(numbers.press_mm, 2)} mm`
    : "Nothing touches the pad";
  say(`${found}; depth known at ${shown(100 * numbers.share_with_depth, 0)} % of the pad.`);
}

function listenForPictures() {
  for (const which of ["free", "pressed"]) {
    $(`${which}-file`).addEventListener("change", (event) => {
      if (event.target.files[0]) take(which, event.target.files[0]);
    });
  }
  $("measure").addEventListener("click", measureOwn);
  const drop = $("drop");
  drop.addEventListener("dragover", (event) => {
    event.preventDefault();
    drop.classList.add("over");
  });
  drop.addEventListener("dragleave", () => drop.classList.remove("over"));
  drop.addEventListener("drop", async (event) => {
    event.preventDefault();
    drop.classList.remove("over");
    const files = [...event.dataTransfer.files].slice(0, 2);
    // the free pad is the one whose name says so; else the first that is dropped
    files.sort((a, b) => /free|ref/i.test(b.name) - /free|ref/i.test(a.name));
    const places = files.length === 2 || !own.free ? ["free", "pressed"] : ["pressed"];
    for (const [k, file] of files.entries()) await take(places[k], file);
  });
}

window.playground = { frames: 0 };
listenForPictures();
run();
