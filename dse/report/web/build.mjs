// Bundles src/ into dist/report.js and dist/report.css, which dse puts into every report.

import { existsSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import { build } from "esbuild";

const common = { bundle: true, minify: true, charset: "ascii", legalComments: "none", logLevel: "warning" };

const code = { ...common, format: "iife", target: "es2022", metafile: true };
const script = await build({ ...code, entryPoints: ["src/main.ts"], outfile: "dist/report.js" });
// What its workers do, where it simulates by itself; of no library.
const worker = await build({ ...code, entryPoints: ["src/simulate/worker.ts"], outfile: "dist/simulate.js" });
// Pages of the server around the reports; of no library.
await build({ ...code, entryPoints: ["src/serve.ts"], outfile: "dist/serve.js" });
await build({ ...common, entryPoints: ["src/style/serve.css"], outfile: "dist/serve.css" });
await build({ ...common, entryPoints: ["src/style/report.css"], outfile: "dist/report.css" });

// A run in three dimensions, a page of its own.
const scene = await build({ ...code, entryPoints: ["src/scene.ts"], outfile: "dist/scene.js" });
await build({ ...common, entryPoints: ["src/style/scene.css"], outfile: "dist/scene.css" });
// The test drive.
const drive = await build({ ...code, entryPoints: ["src/drive.ts"], outfile: "dist/drive.js" });
await build({ ...common, entryPoints: ["src/style/drive.css"], outfile: "dist/drive.css" });

for (const [file, { metafile }] of [
  ["dist/report.js", script],
  ["dist/simulate.js", worker],
  ["dist/scene.js", scene],
  ["dist/drive.js", drive],
]) {
  const text = readFileSync(file, "utf8") + licences(Object.keys(metafile.inputs));
  if (/<\/script|<!--/i.test(text)) throw new Error(`${file} could not stand inside a script element`);
  writeFileSync(file, text);
}

// The libraries' licences ask that their text goes where their code goes.
function licences(inputs) {
  const packages = new Set(inputs.map((path) => /node_modules\/((?:@[^/]+\/)?[^/]+)/.exec(path)?.[1]).filter(Boolean));
  const texts = new Map();
  for (const name of [...packages].sort()) {
    const folder = `node_modules/${name}`;
    const file = readdirSync(folder).find((entry) => /^licen[cs]e/i.test(entry));
    const licence = file && existsSync(`${folder}/${file}`) ? readFileSync(`${folder}/${file}`, "utf8").trim() : "";
    if (!licence) throw new Error(`${name} is bundled but carries no licence text`);
    texts.set(licence, [...(texts.get(licence) ?? []), name]);
  }
  if (!texts.size) return "";
  const parts = [...texts].map(([licence, names]) => `${names.join(", ")}\n\n${licence}`);
  return `\n/*!\n${parts.join("\n\n----\n\n").replaceAll("*/", "* /")}\n*/\n`;
}
