// Time: playback of a recording, looking back in a live scene, and the keys for both.
import { begin, end, isRecording, shownTime, store } from "./store.js";

const byId = (id) => document.getElementById(id);

export function setUpControls(send, changed) {
  const click = (id, message) => byId(id).addEventListener("click", () => send(message()));
  click("play", () => ({ play: !store.player?.playing }));
  click("first", () => ({ step: -1e6 }));
  click("back", () => ({ step: -1 }));
  click("forward", () => ({ step: 1 }));
  click("last", () => ({ step: 1e6 }));
  byId("speed").addEventListener("change", () => send({ speed: Number(byId("speed").value) }));
  byId("repeat").addEventListener("change", () => send({ repeat: byId("repeat").checked }));
  byId("slider").addEventListener("input", () => seek(Number(byId("slider").value), send, changed));
  byId("now").addEventListener("click", () => {
    store.cursor = null;
    changed();
  });
  byId("window").addEventListener("change", changed);
  document.addEventListener("keydown", (event) => {
    const busy = event.target.closest("input, select, button, textarea, summary, a");
    if (busy || event.ctrlKey || event.metaKey || event.altKey || !isRecording()) return;
    const message = { " ": { play: !store.player?.playing }, ",": { step: -1 }, ".": { step: 1 } }[event.key];
    if (!message) return;
    event.preventDefault();
    send(message);
  });
}

// Go to a time: of a recording for all who look at it, of a live scene for this page alone.
export function seek(t, send, changed) {
  if (isRecording()) send({ seek: t });
  else store.cursor = t >= end() - 0.05 ? null : t;
  changed();
}

export function drawControls() {
  const recording = isRecording();
  byId("player").hidden = !recording;
  byId("time").hidden = store.setup.mode === "static";
  const t = shownTime();
  const [first, last] = [begin(), end()];
  const slider = byId("slider");
  slider.min = first;
  slider.max = Math.max(last, first + 0.001);
  slider.value = t;
  slider.setAttribute("aria-valuetext", `${t.toFixed(2)} seconds`);
  byId("slider-time").textContent = `${t.toFixed(2)} s`;
  byId("slider-label").textContent = recording || store.cursor === null ? "Time" : "Looking back at";
  byId("now").hidden = recording || store.cursor === null;
  byId("clock").textContent = store.scene ? `t = ${t.toFixed(2)} s` : "";
  if (!store.player) return;
  byId("play").textContent = store.player.playing ? "Pause" : "Play";
  if (document.activeElement !== byId("speed")) byId("speed").value = String(store.player.speed);
  byId("repeat").checked = store.player.repeat;
}

export function setUpEstimators(send) {
  const box = byId("targets");
  byId("targets-box").hidden = !store.setup.targets;
  const names = store.setup.choices.length ? store.setup.choices : [store.setup.targets];
  box.replaceChildren(...names.filter(Boolean).map((name) => new Option(name, name, false, name === store.setup.targets)));
  box.disabled = !store.setup.choices.length;
  box.onchange = () => send({ targets: box.value });
}
