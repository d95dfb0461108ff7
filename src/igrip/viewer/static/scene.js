// What is drawn in three dimensions, and the labels over it.
import { Camera } from "./camera.js";
import { Renderer } from "./gl.js";
import { GREY, handName, INK, look, objectName } from "./looks.js";
import { shownScene } from "./store.js";

const GRID = 0.1; // m between two lines
const OUTLINE = 4; // pixels
const HAND = 0.05; // m, diameter of the sphere

export class Scene {
  constructor(gl, labels) {
    this.canvas = gl;
    this.labels = labels;
    this.meshes = new Map();
    this.drawnTargets = []; // ids, and the labels, for tests
    this.drawnLabels = [];
    try {
      this.renderer = new Renderer(gl);
    } catch {
      document.getElementById("no-gl").hidden = false;
      gl.hidden = labels.hidden = true;
    }
    this.camera = new Camera(gl, (moved) => {
      if (moved) this.setFollow(false);
      this.dirty = true;
    });
    this.rays = true;
    this.dirty = true;
    this.last = performance.now();
    new ResizeObserver(() => (this.dirty = true)).observe(gl);
  }

  setFollow(follow) {
    this.camera.follow = follow;
    document.getElementById("follow").checked = follow;
    this.dirty = true;
  }

  refit() {
    this.setFollow(true);
    this.camera.home();
    this.dirty = true;
  }

  frame() {
    const now = performance.now();
    const dt = Math.min((now - this.last) / 1000, 0.1);
    this.last = now;
    if (!this.renderer) return;
    if (this.camera.step(dt)) this.dirty = true;
    if (!this.dirty) return;
    this.dirty = false;
    this.#resize();
    const scene = shownScene();
    if (scene) this.camera.fit(pointsOf(scene));
    const view = this.camera.matrix();
    this.renderer.begin(view);
    this.#drawGrid(scene);
    const labels = [];
    if (scene) {
      this.#drawObjects(scene, labels);
      this.#drawHands(scene, labels);
    }
    this.#drawLabels(view, labels);
    this.drawnLabels = labels;
  }

  #resize() {
    const ratio = Math.min(window.devicePixelRatio || 1, 1.5);
    for (const canvas of [this.canvas, this.labels]) {
      const [w, h] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
      if (w && h && (canvas.width !== w || canvas.height !== h)) Object.assign(canvas, { width: w, height: h });
    }
    this.ratio = ratio;
  }

  #drawGrid(scene) {
    if (!this.grid || (scene && this.gridOf !== scene.objects.length)) {
      this.gridOf = scene?.objects.length;
      const points = scene ? pointsOf(scene) : [];
      const height = Math.min(0, ...points.map((p) => p[2]));
      const low = [0, 1].map((k) => Math.min(-0.3, ...points.map((p) => p[k])));
      const high = [0, 1].map((k) => Math.max(0.3, ...points.map((p) => p[k])));
      const [x, y] = [0, 1].map((k) => Math.round((low[k] + high[k]) / 2 / GRID));
      const reach = Math.ceil((0.65 * Math.max(high[0] - low[0], high[1] - low[1])) / GRID);
      this.grid = [];
      for (let k = -reach; k <= reach; k += 1) {
        this.grid.push((x + k) * GRID, (y - reach) * GRID, height, (x + k) * GRID, (y + reach) * GRID, height);
        this.grid.push((x - reach) * GRID, (y + k) * GRID, height, (x + reach) * GRID, (y + k) * GRID, height);
      }
    }
    this.renderer.drawLines(this.grid, "#c3cad1");
  }

  #drawObjects(scene, labels) {
    const aims = new Map(); // object -> hands
    for (const row of scene.rows) {
      if (row.subject) aims.set(row.subject, [...(aims.get(row.subject) ?? []), handName(row.hand)]);
    }
    this.drawnTargets = [];
    for (const placed of scene.objects) {
      const mesh = this.#mesh(placed.mesh);
      const shown = look(placed.id);
      const aimed = aims.get(placed.id);
      if (mesh) {
        const model = matrixOf(placed.position, placed.orientation);
        const colour = placed.colour ?? shown.colour;
        if (aimed) {
          this.renderer.drawMesh(mesh, model, INK, OUTLINE * this.ratio);
          this.drawnTargets.push(placed.id);
        }
        this.renderer.drawMesh(mesh, model, colour, 0, placed.alpha ?? 1);
      }
      if (placed.label === false) continue;
      labels.push({
        at: placed.top, text: objectName(placed.id), letter: placed.colour ? null : shown.letter, colour: shown.colour,
        note: aimed ? `◀ ${aimed.join(", ")}` : "",
      });
    }
    for (const line of scene.lines ?? []) this.renderer.drawLines(line.points, line.colour);
  }

  #drawHands(scene, labels) {
    const { renderer, camera } = this;
    for (const hand of scene.hands) {
      if (this.rays) {
        renderer.drawLines(hand.misses, GREY, 0.25);
        renderer.drawLines(hand.hits, INK, 0.45);
        renderer.drawPoints(ends(hand.hits), INK, 0.007, camera.zoom);
      }
      renderer.drawPoints(hand.past, "#8a949e", 0.010, camera.zoom);
      renderer.drawPoints(hand.future, INK, 0.016, camera.zoom);
      if (hand.position) {
        renderer.drawPoints(hand.position, INK, HAND, camera.zoom);
        const at = [hand.position[0], hand.position[1], hand.position[2] + 0.03];
        labels.push({ at, text: handName(hand.id), dark: true, note: "" });
      }
    }
  }

  #mesh(number) {
    if (!this.meshes.has(number)) {
      this.meshes.set(number, null);
      fetch(`mesh/${number}`).then((answer) => answer.arrayBuffer()).then((data) => {
        this.meshes.set(number, this.renderer.upload(data));
        this.dirty = true;
      }).catch(() => this.meshes.delete(number));
    }
    return this.meshes.get(number);
  }

  #drawLabels(view, labels) {
    const ctx = this.labels.getContext("2d");
    const { width, height } = this.labels;
    ctx.setTransform(1, 0, 0, 1, 0, 0);
    ctx.clearRect(0, 0, width, height);
    const size = 14 * this.ratio;
    ctx.textBaseline = "middle";
    const taken = [];
    const placed = labels.map((label) => ({ label, at: project(view, label.at) }))
      .filter(({ at }) => at[2] > 0).sort((a, b) => b.at[2] - a.at[2]);
    for (const { label, at } of placed) {
      ctx.font = `600 ${size}px system-ui, sans-serif`;
      const note = label.note ? `  ${label.note}` : "";
      const badge = label.letter ? size * 1.3 : 0;
      const wide = ctx.measureText(label.text + note).width + badge + size;
      const high = size * 1.6;
      const x = Math.min(Math.max((at[0] * 0.5 + 0.5) * width - wide / 2, 2), width - wide - 2);
      let y = Math.min(Math.max((0.5 - at[1] * 0.5) * height - high, high), height - high);
      for (const box of taken) { // labels make room for each other
        if (x < box.x + box.wide && box.x < x + wide && Math.abs(box.y - y) < high) y = box.y - high - 2;
      }
      taken.push({ x, y, wide });
      ctx.fillStyle = label.dark ? INK : "#ffffffe8";
      ctx.strokeStyle = label.note ? INK : "#c3cad1";
      ctx.lineWidth = (label.note ? 2.5 : 1) * this.ratio;
      ctx.beginPath();
      ctx.roundRect(x, y - high / 2, wide, high, label.dark ? high / 2 : 3 * this.ratio);
      ctx.fill();
      ctx.stroke();
      if (label.letter) {
        ctx.fillStyle = label.colour;
        ctx.fillRect(x + 0.2 * size, y - 0.6 * size, 1.2 * size, 1.2 * size);
        ctx.fillStyle = "#fff";
        ctx.fillRect(x + 0.4 * size, y - 0.4 * size, 0.8 * size, 0.8 * size);
        ctx.font = `700 ${0.8 * size}px system-ui, sans-serif`;
        ctx.fillStyle = INK;
        ctx.textAlign = "center";
        ctx.fillText(label.letter, x + 0.8 * size, y + 1);
      }
      ctx.font = `600 ${size}px system-ui, sans-serif`;
      ctx.textAlign = "left";
      ctx.fillStyle = label.dark ? "#fff" : INK;
      ctx.fillText(label.text + note, x + badge + 0.5 * size, y + 1);
    }
  }
}

// The ends of what must be seen: of the objects' cylinders, about, and the hands.
function pointsOf(scene) {
  const points = [];
  for (const { centre: [x, y, z], top, radius } of scene.objects) {
    points.push(top, [2 * x - top[0], 2 * y - top[1], 2 * z - top[2]]);
    const wide = Math.min(radius, 0.06);
    points.push([x - wide, y, z], [x + wide, y, z], [x, y - wide, z], [x, y + wide, z]);
  }
  for (const hand of scene.hands) if (hand.position) points.push(hand.position);
  return points;
}

function matrixOf([x, y, z], [a, b, c, w]) {
  return new Float32Array([
    1 - 2 * (b * b + c * c), 2 * (a * b + c * w), 2 * (a * c - b * w), 0,
    2 * (a * b - c * w), 1 - 2 * (a * a + c * c), 2 * (b * c + a * w), 0,
    2 * (a * c + b * w), 2 * (b * c - a * w), 1 - 2 * (a * a + b * b), 0,
    x, y, z, 1,
  ]);
}

function project(m, [x, y, z]) {
  const at = [0, 1, 3].map((row) => m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row]);
  return [at[0] / at[2], at[1] / at[2], at[2]];
}

function ends(segments) {
  const points = [];
  for (let k = 3; k + 2 < segments.length; k += 6) points.push(segments[k], segments[k + 1], segments[k + 2]);
  return points;
}
