// Fields for the options of a verb, made from the description that help, man pages and completions come from (--generate json).
"use strict";

/** Told by the page itself, or of no meaning in it. */
const NOT_ASKED = new Set(["-h", "--help", "--quiet", "--color", "--output", "--force", "--json", "--preview", "--threads", "--list", "--gnuplot", "--no-timing"]);

const verbOf = name => USAGE.verbs.find(verb => verb.name === name);
const longFlag = option => option.flags.find(flag => flag.startsWith("--")) || option.flags[0];

function control(option, values, changed) {
  const flag = longFlag(option);
  if (option.kind === "flag") {
    const box = element("input", { type: "checkbox" });
    box.checked = values.get(flag) === true;
    box.addEventListener("change", () => {
      values.set(flag, box.checked);
      changed();
    });
    return box;
  }
  const simple = option.kind === "words" && !option.comma_list && option.words.length > 0;
  const made = simple
    ? element("select", {}, element("option", { value: "" }, "default"), ...option.words.map(word => element("option", { value: word }, word)))
    : element("input", { type: "text", placeholder: option.value, autocomplete: "off", spellcheck: "false" });
  made.value = values.get(flag) || "";
  made.addEventListener(simple ? "change" : "input", () => {
    values.set(flag, made.value.trim());
    changed();
  });
  return made;
}

/** `given`: flags that the page itself gives, so that it need not be said that the option goes with them. */
function optionField(option, values, changed, label, given = []) {
  const only = option.only && !given.some(flag => option.only.includes(flag)) ? ` (only ${option.only})` : "";
  return field(label || longFlag(option), control(option, values, changed), option.help + only, option.kind === "flag" ? "flag" : "");
}

/** Fields by the groups of the help. */
function optionGroups(options, values, changed) {
  const groups = new Map();
  for (const option of options) groups.set(option.group, [...(groups.get(option.group) || []), option]);
  return [...groups].map(([group, some]) => element("fieldset", {}, element("legend", {}, group || "This verb"),
    element("div", { class: "fields" }, ...some.map(option => optionField(option, values, changed)))));
}

/** Main options in front, all others folded, by the groups of the help. */
function optionFields(verbName, use, changed) {
  const verb = verbOf(verbName), asked = verb.options.filter(option => !option.flags.some(flag => NOT_ASKED.has(flag) || use.hidden.includes(flag)));
  const main = use.main.map(([flag, label]) => [asked.find(option => option.flags.includes(flag)), label]).filter(([option]) => option);
  const rest = asked.filter(option => !main.some(([one]) => one === option));
  const parts = [];
  if (main.length > 0) {
    const fields = element("div", { class: "fields" }, ...main.map(([option, label]) => optionField(option, use.values, changed, label, use.hidden)));
    parts.push(use.folded ? element("details", {}, element("summary", {}, "Frequent options"), fields) : fields);
  }
  if (rest.length === 0) return parts;
  parts.push(element("details", {}, element("summary", {}, `All options of ${typed(verbName).join(" ")}`), ...optionGroups(rest, use.values, changed)));
  return parts;
}

/** A choice of several: a fieldset of boxes over `names`; `taken` is a Set. */
function choices(legend, names, taken, changed) {
  return element("fieldset", {}, element("legend", {}, legend), element("div", { class: "choices" }, ...names.map(name => {
    const box = element("input", { type: "checkbox" });
    box.checked = taken.has(name);
    box.addEventListener("change", () => {
      if (box.checked) taken.add(name);
      else taken.delete(name);
      changed();
    });
    return element("label", {}, box, ` ${name}`);
  })));
}

/** A choice of one. `entries`: [value, text]. */
function choice(label, entries, value, take, help) {
  const select = element("select", {}, ...entries.map(([one, text]) => element("option", { value: one }, text)));
  select.value = value;
  select.addEventListener("change", () => take(select.value));
  return field(label, select, help);
}
