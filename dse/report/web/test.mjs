// Bundles test/*.test.ts, which strips their types in every version of Node, and runs them with Node's own test runner.
import { spawnSync } from "node:child_process";
import { readdirSync, rmSync } from "node:fs";
import { build } from "esbuild";

const folder = "node_modules/.test";
const names = readdirSync("test").filter((name) => name.endsWith(".test.ts"));
rmSync(folder, { recursive: true, force: true });
await build({
  entryPoints: names.map((name) => `test/${name}`),
  inject: ["test/browser.ts"],
  outdir: folder,
  outExtension: { ".js": ".mjs" },
  bundle: true,
  format: "esm",
  platform: "node",
  target: "node18",
  sourcemap: "inline",
  logLevel: "warning",
});
const files = names.map((name) => `${folder}/${name.replace(/ts$/, "mjs")}`);
const { status } = spawnSync(process.execPath, ["--enable-source-maps", "--test", ...files], { stdio: "inherit" });
process.exit(status ?? 1);
