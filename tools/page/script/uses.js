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

const base = { main: [], hidden: [] };

const USES = [
  {
    ...base, id: "characterize", label: "Characterize", verb: "characterize",
    folded: true, main: [["--still", "Only a still stretch"], ["--data", "What the samples are"], ["--verify", "Check by simulation"], ["--limits", "Limits of a data sheet"]],
    hidden: ["--lot", "--unit"],
    fits: bench => bench.logs.length > 0,
    words: (bench, use) => {
      const out = bench.logs.length === 1 ? `${stem(bench.logs[0].name)}-report` : "reports";
      return ["characterize", ...names(bench.logs), ...readingWords(bench.logs[0]), ...optionWords(use.values), "-o", bench.free(out)];
    },
  },
  {
    ...base, id: "lot", label: "Compare devices: which one?", verb: "characterize", hidden: ["--lot", "--pool", "--unit"],
    fits: bench => bench.logs.length > 1,
    words: (bench, use) => ["characterize", ...names(bench.logs), ...readingWords(bench.logs[0]), ...optionWords(use.values), "--lot", "-o", bench.free("lot")],
  },
  {
    ...base, id: "compare", label: "Compare two reports", verb: "compare", made: true,
    fits: bench => reportsOf(bench).length > 1,
    choices: (bench, use, changed) => {
      const reports = reportsOf(bench), take = key => value => {
        use[key] = value;
        changed();
      };
      use.a = first(reports, use.a);
      use.b = use.b && use.b !== use.a ? first(reports, use.b) : reports.find(({ name }) => name !== use.a).name;
      return [choice("First", entriesOf(reports), use.a, take("a")), choice("Second", entriesOf(reports), use.b, take("b"))];
    },
    words: (bench, use) => ["compare", use.a, use.b, ...optionWords(use.values)],
  },
  {
    ...base, id: "replay", label: "An array: best fusion", verb: "replay",
    main: [["--learning", "Learning window"], ["--align", "Align the sensors first"]], hidden: ["--sensors", "--reference", "--unit"],
    fits: bench => bench.logs.some(log => log.recording.channels.length > 1) || bench.scenes.length > 0,
    choices: (bench, use, changed) => {
      const sources = [...bench.scenes, ...bench.logs.filter(log => log.recording.channels.length > 1)];
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
      use.sensors = use.sensors || new Set(channels);
      return [...parts, choices("Sensors of one quantity", channels, use.sensors, changed), choice("Reference, if one channel is the truth",
        [["", "none"], ...channels.map(name => [name, name])], use.reference || "", value => {
          use.reference = value;
          use.sensors.delete(value);
          changed(true);
        })];
    },
    words: (bench, use) => {
      const log = bench.logs.find(({ name }) => name === use.source);
      const array = log ? [...readingWords(log), "--sensors", [...use.sensors].join(","), ...(use.reference ? ["--reference", use.reference] : [])] : [];
      return ["replay", use.source, ...array, ...optionWords(use.values), "-o", bench.free(`${stem(use.source)}-replay`)];
    },
  },
  {
    ...base, id: "model", label: "Export for a consumer", verb: "model", made: true, main: [["--axes", "Axes"]], hidden: ["--to"],
    fits: bench => modelsOf(bench).length > 0,
    choices: (bench, use, changed) => {
      const models = modelsOf(bench);
      use.source = first(models, use.source);
      use.to = use.to || TARGETS[0].name;
      return [choice("Models of", entriesOf(models), use.source, value => {
        use.source = value;
        changed();
      }), choice("For", TARGETS.map(({ name, title }) => [name, title]), use.to, value => {
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
      if (use.source !== before) use.values.set("--channel", new Set(channels.map(({ unit }) => unit)).size > 1 ? channels[0].name : "");
      return [choice("Of", entriesOf(bench.subjects), use.source, value => {
        use.source = value;
        use.values.set("--channel", "");
        changed(true);
      })];
    },
    words: (bench, use) => ["plot", use.source, ...optionWords(use.values), "-o", bench.free(`${stem(use.source)}${use.values.get("--kind") ? `-${use.values.get("--kind")}` : ""}.svg`)],
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
    ...base, id: "fit", label: "Curve of a data sheet", verb: "fit", main: [["--curve", "The table is"], ["--duration", "Length of the record behind it"]],
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
].map(use => ({ ...use, values: new Map() }));
