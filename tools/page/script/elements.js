// Elements of the page. Text of files and of the program only ever becomes text.
"use strict";

const byId = id => document.getElementById(id);

/** element("p", {class: "note", onclick}, child…): strings become text nodes. */
function element(name, about = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(about)) {
    if (value === undefined || value === false) continue;
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else made.setAttribute(key, value === true ? "" : value);
  }
  made.append(...children.filter(child => child !== null && child !== undefined && child !== ""));
  return made;
}

/** Text whose options no line breaks inside: "--" and "rate" stay together. */
const unbroken = text => text.split(/(\S*--\S+)/).map((part, i) => i % 2 === 1 ? element("span", { class: "word" }, part) : part);

const button = (text, onclick, about = {}) => element("button", { type: "button", onclick, ...about }, text);

let fieldNumber = 0;

/** A labelled control with its help. */
function field(label, control, help, kind = "") {
  const id = `f${++fieldNumber}`;
  control.id = id;
  const about = help ? element("span", { class: "help", id: `${id}h` }, help) : null;
  if (about) control.setAttribute("aria-describedby", about.id);
  const named = element("label", { for: id }, label);
  return element("div", { class: `field ${kind}` }, ...(kind === "flag" ? [control, named] : [named, control]), about);
}

const bytesText = n => n < 1e3 ? `${n} B` : n < 1e6 ? `${(n / 1e3).toPrecision(3)} kB` : n < 1e9 ? `${(n / 1e6).toPrecision(3)} MB` : `${(n / 1e9).toPrecision(3)} GB`;

/** For people: five digits. */
const numberText = x => x === null || x === undefined ? "–" : Number.isInteger(x) && Math.abs(x) < 1e6 ? String(x) : String(Number(x.toPrecision(5)));
