// A picture or a film of what the page shows: the scene, the camera, the sentences, the bars.
import { handName, INK, look, objectName, percent, seconds } from "./looks.js";
import { objects, shownRows, shownTime } from "./store.js";

const WIDTH = 1280;
const HEIGHT = 720;
const SIDE = 400; // for the sentences
const RATE = 20; // pictures per second of a film

export function save(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

const stamp = () => `igrip-${shownTime().toFixed(2)}s`;

export function compose(canvas) {
  Object.assign(canvas, { width: WIDTH, height: HEIGHT });
  const ctx = canvas.getContext("2d");
  ctx.fillStyle = "#fff";
  ctx.fillRect(0, 0, WIDTH, HEIGHT);
  const pictures = [...document.querySelectorAll("#cameras img")].filter((image) => image.naturalWidth);
  const views = [document.getElementById("gl"), ...pictures.slice(0, 1)];
  const high = HEIGHT / views.length;
  views.forEach((view, k) => {
    fit(ctx, view, 0, k * high, WIDTH - SIDE, high);
    if (view.id === "gl") fit(ctx, document.getElementById("labels"), 0, k * high, WIDTH - SIDE, high);
  });
  ctx.textBaseline = "top";
  let y = 16;
  const x = WIDTH - SIDE + 20;
  const write = (text, size, weight = "400", colour = INK) => {
    ctx.font = `${weight} ${size}px system-ui, sans-serif`;
    ctx.fillStyle = colour;
    ctx.fillText(text, x, y, SIDE - 36);
    y += size * 1.4;
  };
  write(`igrip · ${document.getElementById("note").textContent || ""}  t = ${shownTime().toFixed(2)} s`, 15);
  for (const row of shownRows()) {
    y += 12;
    write(handName(row.hand), 16, "600");
    write(row.subject ? `${row.verb} ${objectName(row.subject)}` : row.verb, 26, "700");
    if (row.subject) write(`${row.grip ?? "–"} grip · contact in ${seconds(row.contact_in)}`, 16);
    for (const id of row.p ? [...objects(), "none"].slice(0, 9) : []) {
      const p = row.p[id] ?? 0;
      ctx.fillStyle = look(id).colour;
      ctx.fillRect(x + 160, y + 2, p * (SIDE - 250), 14);
      ctx.fillStyle = INK;
      ctx.font = "14px system-ui, sans-serif";
      ctx.fillText(`${look(id).letter} ${objectName(id)}`, x, y + 2, 150);
      ctx.fillText(percent(p), x + SIDE - 84, y + 2);
      y += 20;
    }
    write(row.lease ? `Permission: ${row.lease.grip} grip of ${objectName(row.lease.target)}` : "No permission to act", 15);
  }
  return canvas;
}

function fit(ctx, source, x, y, width, height) {
  const [w, h] = [source.naturalWidth ?? source.width, source.naturalHeight ?? source.height];
  if (!w || !h) return;
  const scale = Math.min(width / w, height / h);
  ctx.drawImage(source, x + (width - w * scale) / 2, y + (height - h * scale) / 2, w * scale, h * scale);
}

export function setUpExport() {
  const picture = document.getElementById("picture");
  picture.addEventListener("click", () => {
    compose(document.createElement("canvas")).toBlob((blob) => save(blob, `${stamp()}.png`));
  });
  const film = document.getElementById("film");
  if (!window.MediaRecorder) film.hidden = true;
  let stop = null;
  film.addEventListener("click", () => {
    stop = stop ? stop() : record((blob, name) => save(blob, name));
    film.setAttribute("aria-pressed", String(Boolean(stop)));
    film.textContent = stop ? "Stop and save film" : "Record film";
  });
}

// Begin a film; return the function that ends it.
function record(done) {
  const canvas = compose(document.createElement("canvas"));
  const name = `${stamp()}.webm`;
  const stream = canvas.captureStream(RATE);
  const recorder = new MediaRecorder(stream, { mimeType: "video/webm", videoBitsPerSecond: 4_000_000 });
  const parts = [];
  const film = document.getElementById("film");
  recorder.addEventListener("dataavailable", (event) => {
    parts.push(event.data);
    film.title = `${Math.round(parts.reduce((sum, part) => sum + part.size, 0) / 1000)} kB recorded`;
  });
  recorder.addEventListener("stop", () => done(new Blob(parts, { type: "video/webm" }), name));
  const timer = setInterval(() => compose(canvas), 1000 / RATE);
  recorder.start(200);
  return () => {
    clearInterval(timer);
    recorder.stop();
    return null;
  };
}
