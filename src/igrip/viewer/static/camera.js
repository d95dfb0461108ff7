// The camera: it turns around a point, fits what there is, and follows it until a person takes over.
const FIELD = (40 * Math.PI) / 180;
const HOME = { azimuth: -2.25, elevation: 0.52 }; // from behind the person, who sits at negative y
const MARGIN = 1.25; // room for labels

export class Camera {
  constructor(canvas, onChange) {
    this.canvas = canvas;
    this.onChange = onChange;
    this.follow = true;
    this.home();
    this.#listen();
  }

  home() {
    Object.assign(this, HOME, { centre: [0, 0.2, 0.1], distance: 1.2, goal: null, placed: false });
  }

  // Fit points: at once the first time, then smoothly and not for trifles.
  fit(points) {
    if (!points.length) return;
    const low = [0, 1, 2].map((k) => Math.min(...points.map((p) => p[k])));
    const high = [0, 1, 2].map((k) => Math.max(...points.map((p) => p[k])));
    const centre = low.map((v, k) => (v + high[k]) / 2);
    const distance = MARGIN * this.#distanceFor(points, centre);
    if (!this.placed) {
      Object.assign(this, { centre, distance, goal: null, placed: true });
    } else if (this.follow) {
      const target = this.goal ?? this;
      const moved = Math.hypot(...centre.map((c, k) => c - target.centre[k]));
      const ratio = distance / target.distance;
      if (moved > 0.08 * distance || ratio > 1.08 || ratio < 0.8) this.goal = { centre, distance };
    }
  }

  // The distance from which all points lie within the picture.
  #distanceFor(points, centre) {
    const { forward, right, up } = this.#axes();
    const aspect = this.canvas.width / Math.max(1, this.canvas.height);
    let distance = 0.3;
    for (const p of points) {
      const d = p.map((v, k) => v - centre[k]);
      const wide = Math.abs(dot(d, right)) * (this.zoom / aspect);
      const high = Math.abs(dot(d, up)) * this.zoom;
      distance = Math.max(distance, Math.max(wide, high) - dot(d, forward));
    }
    return distance;
  }

  #axes() {
    const eye = this.eye();
    const forward = unit(this.centre.map((c, k) => c - eye[k]));
    const right = unit(cross(forward, [0, 0, 1]));
    return { eye, forward, right, up: cross(right, forward) };
  }

  // Go a step towards the goal; whether there is still way to go.
  step(dt) {
    if (!this.goal || !this.follow) return false;
    const part = 1 - Math.exp(-4 * dt);
    this.centre = this.centre.map((c, k) => c + part * (this.goal.centre[k] - c));
    this.distance += part * (this.goal.distance - this.distance);
    if (Math.abs(this.goal.distance - this.distance) < 1e-3) this.goal = null;
    return true;
  }

  eye() {
    const { azimuth: a, elevation: e, distance: d, centre: c } = this;
    return [c[0] + d * Math.cos(e) * Math.cos(a), c[1] + d * Math.cos(e) * Math.sin(a), c[2] + d * Math.sin(e)];
  }

  // Projection of a pixel: one unit at one metre, in half-heights of the picture.
  get zoom() {
    return 1 / Math.tan(FIELD / 2);
  }

  matrix() {
    const { eye, forward, right, up } = this.#axes();
    const f = this.zoom;
    const aspect = this.canvas.width / Math.max(1, this.canvas.height);
    const [near, far] = [0.02, 20 + 4 * this.distance];
    const rows = [
      scaled(right, f / aspect, eye), scaled(up, f, eye),
      scaled(forward, (far + near) / (far - near), eye), scaled(forward, 1, eye),
    ];
    rows[2][3] += (-2 * far * near) / (far - near);
    const m = new Float32Array(16);
    for (let row = 0; row < 4; row += 1) for (let k = 0; k < 4; k += 1) m[4 * k + row] = rows[row][k];
    return m;
  }

  #turn(dx, dy) {
    this.azimuth -= dx;
    this.elevation = Math.min(Math.max(this.elevation + dy, -1.5), 1.5);
    this.onChange(false);
  }

  #zoom(factor) {
    this.distance = Math.min(Math.max(this.distance * factor, 0.05), 50);
    this.goal = null;
    this.onChange(true);
  }

  #pan(dx, dy) {
    const { right, up } = this.#axes();
    this.centre = this.centre.map((c, k) => c + this.distance * (-dx * right[k] + dy * up[k]));
    this.goal = null;
    this.onChange(true);
  }

  #listen() {
    const { canvas } = this;
    const fingers = new Map();
    canvas.addEventListener("pointerdown", (event) => {
      fingers.set(event.pointerId, [event.clientX, event.clientY]);
      canvas.setPointerCapture(event.pointerId);
    });
    const lift = (event) => fingers.delete(event.pointerId);
    canvas.addEventListener("pointerup", lift);
    canvas.addEventListener("pointercancel", lift);
    canvas.addEventListener("pointermove", (event) => {
      const before = fingers.get(event.pointerId);
      if (!before) return;
      const [dx, dy] = [event.clientX - before[0], event.clientY - before[1]];
      if (fingers.size === 2) {
        const other = [...fingers].find(([id]) => id !== event.pointerId)[1];
        const was = Math.hypot(before[0] - other[0], before[1] - other[1]);
        const is = Math.hypot(event.clientX - other[0], event.clientY - other[1]);
        this.#zoom(was / Math.max(is, 1));
      } else if (event.shiftKey || event.buttons & 6) {
        this.#pan(dx / canvas.clientHeight, dy / canvas.clientHeight);
      } else {
        this.#turn(0.008 * dx, 0.008 * dy);
      }
      fingers.set(event.pointerId, [event.clientX, event.clientY]);
    });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && document.activeElement !== canvas) return; // the page scrolls
      event.preventDefault();
      this.#zoom(Math.exp(0.001 * event.deltaY));
    }, { passive: false });
    const keys = {
      ArrowLeft: () => this.#turn(-0.1, 0), ArrowRight: () => this.#turn(0.1, 0),
      ArrowUp: () => this.#turn(0, 0.1), ArrowDown: () => this.#turn(0, -0.1),
      "+": () => this.#zoom(0.9), "-": () => this.#zoom(1.1),
    };
    canvas.addEventListener("keydown", (event) => {
      if (!keys[event.key] || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      keys[event.key]();
    });
  }
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => {
  const n = Math.hypot(...a) || 1;
  return a.map((v) => v / n);
};
const scaled = (a, f, eye) => {
  const row = a.map((v) => f * v);
  return [...row, -(row[0] * eye[0] + row[1] * eye[1] + row[2] * eye[2])];
};
