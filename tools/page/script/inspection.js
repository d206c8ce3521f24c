// What `inspect` says of a recording, with what is missing asked for in place.
"use strict";

function facts(recording) {
  const words = [recording.format, bytesText(recording.bytes)];
  if (recording.rate_hz) {
    words.push(`${numberText(recording.rate_hz)} Hz`, `${numberText(recording.samples / recording.rate_hz)} s`);
    words.push(recording.gaps === 1 ? "1 gap" : `${recording.gaps} gaps`);
  } else if (recording.channels.length > 0) {
    words.push(`${recording.samples} samples`);
  }
  if (recording.topic) words.push(`stream ${recording.topic}`);
  return words.join(", ");
}

/** Cell for the unit: what the log says, or a question. */
function unitCell(item, channel, changed) {
  if (channel.unit) return element("td", {}, channel.unit);
  const input = element("input", { type: "text", "aria-label": `Unit of ${channel.name}`, placeholder: "unit, such as deg/s", size: 12 });
  input.addEventListener("change", () => {
    item.units.set(channel.name, input.value);
    changed();
  });
  return element("td", {}, input);
}

/** Where a value lies between two: 0 to 1, also where no number is as large as their difference. */
function share(value, least, most) {
  if (Number.isFinite(most - least)) return (value - least) / (most - least || 1);
  return (value / 2 - least / 2) / (most / 2 - least / 2);
}

/** The whole record, as small as a word: a line through the largest and the least value of each block. */
function traceCell(channel) {
  const { low, high } = channel.trace, known = low.map((_, i) => i).filter(i => low[i] !== null);
  const least = Math.min(...known.map(i => low[i])), most = Math.max(...known.map(i => high[i])), y = value => (23 - 22 * share(value, least, most)).toFixed(2);
  const picture = document.createElementNS("http://www.w3.org/2000/svg", "svg"), path = document.createElementNS(picture.namespaceURI, "path");
  for (const [name, value] of Object.entries({ class: "trace", viewBox: `0 0 ${low.length} 24`, preserveAspectRatio: "none", role: "img", "aria-label": `Trace of ${channel.name}` }))
    picture.setAttribute(name, value);
  path.setAttribute("d", known.map(i => `${low[i - 1] === null || i === 0 ? "M" : "L"}${i + 0.5} ${y(high[i])}V${Number(y(low[i])) + 0.6}`).join(""));
  picture.append(path);
  return element("td", { class: "trace" }, picture);
}

function channelTable(item, recording, changed) {
  const heads = ["channel", "unit", "trace", "mean", "standard deviation", "smallest", "largest", "missing"];
  const rows = recording.channels.map(channel => element("tr", {},
    element("th", { scope: "row" }, channel.name), unitCell(item, channel, changed), traceCell(channel),
    ...[channel.mean, channel.standard_deviation, channel.minimum, channel.maximum, channel.missing].map((value, i) =>
      element("td", { class: "n", "data-label": heads[i + 3] }, numberText(value)))));
  return element("div", { class: "wide" }, element("table", { class: "cards" },
    element("thead", {}, element("tr", {}, ...heads.map(head => element("th", { scope: "col" }, head)))),
    element("tbody", {}, ...rows)));
}

/** What a log without a rate is asked: the rate, or the column that has the times. */
function rateQuestion(item, recording, changed) {
  const rate = element("input", { type: "text", placeholder: "200 Hz", value: item.reading.get("--rate"), size: 14 });
  const column = element("select", {}, ...["", ...recording.channels.map(({ name }) => name)].map(name => element("option", { value: name }, name || "none")));
  const answer = () => {
    const [flag, value] = column.value ? ["--time-column", column.value] : ["--rate", rate.value.trim()];
    if (!value) return;
    item.reading.set(flag, value);
    changed();
  };
  rate.addEventListener("keydown", event => {
    if (event.key === "Enter") answer();
  });
  return element("div", { class: "asked" }, element("p", {}, "The log does not say how fast it was sampled."), field("Sampling rate", rate),
    field("or the column of its times", column), button("Go on", answer, { class: "run" }));
}

function topicChoice(item, recording, changed) {
  const sound = recording.topics.filter(topic => !topic.why_not && topic.fields.length > 0).sort((a, b) => b.rows - a.rows);
  const named = topic => `${topic.name} (${topic.fields.length} fields, ${topic.rows} rows${topic.rate_hz ? `, ${numberText(topic.rate_hz)} Hz` : ""})`;
  const select = element("select", {}, ...sound.map(topic => element("option", { value: topic.name }, named(topic))));
  return element("div", { class: "asked" }, element("p", {}, "This log holds several streams. Choose the one to look at."),
    field("Stream", select), button("Go on", () => {
      item.reading.set("--topic", select.value);
      changed();
    }, { class: "run" }));
}

/** What was chosen for reading, each with a way back. */
function chosen(item, changed) {
  const told = [...[...item.reading].map(([flag, value]) => [[flag, value], () => item.reading.delete(flag)]),
    ...[...item.units].map(([name, unit]) => [["--unit", `${listed(name)}=${unit}`], () => item.units.delete(name)])];
  const rows = told.map(([option, takeBack]) => {
    const words = optionWords([option]).map(shellWord).join(" ");
    return element("li", {}, element("code", {}, words), button("Take back", () => {
      takeBack();
      changed();
    }, { "aria-label": `Take back ${words}` }));
  });
  return rows.length > 0 ? element("ul", { class: "seen" }, ...rows) : null;
}

/** All that says how a recording is read: of one that was refused, or is meant otherwise. */
function readingOptions(item, changed) {
  const asked = verbOf("inspect").options.filter(({ group, flags }) => group.startsWith("Reading") && !flags.some(flag => NOT_ASKED.has(flag)));
  const again = () => {
    for (const [flag, value] of item.reading) if (!value) item.reading.delete(flag);
    changed();
  };
  return element("details", {}, element("summary", {}, "Say how it is read"), ...optionGroups(asked, item.reading, () => {}), button("Read it again", again, { class: "run" }));
}

/** What has to be said of a recording before anything can be made of it. */
const lacksStream = ({ recording }) => recording !== null && recording.channels.length === 0 && (recording.topics || []).length > 0;
const lacksRate = ({ recording }) => recording !== null && !recording.rate_hz && recording.rows > 1;

/** The inside of an item's card. */
function inspectionView(item, changed) {
  const { recording } = item;
  const parts = [element("p", { class: "facts" }, facts(recording))];
  if (lacksStream(item)) return [...parts, topicChoice(item, recording, changed), chosen(item, changed)];
  if (lacksRate(item)) parts.push(rateQuestion(item, recording, changed));
  parts.push(channelTable(item, recording, changed));
  const found = [...(item.warnings || []).map(one => [one, ""]), ...recording.channels.flatMap(channel => channel.findings.map(one => [one, channel.name]))];
  const press = set => {
    applyRemedy(set, item.reading, item.units);
    changed();
  };
  if (found.length > 0) parts.push(element("ul", { class: "seen" }, ...found.map(([one, subject]) => findingLine(one, subject, press))));
  return [...parts, chosen(item, changed), readingOptions(item, changed)];
}

/** Words that read logs as they were described, by what a verb can be told; `more`: what the use itself says, which wins. */
function toldWords(verb, logs, more = []) {
  const known = new Set(verbOf(verb).options.flatMap(({ flags }) => flags)), options = new Map(), units = new Map();
  for (const { reading, units: own } of logs) {
    for (const [flag, value] of reading) if (known.has(flag)) applyRemedy([{ flag, value }], options);
    for (const [name, unit] of own) units.set(listed(name), unit);
  }
  options.set("--unit", [...units].map(([name, unit]) => `${name}=${unit}`).join(","));
  for (const [flag, value] of more) if (value || !options.has(flag)) options.set(flag, value);
  return optionWords(options);
}
