// How each object looks: a letter, a colour and dashes. Colours as in palette.py.
export const COLOURS = ["#3d8bff", "#e25a00", "#195732", "#d369a9", "#65530b", "#7214ff", "#a32020", "#4f7f8f"];
export const INK = "#16202a";
export const GREY = "#5b6672";
const DASHES = [[], [9, 4], [2, 3], [10, 3, 2, 3], [5, 2]];
export const NONE = { letter: "–", colour: "#000000", dash: [3, 5], name: "none" };

const places = new Map(); // id -> number

export function look(id) {
  if (id === "none") return NONE;
  if (!places.has(id)) {
    const used = new Set(places.values());
    let free = 0;
    while (used.has(free)) free += 1;
    places.set(id, free);
  }
  const k = places.get(id);
  const letter = String.fromCharCode(65 + (k % 26)) + (k < 26 ? "" : String(Math.floor(k / 26)));
  return { letter, colour: COLOURS[k % COLOURS.length], dash: DASHES[k % DASHES.length], name: id };
}

// The numbers that igrip gives, so that the camera's picture has the same letters.
export function setLooks(numbers) {
  places.clear();
  for (const [id, k] of Object.entries(numbers)) places.set(id, k);
}

export function element(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name === "class") node.className = value;
    else if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else if (value !== null && value !== undefined && value !== false) {
      node.setAttribute(name, value === true ? "" : value);
    }
  }
  node.append(...children.filter((child) => child !== null && child !== undefined));
  return node;
}

// The object's name with its letter on its colour.
export function chip(id) {
  const shown = look(id);
  const badge = element("span", { class: "letter", "aria-hidden": "true" }, shown.letter);
  badge.style.borderColor = shown.colour;
  return element("span", { class: "chip" }, badge, element("span", {}, ...breakable(objectName(id))));
}

// A long name breaks after an underscore, rather than within a word.
const breakable = (name) => name.split(/(?<=_)/).flatMap((part, k) => (k ? [element("wbr"), part] : [part]));

// An object whose id is the name of a hand is called an object.
export const objectName = (id) => (/^(left|right)\b/i.test(id) ? `object “${id}”` : id);
export const handName = (id) => (/^(left|right)$/.test(id) ? `${id[0].toUpperCase()}${id.slice(1)} hand` : `Hand ${id}`);
export const percent = (p) => (p === null || p === undefined ? "–" : `${Math.round(100 * p)} %`);
export const seconds = (s, digits = 1) => (s === null || s === undefined ? "–" : `${s.toFixed(digits)} s`);
