// What can be done with what is there. A use makes the words of one command; its fields come from the description of the verb.
"use strict";

const isLog = item => item.kind === "log" && item.recording && item.recording.channels.length > 0;
const names = items => items.map(({ name }) => name);
const folderOf = path => path.includes("/") ? path.slice(0, path.lastIndexOf("/")) : path;

/** Results of characterize and replay, and what was dropped of that kind. */
const reportsOf = bench => bench.subjects.filter(({ kind }) => kind === "report" || kind === "replay");
const modelsOf = bench => bench.subjects.filter(({ kind }) => kind === "model" || kind === "report");
const entriesOf = subjects => subjects.map(({ name }) => [name, name]);
const first = (entries, wanted) => entries.some(({ name }) => name === wanted) ? wanted : entries[0].name;

/** Channels that one axis can have: of unlike units, the first. */
const drawable = channels => new Set(channels.map(({ unit }) => unit)).size > 1 ? listed(channels[0].name) : "";

/** The first figure of a report. */
function figureWords(bench, source) {
  const channel = drawable(bench.subjects.find(({ name }) => name === source).channels);
  return ["plot", source, ...optionWords([["--channel", channel]]), "-o", bench.free(`${stem(source)}.svg`)];
}

/** The most channels of one unit: what may be sensors of one quantity. */
function alike(log) {
  const groups = new Map();
  for (const { name, unit } of log.recording.channels) groups.set(unit, [...(groups.get(unit) || []), name]);
  return [...groups.values()].sort((a, b) => b.length - a.length)[0];
}

const arraysOf = bench => bench.logs.filter(log => alike(log).length > 1);

const characterizeWords = (logs, use, out) => ["characterize", ...names(logs), ...toldWords(use.verb, logs, use.values), "-o", out];
/** What `compare` can hold against each other: of sensors anything, of replays nothing but replays. `begin`: what was dropped, else what was made. */
function sidesOf(bench) {
  const isReplay = ({ kind }) => kind === "replay", dropped = new Set(names(bench.items));
  const reports = names(bench.subjects.filter(one => !isReplay(one))), replays = names(bench.subjects.filter(isReplay));
  const sensors = [...new Set([...names(bench.logs), ...names(bench.tables), ...reports])]; // a table of curves is no recording
  const begin = [sensors.filter(name => dropped.has(name)), reports, replays].find(sides => sides.length > 1);
  return { all: [...sensors, ...replays], begin };
}

const TABLES = [["md", "Markdown", []], ["tex", "LaTeX", ["--latex"]], ["csv", "CSV", ["--csv"]]];

const base = { main: [], hidden: [] };

const USES = [
  {
    ...base, id: "characterize", label: "Characterize", verb: "characterize",
    folded: true, main: [["--still", "Only a still stretch"], ["--data", "What the samples are"], ["--verify", "Check by simulation"], ["--limits", "Limits of a data sheet"]],
    hidden: ["--lot", "--unit"],
    fits: bench => bench.logs.length > 0,
    words: (bench, use) => characterizeWords(bench.logs, use, bench.free(bench.logs.length === 1 ? `${stem(bench.logs[0].name)}-report` : "reports")),
    /** One after the other on a command line, side by side here; pooled, they are one. */
    jobs: (bench, use) => {
      if (bench.logs.length === 1 || use.values.get("--pool")) return [use.words(bench, use)];
      const folder = bench.free("reports"), taken = new Set();
      return bench.logs.map(log => {
        const inside = freeName(stem(log.name), taken);
        taken.add(inside);
        return characterizeWords([log], use, `${folder}/${inside}`);
      });
    },
  },
  {
    ...base, id: "compare", label: "Which one?", verb: "compare", made: true, main: [["--channel", "Channels"], ["--still", "Only a still stretch"], ["--limits", "Limits of a data sheet"]],
    hidden: ["--unit", "--markdown", "--latex", "--csv"],
    fits: bench => sidesOf(bench).begin !== undefined,
    choices: (bench, use, changed) => {
      const { all, begin } = sidesOf(bench);
      if (use.begin !== begin.join()) Object.assign(use, { begin: begin.join(), inputs: new Set(begin) });
      return [choices("Compare", all, use.inputs, changed)];
    },
    words: (bench, use) => ["compare", ...use.inputs, ...toldWords(use.verb, bench.logs.filter(({ name }) => use.inputs.has(name)), use.values),
      "-o", bench.free("which.html")],
  },
  {
    ...base, id: "lot", label: "A lot of one kind", verb: "characterize", hidden: ["--lot", "--pool", "--unit"],
    fits: bench => bench.logs.length > 1,
    words: (bench, use) => [...characterizeWords(bench.logs, use, bench.free("lot")), "--lot"],
  },
  {
    ...base, id: "replay", label: "An array: best fusion", verb: "replay",
    main: [["--learning", "Learning window"], ["--align", "Align the sensors first"]], hidden: ["--sensors", "--reference", "--unit"],
    fits: bench => arraysOf(bench).length > 0 || bench.scenes.length > 0,
    choices: (bench, use, changed) => {
      const sources = [...bench.scenes, ...arraysOf(bench)];
      if (use.source !== first(sources, use.source)) use.sensors = null;
      use.source = first(sources, use.source);
      const log = bench.logs.find(({ name }) => name === use.source);
      const parts = [choice("Recording or scene", entriesOf(sources), use.source, value => {
        use.source = value;
        use.sensors = null;
        changed(true);
      })];
      if (!log) return parts;
      const channels = log.recording.channels.map(({ name }) => name);
      use.sensors = use.sensors || new Set(alike(log));
      return [...parts, choices("Sensors of one quantity", channels, use.sensors, changed), choice("Reference, if one channel is the truth",
        [["", "none"], ...channels.map(name => [name, name])], use.reference || "", value => {
          use.reference = value;
          use.sensors.delete(value);
          changed(true);
        })];
    },
    words: (bench, use) => {
      const log = bench.logs.find(({ name }) => name === use.source);
      const channels = log && !log.reading.has("--channel") ? log.recording.channels.map(({ name }) => name) : []; // positions are those of all
      const array = log ? [["--sensors", [...use.sensors].map(name => listed(name, channels)).join(",")], ["--reference", use.reference && listed(use.reference, channels)]] : [];
      return ["replay", use.source, ...toldWords(use.verb, log ? [log] : [], [...array, ...use.values]), "-o", bench.free(`${stem(use.source)}-replay`)];
    },
  },
  {
    ...base, id: "fuse", label: "Fuse by a replay", verb: "fuse", made: true, main: [["--algorithm", "Method"], ["--fault-free", "Time without a fault"]],
    hidden: ["--with", "--unit"],
    fits: bench => bench.logs.length > 0 && bench.fusions.length > 0,
    choices: (bench, use, changed) => {
      const take = key => value => {
        use[key] = value;
        changed();
      };
      use.source = first(bench.logs, use.source);
      use.by = first(bench.fusions, use.by);
      return [choice("Recording", entriesOf(bench.logs), use.source, take("source")), choice("By", entriesOf(bench.fusions), use.by, take("by"))];
    },
    words: (bench, use) => ["fuse", use.source, ...toldWords(use.verb, [bench.logs.find(({ name }) => name === use.source)], [["--with", use.by], ...use.values]), "-o", bench.free(`${stem(use.source)}-fused.csv`)],
  },
  {
    ...base, id: "model", label: "Export for Kalibr, ROS …", verb: "model", made: true, main: [["--axes", "Axes"]], hidden: ["--to"],
    fits: bench => modelsOf(bench).length > 0,
    choices: (bench, use, changed) => {
      const models = modelsOf(bench);
      use.source = first(models, use.source);
      use.to = use.to || TARGETS[0].name;
      return [choice("Models of", entriesOf(models), use.source, value => {
        use.source = value;
        changed();
      }), choice("For", TARGETS.map(({ name, title, file }) => [name, `${title}: ${file}`]), use.to, value => {
        use.to = value;
        changed();
      })];
    },
    words: (bench, use) => ["model", use.source, "--to", use.to, ...optionWords(use.values), "-o", bench.free(TARGETS.find(({ name }) => name === use.to).file)],
  },
  {
    ...base, id: "plot", label: "Figure", verb: "plot", made: true,
    main: [["--kind", "Figure"], ["--channel", "Channels"], ["--width", "Width"]], hidden: ["--csv", "--format", "--dpi"],
    fits: bench => bench.subjects.length > 0,
    choices: (bench, use, changed) => {
      const before = use.source;
      use.source = first(bench.subjects, use.source);
      const { channels } = bench.subjects.find(({ name }) => name === use.source);
      // Unlike units share no axis: one channel, then.
      if (use.source !== before) use.values.set("--channel", drawable(channels));
      return [choice("Of", entriesOf(bench.subjects), use.source, value => {
        use.source = value;
        use.values.set("--channel", "");
        changed(true);
      })];
    },
    words: (bench, use) => ["plot", use.source, ...optionWords(use.values), "-o", bench.free(`${stem(use.source)}${use.values.get("--kind") ? `-${use.values.get("--kind")}` : ""}.svg`)],
  },
  {
    ...base, id: "table", label: "Table of a report", verb: "report", made: true, main: [["--channel", "Channels"]], hidden: ["--markdown", "--latex", "--csv"],
    fits: bench => reportsOf(bench).length > 0,
    choices: (bench, use, changed) => {
      const take = key => value => {
        use[key] = value;
        changed();
      };
      use.source = first(reportsOf(bench), use.source);
      use.as = use.as || TABLES[0][0];
      return [choice("Of", entriesOf(reportsOf(bench)), use.source, take("source")),
        choice("As", TABLES.map(([end, title]) => [end, title]), use.as, take("as"))];
    },
    words: (bench, use) => ["report", use.source, ...TABLES.find(([end]) => end === (use.as || TABLES[0][0]))[2], ...optionWords(use.values),
      "-o", bench.free(`${stem(use.source)}.${use.as || TABLES[0][0]}`)],
  },
  {
    ...base, id: "show", label: "Show a model", verb: "model", made: true, main: [["--axes", "Axes"]], hidden: ["--to"],
    fits: bench => bench.models.length > 0,
    choices: (bench, use, changed) => {
      use.source = first(bench.models, use.source);
      return [choice("Model", entriesOf(bench.models), use.source, value => {
        use.source = value;
        changed();
      })];
    },
    words: (bench, use) => ["model", use.source, ...optionWords(use.values)],
  },
  {
    ...base, id: "simulate", label: "Simulate", verb: "simulate", made: true,
    main: [["--duration", "Length"], ["--devices", "Devices"], ["--truth", "True input"], ["--seed", "Seed"]], hidden: ["--scene", "--no-scene"],
    fits: bench => bench.models.length > 0 || bench.scenes.length > 0,
    choices: (bench, use, changed) => {
      const sources = [...bench.models, ...bench.scenes];
      use.source = first(sources, use.source);
      if (!use.values.has("--duration") && !bench.scenes.some(({ name }) => name === use.source)) use.values.set("--duration", "10min");
      return [choice("Model or scene", entriesOf(sources), use.source, value => {
        use.source = value;
        changed();
      })];
    },
    words: (bench, use) => ["simulate", use.source, ...optionWords(use.values), "-o", bench.free(`${stem(use.source.replace(".sensor", ""))}-simulated.csv`)],
  },
  {
    ...base, id: "fit", label: "Curve of a data sheet", verb: "fit", main: [["--curve", "The table is"], ["--duration", "Length of its recording"]],
    hidden: ["--models", "--unit"],
    fits: bench => bench.tables.length > 0,
    choices: (bench, use, changed) => {
      use.source = first(bench.tables, use.source);
      if (!use.values.get("--curve")) use.values.set("--curve", "allan");
      return [choice("Table: averaging time or frequency, then values", entriesOf(bench.tables), use.source, value => {
        use.source = value;
        changed();
      })];
    },
    words: (bench, use) => ["fit", use.source, ...optionWords(use.values), "--models", bench.free(`${stem(use.source)}-models`)],
  },
  {
    ...base, id: "convert", label: "Convert", verb: "convert", main: [["--dtype", "Numbers"]], hidden: ["--unit", "--as"],
    fits: bench => bench.logs.length > 0,
    choices: (bench, use, changed) => {
      const take = key => value => {
        use[key] = value;
        changed();
      };
      use.source = first(bench.logs, use.source);
      use.to = use.to || "csv";
      return [choice("Recording", entriesOf(bench.logs), use.source, take("source")), choice("To", [["csv", "CSV"], ["npy", "NumPy"]], use.to, take("to"))];
    },
    words: (bench, use) => ["convert", use.source, ...toldWords(use.verb, [bench.logs.find(({ name }) => name === use.source)], use.values),
      "-o", bench.free(`${stem(use.source)}-converted.${use.to || "csv"}`)],
  },
].map(use => ({ ...use, values: new Map() }));
