// What a finding's remedy sets: options of the program, of the recording that it was found in or of the use that found it.
"use strict";

const ADDED = new Set(["--missing", "--scale"]); // one value does not take back another one

/** NAME=VALUE of the library, which splits no lists: the name may hold anything. */
function namedValue(text) {
  const at = text.lastIndexOf("=");
  return [text.slice(0, at), text.slice(at + 1)];
}

/** [{flag, value, unit}]: what is set on the command line (`--bad-rows drop`: a flag with its value); null where a flag for some of it is not there.
 * `unit`: [name, unit] of a channel, which the page has fields for. */
function settingsOf(remedy) {
  const set = (remedy.options || []).map(({ option, value }) => {
    const [flag, fixed] = (USAGE.settings[option] || "").split(" ");
    if (option === "channels") return { flag, value: listed(value) };
    if (option === "channel_unit") return { flag, unit: namedValue(value), value };
    if (option === "channel_scale") {
      const [name, factor] = namedValue(value);
      return { flag, value: `${listed(name)}=${factor}` };
    }
    return { flag, value: fixed || value || true };
  });
  return set.length > 0 && set.every(({ flag }) => flag) ? set : null;
}

/** Sets it in what is told of a recording (item) or of a use. */
function applyRemedy(set, values, units) {
  for (const { flag, value, unit } of set) {
    if (unit && units) units.set(...unit);
    else values.set(flag, ADDED.has(flag) && values.get(flag) ? together(values.get(flag), value) : value);
  }
}

/** A finding with its remedies: those that are options are buttons, which `press` is told of. */
function findingLine(finding, subject, press) {
  const parts = [subject ? element("strong", {}, `${subject}: `) : null, ...unbroken(withFlags(finding.sentence, USAGE.settings))];
  for (const remedy of finding.remedies || []) {
    const set = settingsOf(remedy), sentence = withFlags(remedy.sentence, USAGE.settings);
    if (!set) {
      parts.push(" ", element("span", { class: "dim" }, ...unbroken(sentence)));
      continue;
    }
    const words = optionWords(set.map(({ flag, value }) => [flag, value])).map(shellWord).join(" ");
    parts.push(button(sentence.replace(/[.]$/, ""), () => press(set)), " ", element("code", {}, ...unbroken(words)));
  }
  return element("li", { class: finding.severity }, ...parts);
}

/** What a report found and options can mend, but for what `known` tells of already: [{finding, subject}]. */
function mendable(report, known = []) {
  const all = [...[report.findings].flat().map(finding => ({ finding, subject: "" })),
    ...[report.summary && report.summary.channels].flat().flatMap(channel => [channel && channel.findings].flat().map(finding => ({ finding, subject: channel && channel.name })))];
  const key = ({ code, sentence }) => `${code} ${sentence}`, told = new Set(known.map(key));
  return all.filter(({ finding }) => finding && (finding.remedies || []).some(settingsOf) && !told.has(key(finding)));
}
