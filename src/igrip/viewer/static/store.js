// What was received: the rows of each hand, the newest scenes, and the moment that is shown.
export const GAP = 0.3; // s between two rows of a hand from which a chart has a gap
const LIVE_SPAN = 60; // s of rows that a live page keeps
const SCENES = 300; // for looking back in a live scene

export const store = {
  setup: { mode: "live", choices: [], commands: [] },
  rows: new Map(), // hand -> rows by time
  scenes: [],
  scene: null, // the newest
  cursor: null, // s; null: now
  player: null,
  received: 0, // performance.now() of the newest scene
  version: 0,
};

export const isRecording = () => store.setup.mode === "recording";

export function addRows(rows, reset) {
  if (reset) {
    store.rows.clear();
    store.scenes = [];
    store.cursor = null;
  }
  for (const row of rows) {
    if (!store.rows.has(row.hand)) store.rows.set(row.hand, []);
    store.rows.get(row.hand).push(row);
  }
  if (!isRecording()) trim();
  store.version += 1;
}

function trim() {
  const newest = end();
  for (const [hand, rows] of store.rows) {
    let old = 0;
    while (old < rows.length && rows[old].t < newest - LIVE_SPAN) old += 1;
    if (old) rows.splice(0, old);
    if (!rows.length) store.rows.delete(hand);
  }
}

export function addScene(scene) {
  store.scene = scene;
  store.received = performance.now();
  if (!isRecording()) {
    store.scenes.push(scene);
    if (store.scenes.length > SCENES) store.scenes.shift();
  }
  store.version += 1;
}

export function begin() {
  if (store.player) return store.player.begin;
  let first = Infinity;
  for (const rows of store.rows.values()) if (rows.length) first = Math.min(first, rows[0].t);
  return Number.isFinite(first) ? first : 0;
}

export function end() {
  if (store.player) return store.player.end;
  let last = store.scene ? store.scene.t : -Infinity;
  for (const rows of store.rows.values()) if (rows.length) last = Math.max(last, rows[rows.length - 1].t);
  return Number.isFinite(last) ? last : 0;
}

// The moment that is shown, in seconds of the messages' clock.
export function shownTime() {
  if (isRecording()) return store.scene ? store.scene.t : begin();
  return store.cursor ?? (store.scene ? store.scene.t : end());
}

export function shownScene() {
  if (isRecording() || store.cursor === null) return store.scene;
  let found = store.scenes[0] ?? null;
  for (const scene of store.scenes) if (scene.t <= store.cursor + 1e-6) found = scene;
  return found;
}

// The row of each hand at the moment that is shown.
export function shownRows() {
  if (isRecording() || store.cursor === null) return store.scene ? store.scene.rows : [];
  const found = [];
  for (const rows of store.rows.values()) {
    const row = rows[rowAt(rows, store.cursor)];
    if (row && store.cursor - row.t <= GAP) found.push(row);
  }
  return found.sort((a, b) => (a.hand < b.hand ? -1 : 1));
}

// The number of the last row not later than t; -1: none.
export function rowAt(rows, t) {
  let low = 0;
  let high = rows.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (rows[middle].t <= t + 1e-6) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

export function hands() {
  const known = new Set(store.rows.keys());
  if (store.scene) for (const row of store.scene.rows) known.add(row.hand);
  return [...known].sort();
}

export function objects() {
  const known = new Set();
  if (store.scene) for (const placed of store.scene.objects) known.add(placed.id);
  for (const rows of store.rows.values()) {
    for (const row of rows) for (const id of Object.keys(row.p ?? row.scores ?? {})) known.add(id);
  }
  known.delete("none");
  return [...known].sort();
}

// Broken at every gap: segments of [t, value] of one quantity of a hand between two times.
export function segments(hand, from, to, value) {
  const found = [];
  let last = null;
  const rows = store.rows.get(hand) ?? [];
  for (let k = Math.max(0, rowAt(rows, from)); k < rows.length && rows[k].t <= to; k += 1) {
    const row = rows[k];
    const v = value(row);
    if (v === null || v === undefined) {
      last = null;
      continue;
    }
    if (last === null || row.t - last > GAP) found.push([]);
    found[found.length - 1].push([row.t, v]);
    last = row.t;
  }
  return found;
}
