// The charts of each hand, in a column of its own: probability, decisions, and the cues' scores.
import { Chart } from "./chart.js";
import { chip, element, handName, INK, look, objectName } from "./looks.js";
import { begin, end, hands, isRecording, objects, segments, shownTime, store } from "./store.js";

const MOST = 8; // lines in a chart
const GRIPS = ["palmar", "pinch"];
const UNDECIDED = "moves, undecided";
const names = (text) => text.replaceAll("_", " ");
let columns = [];
let built = "";

export function drawCharts(host, scoresHost, onSeek) {
  const shown = hands().map((hand) => ({ hand, ids: chosen(hand), letters: chosen(hand).map((id) => look(id).letter), calibrated: isCalibrated(hand) }));
  const cues = cueNames();
  const now = JSON.stringify([shown, cues, isRecording()]);
  if (now !== built) {
    built = now;
    build(host, scoresHost, shown, cues, onSeek);
  }
  const [from, to] = range();
  const cursor = isRecording() || store.cursor !== null ? shownTime() : null;
  for (const column of columns) {
    for (const { chart, lines, hidden } of column.charts) {
      if (hidden && !scoresHost.parentElement.open) continue;
      chart.draw(lines(from, to), from, to, cursor);
    }
  }
}

export function dump() {
  return Object.fromEntries(columns.map(({ hand, charts }) => [hand,
    Object.fromEntries(charts.map(({ name, chart }) => [name, chart.drawn]))]));
}

// The times that the charts show [s].
export function range() {
  const span = Number(document.getElementById("window").value);
  const [first, last] = [begin(), end()];
  if (!span || last - first <= span) return [first, Math.max(last, first + 0.1)];
  if (!isRecording()) {
    const stop = store.cursor === null ? last : Math.min(last, Math.max(store.cursor + span / 2, first + span));
    return [stop - span, stop];
  }
  const middle = Math.min(Math.max(shownTime(), first + span / 2), last - span / 2);
  return [middle - span / 2, middle + span / 2];
}

function isCalibrated(hand) {
  return !(store.rows.get(hand) ?? []).some((row) => row.scores && !row.p);
}

function cueNames() {
  const known = new Set();
  for (const rows of store.rows.values()) {
    for (let k = rows.length - 1; k >= 0; k -= 1) {
      if (!rows[k].scores) continue;
      for (const scores of Object.values(rows[k].scores)) for (const name of Object.keys(scores)) known.add(name);
      break;
    }
  }
  known.delete("global");
  return [...[...known].sort(), "global"];
}

// Of many objects, those that were targets, and then those that are likeliest now.
function chosen(hand) {
  const ids = objects();
  if (ids.length <= MOST) return ids;
  const rows = store.rows.get(hand) ?? [];
  const newest = rows[rows.length - 1]?.p ?? {};
  const targets = new Set();
  for (let k = rows.length - 1; k >= 0 && targets.size < MOST; k -= 1) if (rows[k].subject) targets.add(rows[k].subject);
  const likely = [...ids].sort((a, b) => (newest[b] ?? 0) - (newest[a] ?? 0));
  return [...new Set([...targets, ...likely])].slice(0, MOST).sort();
}

function lineOf(id, hand, from, to, value) {
  const { letter, colour, dash } = look(id);
  return { name: id, label: id === "none" ? "none" : letter, colour, dash, segments: segments(hand, from, to, value) };
}

function build(host, scoresHost, shown, cues, onSeek) {
  host.replaceChildren();
  scoresHost.replaceChildren();
  columns = shown.map(({ hand, ids, calibrated }) => {
    const charts = [];
    const column = element("section", { class: "column", "aria-label": `${handName(hand)}, over time` },
      element("h2", {}, handName(hand)), element("p", { class: "legend" }, ...ids.map(chip)));
    host.append(column);
    const add = (where, name, title, height, axis, lines, hidden = false) => {
      charts.push({ name, hidden, lines, chart: new Chart(where, { title, height, axis, onSeek }) });
    };
    if (calibrated) {
      add(column, "probability", "Probability of each object and of none", 190,
        { min: 0, max: 1, name: "probability [%]", format: (v) => String(Math.round(100 * v)) },
        (from, to) => [...ids, "none"].map((id) => lineOf(id, hand, from, to, (row) => row.p?.[id])));
    } else {
      add(column, "probability", "Score of each object (not a probability)", 190, { min: 0, max: 1, name: "score" },
        (from, to) => ids.map((id) => lineOf(id, hand, from, to, (row) => row.scores?.[id]?.global)));
    }
    const rows = [...ids.map((id) => `${look(id).letter} ${objectName(id)}`), "undecided", ...GRIPS, "permission"];
    add(column, "decision", "Decision, grip and permission", 62 + 15 * rows.length, { rows },
      (from, to) => decisionLines(hand, ids, from, to));
    const scores = element("section", { class: "column", "aria-label": `${handName(hand)}, scores` },
      element("h2", {}, handName(hand)));
    scoresHost.append(scores);
    add(scores, "speed", "Speed of the hand", 120, { min: 0, max: 1, grows: true, name: "speed [m/s]" },
      (from, to) => [{ name: "speed", colour: INK, segments: segments(hand, from, to, (row) => row.speed) }], true);
    for (const cue of cues) {
      const axis = { min: cue === "distance_derivative" ? -1 : 0, max: 1, name: "score" };
      add(scores, cue, cue === "global" ? "Global score" : `Cue: ${names(cue)}`, 120, axis,
        (from, to) => ids.map((id) => lineOf(id, hand, from, to, (row) => row.scores?.[id]?.[cue])), true);
    }
    return { hand, charts };
  });
}

function decisionLines(hand, ids, from, to) {
  const at = (k, test) => segments(hand, from, to, (row) => (test(row) ? k : null));
  const n = ids.length;
  return [
    ...ids.map((id, k) => ({ name: id, colour: look(id).colour, segments: at(k, (row) => row.subject === id) })),
    { name: "undecided", colour: "#8a949e", segments: at(n, (row) => row.verb === UNDECIDED) },
    ...GRIPS.map((grip, k) => ({
      name: grip, colour: INK, segments: at(n + 1 + k, (row) => row.subject && row.grip === grip),
    })),
    { name: "permission", colour: INK, segments: at(n + 3, (row) => Boolean(row.lease)) },
  ];
}
