// Tables: each hand now, the stages of a live run, the trials of a dataset; and all values as CSV.
import { chip, element, handName, objectName, percent, seconds } from "./looks.js";
import { objects, shownRows, shownTime, store } from "./store.js";

const PAGE = 100; // trials shown at once

function tableOf(caption, heads, rows) {
  return element("table", {}, element("caption", {}, caption),
    element("thead", {}, element("tr", {}, ...heads.map((head) => element("th", { scope: "col" }, head)))),
    element("tbody", {}, ...rows.map((cells) => element("tr", {},
      ...cells.map((cell, k) => element(k ? "td" : "th", k ? {} : { scope: "row" }, cell))))));
}

export function drawTable(host) {
  const ids = [...objects(), "none"];
  const rows = shownRows().map((row) => [
    handName(row.hand), row.verb, row.subject ? chip(row.subject) : "–",
    ...ids.map((id) => (row.p ? percent(row.p[id]) : "–")),
    row.subject ? row.grip ?? "–" : "–", row.subject ? seconds(row.contact_in) : "–",
    row.lease ? `${objectName(row.lease.target)}, until ${row.lease.valid_until.toFixed(2)} s` : "–",
    row.speed === undefined ? "–" : `${row.speed.toFixed(2)} m/s`,
  ]);
  const heads = ["hand", "does", "target", ...ids.map((id) => (id === "none" ? "none" : chip(id))), "grip",
    "contact in", "permission", "speed"];
  host.replaceChildren(tableOf(`Each hand at t = ${shownTime().toFixed(2)} s`, heads, rows));
}

export function drawStages(id, caption, message) {
  const box = document.getElementById(id);
  box.hidden = false;
  box.querySelector("div").replaceChildren(tableOf(caption, message.columns, message.rows));
}

export function csv() {
  const ids = [...objects(), "none"];
  const head = ["t [s]", "hand", "status", "target", ...ids.map((id) => `p(${id})`), "grip",
    "time_to_contact [s]", "permission", "permission until [s]", "speed [m/s]"];
  const lines = [head];
  const rows = [...store.rows.values()].flat().sort((a, b) => a.t - b.t);
  for (const row of rows) {
    lines.push([row.t, row.hand, row.status, row.target, ...ids.map((id) => row.p?.[id]), row.grip, row.contact_in,
      row.lease?.target, row.lease?.valid_until, row.speed]);
  }
  const cell = (value) => (/[",\n]/.test(String(value ?? "")) ? `"${String(value).replaceAll('"', '""')}"` : value ?? "");
  return lines.map((line) => line.map(cell).join(",")).join("\n") + "\n";
}

// The trials of a dataset, with a filter; a click opens one.
export function drawTrials(message, send) {
  const box = document.getElementById("trials");
  box.hidden = false;
  const host = box.querySelector("div");
  if (!host.firstChild) {
    host.append(element("div", { class: "bar" },
      element("button", { type: "button", id: "trial-before" }, "Previous trial"),
      element("button", { type: "button", id: "trial-after" }, "Next trial"),
      element("label", {}, "Filter ", element("input", { type: "search", id: "trial-filter", placeholder: "such as: left mustard" }))),
    element("div", { id: "trial-list", class: "scroll", tabindex: "0", role: "region", "aria-label": "List of trials" }));
    document.getElementById("trial-filter").addEventListener("input", () => listTrials(message, send));
  }
  document.getElementById("trial-before").onclick = () => send({ trial: Math.max(1, store.trial - 1) });
  document.getElementById("trial-after").onclick = () => send({ trial: Math.min(message.rows.length, store.trial + 1) });
  store.trials = message;
  listTrials(message, send);
}

export function listTrials(message, send) {
  const words = document.getElementById("trial-filter").value.toLowerCase().split(/\s+/).filter(Boolean);
  const found = message.rows.filter((row) => {
    const cells = row.map((cell) => String(cell ?? "").toLowerCase());
    return words.every((word) => cells.some((cell) => cell.includes(word)));
  });
  const near = words.length ? 0 : Math.max(0, Math.min((store.trial ?? 1) - 1 - PAGE / 2, found.length - PAGE));
  const part = found.slice(near, near + PAGE);
  const rows = part.map((row) => {
    const number = row[0];
    const open = element("button", {
      type: "button", "data-trial": number, "aria-label": `Open trial ${number}`,
      "aria-current": number === store.trial ? "true" : null, onclick: () => send({ trial: number }),
    }, String(number));
    return [open, ...row.slice(1).map((cell) => cell ?? "–")];
  });
  const some = part.length < message.rows.length ? `: ${part.length} of ${message.rows.length} shown` : "";
  document.getElementById("trial-list").replaceChildren(
    tableOf(`Trials${some}; the number opens one`, message.columns, rows));
}

