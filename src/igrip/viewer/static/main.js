// The page: receives what igrip thinks, and draws it. No script from elsewhere is needed.
import { drawCharts, dump } from "./charts.js";
import { drawControls, seek, setUpControls, setUpEstimators } from "./controls.js";
import { save, setUpExport } from "./exporting.js";
import { countDown, drawHands } from "./hands.js";
import { element, setLooks } from "./looks.js";
import { drawNaming } from "./naming.js";
import { Scene } from "./scene.js";
import { addRows, addScene, store } from "./store.js";
import { csv, drawStages, drawTable, drawTrials, listTrials } from "./tables.js";

const byId = (id) => document.getElementById(id);
const SLOW = 200; // ms between two drawings of charts and tables
let socket = null;
let dirty = true;
let drawn = 0;

function send(message) {
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
}

function changed() {
  dirty = true;
  drawn = 0;
}

const scene = new Scene(byId("gl"), byId("labels"));

const handlers = {
  setup(message) {
    store.setup = message;
    document.body.dataset.mode = message.mode;
    setUpEstimators(send);
  },
  note({ title, text }) {
    byId("note").textContent = title ? `${title}: ${text}` : text;
    document.title = title ? `${title} – igrip` : "igrip";
  },
  looks({ numbers }) {
    setLooks(numbers);
  },
  rows(message) {
    addRows(message.rows, message.reset);
  },
  scene(message) {
    addScene(message);
    scene.dirty = true;
  },
  player(message) {
    store.player = message;
  },
  trials(message) {
    drawTrials(message, send);
  },
  trial({ number }) {
    store.trial = number;
    if (store.trials) listTrials(store.trials, send);
    scene.refit();
  },
  things: (message) => drawNaming(message, send),
  stages: (message) => drawStages("stages", "Rate and latency of each stage", message),
  borders: (message) => drawStages("borders", "Heights from the middle, along the axis of the cylinder", message),
  picture({ camera, number }) {
    const host = byId("cameras");
    host.hidden = false;
    document.body.dataset.cameras = "yes";
    let image = [...host.querySelectorAll("img")].find((one) => one.dataset.camera === camera);
    if (!image) {
      image = element("img", { "data-camera": camera, alt: `Picture of camera ${camera} with what was detected` });
      host.append(element("figure", {}, image, element("figcaption", {}, `Camera ${camera}`)));
    }
    image.src = `picture/${encodeURIComponent(camera)}?${number}`;
  },
};

function connect() {
  socket = new WebSocket(`ws${location.protocol === "https:" ? "s" : ""}://${location.host}/socket`);
  socket.addEventListener("open", () => {
    byId("connection").textContent = "";
    document.body.classList.remove("gone");
    send({ opened_page: true });
  });
  socket.addEventListener("message", (event) => {
    const message = JSON.parse(event.data);
    handlers[message.kind]?.(message);
    dirty = true;
  });
  socket.addEventListener("close", () => {
    byId("connection").textContent = "igrip has stopped, or is out of reach. What is shown is old.";
    document.body.classList.add("gone");
    setTimeout(connect, 1000);
  });
}

function frame() {
  const now = performance.now();
  if (dirty) {
    drawHands(byId("hands"), send);
    drawControls();
    if (now - drawn >= SLOW) {
      drawn = now;
      dirty = false;
      drawCharts(byId("charts"), byId("scores").querySelector("div"), (t) => seek(t, send, () => {
        scene.dirty = true;
        changed();
      }));
      if (byId("table").open) drawTable(byId("table").querySelector("div"));
    }
  } else countDown();
  scene.frame();
  requestAnimationFrame(frame);
}

setUpControls(send, () => {
  scene.dirty = true;
  changed();
});
setUpExport();
byId("fit").addEventListener("click", () => scene.refit());
byId("follow").addEventListener("change", (event) => scene.setFollow(event.target.checked));
byId("rays").addEventListener("change", (event) => {
  scene.rays = event.target.checked;
  scene.dirty = true;
});
byId("csv").addEventListener("click", () => save(new Blob([csv()], { type: "text/csv" }), "igrip.csv"));
for (const box of document.querySelectorAll("details")) box.addEventListener("toggle", changed);
window.addEventListener("resize", changed);
window.igrip = { store, scene, charts: dump, settled: () => !dirty && !scene.dirty }; // for tests and for the curious
connect();
requestAnimationFrame(frame);
