// Commands as lists of words, and as a person types them.
"use strict";

/** A word of sh and its relatives. */
const shellWord = word => /^[A-Za-z0-9_@%+=:,./-]+$/.test(word) ? word : "'" + word.replaceAll("'", "'\\''") + "'";

/** "fleet-plan" is typed as two words. */
const typed = verb => verb.split("-");

const shellCommand = words => ["sensorchar", ...words].map(shellWord).join(" ");

/** Does a pattern mean a name? "?" is any character. */
const means = (pattern, name) => pattern.length === name.length && [...pattern].every((c, i) => c === "?" || c === name[i]);

/** A channel in a list of them: what would end a name there stands as a ?, which is any character. `among`: all channels, in their order;
 * where the pattern means another one too, the position says which. */
function listed(channel, among = []) {
  const pattern = channel.replace(/[,=!]/g, "?");
  return pattern !== channel && among.some(name => name !== channel && means(pattern, name)) ? `c${among.indexOf(channel)}` : pattern;
}

/** Values of options that list them, together; of a name that both give one, the later. */
function together(before, later) {
  const name = part => part.split("=")[0], parts = later.split(","), named = new Set(parts.map(name));
  return [...before.split(",").filter(part => !named.has(name(part))), ...parts].join(",");
}

/** Words of options that were set: a Map of flag → value, true for a flag without one. */
function optionWords(options) {
  const words = [];
  for (const [flag, value] of options) {
    if (value === "" || value === false || value === undefined) continue;
    if (value === true) words.push(flag);
    else if (String(value).startsWith("-")) words.push(`${flag}=${value}`);
    else words.push(flag, String(value));
  }
  return words;
}

/** `rate_hz` in a sentence of the library is --rate to who types commands. */
const withFlags = (text, settings) => text.replace(/`([a-z_]+)`/g, (all, name) => settings[name] || all);

const stem = name => name.split("/").pop().replace(/^-+/, "").replace(/\.(csv|tsv|txt)?(\.(gz|xz|zst|bz2))?$/i, "").replace(/\.[A-Za-z0-9]{1,5}$/, "") || "log";
