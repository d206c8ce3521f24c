// Commands as lists of words, and as a person types them.
"use strict";

/** A word of sh and its relatives. */
const shellWord = word => /^[A-Za-z0-9_@%+=:,./-]+$/.test(word) ? word : "'" + word.replaceAll("'", "'\\''") + "'";

/** "fleet-plan" is typed as two words. */
const typed = verb => verb.split("-");

const shellCommand = words => ["sensorchar", ...words].map(shellWord).join(" ");

/** A channel in a list of them: what would end a name there stands as a ?, which is any character. */
const listed = channel => channel.replace(/[,=!]/g, "?");

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
