// Names for unknown things: a field for each.
import { chip, element, objectName } from "./looks.js";

const rows = new Map(); // id -> { node, name, shown, letter }

export function drawNaming({ ids, names, answer }, send) {
  const box = document.getElementById("naming");
  box.hidden = !ids.length;
  const host = box.querySelector("div");
  for (const id of ids) {
    if (!rows.has(id)) {
      rows.set(id, newRow(id, send));
      host.append(rows.get(id).node);
    }
    const row = rows.get(id);
    row.shown.replaceChildren(chip(id));
    row.name.textContent = names[id] ? `named ${names[id]}` : "";
  }
  const said = document.getElementById("naming-answer");
  if (said.textContent !== answer) said.textContent = answer;
}

function newRow(id, send) {
  const field = element("input", {
    type: "text", maxlength: 60, required: true, autocomplete: "off", spellcheck: "false",
    "aria-label": `Name for ${objectName(id)}`,
  });
  const shown = element("span");
  const name = element("span", { class: "given" });
  const node = element(
    "form", { class: "bar", "data-thing": id, onsubmit: (event) => {
      event.preventDefault();
      send({ name: { id, name: field.value } });
    } },
    shown, field,
    element("button", { type: "submit", "aria-label": `Give ${objectName(id)} this name` }, "Give name"), name,
  );
  return { node, name, shown };
}
