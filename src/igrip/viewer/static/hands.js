// A card for each hand: the sentence, the probabilities, grip and time to contact, the lease.
import { chip, element, handName, look, objectName, percent, seconds } from "./looks.js";
import { hands, isRecording, objects, shownRows, store } from "./store.js";

const LEASE = 0.15; // s, the length of a new lease
const MOST = 12; // objects with a bar
const cards = new Map();

export function drawHands(host, send) {
  const rows = new Map(shownRows().map((row) => [row.hand, row]));
  const shown = hands();
  for (const [hand, card] of cards) {
    if (!shown.includes(hand)) {
      card.node.remove();
      cards.delete(hand);
    }
  }
  for (const hand of shown) {
    if (!cards.has(hand)) {
      cards.set(hand, newCard(hand, send));
      const after = [...cards.keys()].sort().indexOf(hand);
      host.insertBefore(cards.get(hand).node, host.children[after] ?? null);
    }
    fill(cards.get(hand), rows.get(hand) ?? null);
  }
  host.classList.toggle("empty", !shown.length);
  if (!shown.length && !host.children.length) host.append(element("p", { class: "waiting" }, "No hand yet"));
  else host.querySelector(".waiting")?.remove();
}

function newCard(hand, send) {
  const id = `hand-${cards.size}-${Math.random().toString(36).slice(2, 8)}`;
  const card = {
    title: element("h2", { id }, handName(hand)),
    sentence: element("p", { class: "sentence", role: "status" }),
    detail: element("p", { class: "detail" }),
    body: element("tbody"),
    head: element("th", { scope: "col" }, "probability"),
    lease: element("p", { class: "lease-text" }),
    left: element("span", { class: "left" }),
    progress: element("progress", { max: LEASE, value: 0, "aria-label": `Permission left, ${handName(hand)}` }),
    buttons: element("div", { class: "bar" }),
    bars: new Map(),
  };
  for (const [action, text] of [["veto", "Veto"], ["confirm", "Confirm"], ["opened", "Device opened"]]) {
    card.buttons.append(element("button", {
      type: "button", class: action, "data-action": action,
      "aria-label": `${text}, ${handName(hand)}`, onclick: () => send({ control: action, hand }),
    }, text));
  }
  card.node = element(
    "article", { class: "card", "aria-labelledby": id, "data-hand": hand },
    card.title, card.sentence, card.detail,
    element("table", { class: "bars" },
      element("caption", { class: "hidden" }, `What the ${handName(hand).toLowerCase()} may grasp`),
      element("thead", { class: "hidden" }, element("tr", {},
        element("th", { scope: "col" }, "object"), element("th", { scope: "col" }, "bar"), card.head)),
      card.body),
    element("div", { class: "lease" }, card.lease, card.progress, card.left),
    card.buttons,
  );
  return card;
}

function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

function fill(card, row) {
  const subject = row?.subject ?? null;
  const key = row ? `${row.verb}|${subject}|${subject && look(subject).letter}` : "absent";
  if (card.key !== key) {
    card.key = key;
    card.sentence.replaceChildren(row ? row.verb : "is not measured", ...(subject ? [" ", chip(subject)] : []));
    card.node.classList.toggle("sure", Boolean(subject));
  }
  setText(card.detail, row ? detailOf(row) : "");
  fillBars(card, row);
  card.assisted = Boolean(row?.assisted);
  card.buttons.hidden = !(store.setup.commands.length && card.assisted);
  for (const button of card.buttons.children) {
    button.hidden = !store.setup.commands.includes(button.dataset.action);
  }
  card.row = row;
  fillLease(card);
}

function detailOf(row) {
  if (!row.subject) return row.reason ?? "";
  const parts = [];
  if (row.grip) parts.push(`${row.grip} grip${row.grip_p ? ` (${percent(row.grip_p[row.grip])})` : ""}`);
  if (row.contact_in !== undefined) {
    const range = row.contact_interval ? ` (${row.contact_interval.map((s) => s.toFixed(1)).join("–")} s)` : "";
    parts.push(`contact in ${seconds(row.contact_in)}${range}`);
  }
  if (row.reason) parts.push(row.reason);
  return parts.join(" · ");
}

// Probabilities where there are some, else scores, which are none and are called so.
function fillBars(card, row) {
  const calibrated = Boolean(row?.p);
  const value = (id) => (calibrated ? row.p[id] : row?.scores?.[id]?.global);
  let ids = objects();
  if (ids.length > MOST) {
    ids = [...ids].sort((a, b) => (value(b) ?? -1) - (value(a) ?? -1)).slice(0, MOST).sort();
  }
  if (calibrated || !row?.scores) ids.push("none");
  setText(card.head, calibrated ? "probability" : "score (not a probability)");
  for (const [id, bar] of card.bars) {
    if (!ids.includes(id) || bar.letter !== look(id).letter) {
      bar.node.remove();
      card.bars.delete(id);
    }
  }
  ids.forEach((id, k) => {
    if (!card.bars.has(id)) {
      const bar = { letter: look(id).letter, fill: element("div", { class: "fill" }), number: element("td", { class: "number" }) };
      const name = id === "none" ? "none of them" : chip(id);
      bar.node = element("tr", { "data-object": id }, element("th", { scope: "row" }, name),
        element("td", { class: "track" }, bar.fill), bar.number);
      card.bars.set(id, bar);
      card.body.insertBefore(bar.node, card.body.children[k] ?? null);
    }
    const bar = card.bars.get(id);
    const v = value(id);
    bar.fill.style.width = `${100 * Math.min(Math.max(v ?? 0, 0), 1)}%`;
    bar.fill.style.backgroundColor = look(id).colour;
    setText(bar.number, calibrated || v === undefined ? percent(v) : v.toFixed(2));
    bar.node.classList.toggle("chosen", id === row?.subject);
  });
}

// The countdown runs on between two messages, so that silence is seen to end a lease.
export function countDown() {
  for (const card of cards.values()) fillLease(card);
}

function fillLease(card) {
  const row = card.row;
  const lease = row?.lease;
  let now = row?.t ?? 0;
  if (store.scene && (isRecording() || store.cursor === null)) {
    now = Math.max(store.scene.t, now);
    if (!isRecording()) now += (performance.now() - store.received) / 1000;
  }
  const left = lease ? lease.valid_until - now : 0;
  const holds = lease && left > 0;
  setText(card.lease, holds ? `Permission: ${lease.grip} grip of ${objectName(lease.target)}`
    : lease ? "Permission expired"
    : card.assisted || !row ? "No permission to act" : "No device assists this hand");
  setText(card.left, holds ? seconds(left, 2) : "");
  card.progress.value = Math.max(0, Math.min(left, LEASE));
  card.node.classList.toggle("permitted", Boolean(holds));
}
