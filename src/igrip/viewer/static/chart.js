// One chart on a canvas: lines or rows of bars over time, with axes that have names and units.
import { GREY, INK } from "./looks.js";

const FONT = "12px system-ui, sans-serif";
const BOTTOM = 34;

export function ticksOf(from, to, most) {
  const raw = (to - from) / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(raw || 1));
  const step = power * ([1, 2, 5, 10].find((k) => k * power >= raw) ?? 10);
  const ticks = [];
  for (let k = Math.ceil(from / step - 1e-9); k * step <= to + 1e-9 * step; k += 1) ticks.push(k * step);
  return { ticks, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}

export class Chart {
  // onSeek: called with the time that a person points at.
  constructor(host, { title, height, axis, onSeek }) {
    this.axis = axis;
    this.height = height;
    this.drawn = null;
    const figure = document.createElement("figure");
    figure.className = "chart";
    const caption = document.createElement("figcaption");
    caption.textContent = title;
    this.canvas = document.createElement("canvas");
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", `${title} over time [s]; the values stand in the table below`);
    figure.append(caption, this.canvas);
    host.append(figure);
    const seek = (event) => {
      if (!this.frame || event.buttons === 0) return;
      const { left, width, from, to } = this.frame;
      const x = event.clientX - this.canvas.getBoundingClientRect().left;
      onSeek(from + (Math.min(Math.max((x - left) / width, 0), 1)) * (to - from));
    };
    this.canvas.addEventListener("pointerdown", seek);
    this.canvas.addEventListener("pointermove", seek);
  }

  // lines: {label, name, colour, dash, wide, segments}; axis.rows: names of rows (values 0, 1, …).
  draw(lines, from, to, cursor) {
    const wide = this.canvas.clientWidth;
    if (!wide) return;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const high = this.height;
    if (this.canvas.width !== Math.round(wide * ratio) || this.canvas.height !== Math.round(high * ratio)) {
      this.canvas.width = Math.round(wide * ratio);
      this.canvas.height = Math.round(high * ratio);
      this.canvas.style.height = `${high}px`;
    }
    const ctx = this.canvas.getContext("2d");
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    ctx.clearRect(0, 0, wide, high);
    ctx.font = FONT;
    const rows = this.axis.rows;
    const left = Math.round(Math.min(180, 0.28 * wide)); // the same in all, so that times stand below each other
    const right = 42;
    const [low, top] = rows ? [rows.length - 0.5, -0.5] : [this.axis.min, highest(this.axis, lines)];
    const marks = rows
      ? rows.map((name, k) => [k, shorten(ctx, name, left - 10)])
      : ticksOf(low, top, high > 130 ? 5 : 2).ticks.map((v) => [v, this.axis.format ? this.axis.format(v) : String(+v.toFixed(6))]);
    const width = Math.max(10, wide - left - right);
    const above = rows ? 12 : 24;
    const height = high - above - BOTTOM;
    this.frame = { left, width, from, to };
    const x = (t) => left + ((t - from) / (to - from || 1)) * width;
    const y = (v) => above + ((top - v) / (top - low || 1)) * height;
    this.#axes(ctx, { above, left, width, height, wide, high, from, to, marks, x, y, rows });
    ctx.save();
    ctx.beginPath();
    ctx.rect(left, above - 3, width + 1, height + 6);
    ctx.clip();
    for (const line of lines) drawLine(ctx, line, x, y, Boolean(rows));
    ctx.restore();
    if (!rows) labelEnds(ctx, lines, y, left + width + 6, above, above + height);
    if (cursor !== null && cursor >= from - 1e-9 && cursor <= to + 1e-9) {
      ctx.strokeStyle = INK;
      ctx.setLineDash([]);
      ctx.lineWidth = 1;
      ctx.beginPath();
      ctx.moveTo(x(cursor), above - 6);
      ctx.lineTo(x(cursor), above + height);
      ctx.stroke();
      ctx.fillStyle = INK;
      ctx.beginPath();
      ctx.moveTo(x(cursor) - 5, above - 9);
      ctx.lineTo(x(cursor) + 5, above - 9);
      ctx.lineTo(x(cursor), above - 2);
      ctx.fill();
    }
    this.drawn = { from, to, cursor, frame: this.frame, lines };
  }

  #axes(ctx, { above, left, width, height, wide, high, from, to, marks, x, y, rows }) {
    ctx.setLineDash([]);
    ctx.lineWidth = 1;
    ctx.fillStyle = GREY;
    ctx.textBaseline = "middle";
    ctx.textAlign = "right";
    for (const [v, text] of marks) {
      ctx.strokeStyle = "#d9dee3";
      ctx.beginPath();
      ctx.moveTo(left, Math.round(y(v)) + 0.5);
      ctx.lineTo(left + width, Math.round(y(v)) + 0.5);
      ctx.stroke();
      ctx.fillText(text, left - 6, y(v));
    }
    const { ticks, digits } = ticksOf(from, to, Math.max(2, Math.floor(width / 80)));
    ctx.textBaseline = "top";
    ctx.strokeStyle = GREY;
    ctx.beginPath();
    ctx.moveTo(left + 0.5, above);
    ctx.lineTo(left + 0.5, above + height + 0.5);
    ctx.lineTo(left + width, above + height + 0.5);
    for (const t of ticks) {
      ctx.moveTo(Math.round(x(t)) + 0.5, above + height);
      ctx.lineTo(Math.round(x(t)) + 0.5, above + height + 4);
      const text = t.toFixed(digits);
      const half = ctx.measureText(text).width / 2;
      ctx.textAlign = "center";
      ctx.fillText(text, Math.min(Math.max(x(t), left + half - 8), wide - half - 2), above + height + 6);
    }
    ctx.stroke();
    ctx.fillStyle = INK;
    ctx.textAlign = "center";
    ctx.fillText("time [s]", left + width / 2, high - 14);
    if (!rows && this.axis.name) {
      ctx.textAlign = "left";
      ctx.fillText(this.axis.name, 4, 1);
    }
  }
}

// The upper end of the axis: as given, or a round number above the highest value.
function highest(axis, lines) {
  let most = axis.max;
  for (const { segments } of lines) for (const segment of segments) for (const [, v] of segment) most = Math.max(most, v);
  return axis.grows ? Math.ceil(2 * most) / 2 : axis.max;
}

function drawLine(ctx, line, x, y, asRows) {
  ctx.strokeStyle = ctx.fillStyle = line.colour;
  ctx.lineWidth = asRows ? 9 : line.wide ?? 2;
  ctx.lineCap = "butt";
  ctx.lineJoin = "round";
  ctx.setLineDash(asRows ? [] : line.dash ?? []);
  for (const segment of line.segments) {
    if (segment.length === 1) {
      const [t, v] = segment[0];
      ctx.beginPath();
      if (asRows) ctx.rect(x(t) - 1.5, y(v) - 4.5, 3, 9);
      else ctx.arc(x(t), y(v), 2.5, 0, 7);
      ctx.fill();
      continue;
    }
    ctx.beginPath();
    segment.forEach(([t, v], k) => (k ? ctx.lineTo(x(t), y(v)) : ctx.moveTo(x(t), y(v))));
    ctx.stroke();
  }
  ctx.setLineDash([]);
}

// The letter of each line at its right end, moved apart where they would cover each other.
function labelEnds(ctx, lines, y, x, top, bottom) {
  const ends = [];
  for (const line of lines) {
    const segment = line.segments[line.segments.length - 1];
    if (line.label && segment) ends.push({ line, at: y(segment[segment.length - 1][1]) });
  }
  ends.sort((a, b) => a.at - b.at);
  for (let k = 1; k < ends.length; k += 1) ends[k].at = Math.max(ends[k].at, ends[k - 1].at + 12);
  for (let k = ends.length - 1, limit = bottom + 6; k >= 0; k -= 1, limit = ends[k + 1].at - 12) {
    ends[k].at = Math.min(ends[k].at, limit);
  }
  ctx.textAlign = "left";
  ctx.textBaseline = "middle";
  ctx.font = `bold ${FONT}`;
  for (const { line, at } of ends) {
    ctx.fillStyle = line.colour;
    ctx.fillText(line.label, x, Math.max(at, top - 4));
  }
  ctx.font = FONT;
}

function shorten(ctx, text, room) {
  if (ctx.measureText(text).width <= room) return text;
  let short = text;
  while (short.length > 1 && ctx.measureText(`${short}…`).width > room) short = short.slice(0, -1);
  return `${short}…`;
}
