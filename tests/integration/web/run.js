// Independent clients against the web port of a running server: Connect JSON, Connect binary, gRPC-Web
// (two implementations), and server-sent events as an EventSource reads them. README.md says how to call it.
import { execFileSync } from "node:child_process";
import { copyFileSync, existsSync, mkdtempSync, mkdirSync, readdirSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const url = (process.env.RMLCELL_WEB_URL ?? "").replace(/\/$/, "");
if (!url) {
  console.error("RMLCELL_WEB_URL is not set: give it the address of the web port");
  process.exit(2);
}

// Generated code is made anew from proto/ at each run, so it can never be out of date. It lives beside
// a link to node_modules, where its imports are found.
const work = mkdtempSync(join(tmpdir(), "rmlcell-web-"));
process.on("exit", () => rmSync(work, { recursive: true, force: true }));
const generated = join(work, "gen");
mkdirSync(generated);
const modules = process.env.RMLCELL_NODE_MODULES ?? join(here, "node_modules");
if (!existsSync(modules)) {
  console.error(`no ${modules}: run npm ci in ${here}`);
  process.exit(2);
}
symlinkSync(modules, join(work, "node_modules"));
writeFileSync(join(work, "package.json"), '{"type":"module"}');
const proto = join(here, "../../../proto");
execFileSync("protoc", ["-I", proto, `--plugin=${join(work, "node_modules/.bin/protoc-gen-es")}`,
  `--es_out=${generated}`, "--es_opt=target=js,import_extension=js",
  ...readdirSync(join(proto, "rmlcell/v1")).map((name) => `rmlcell/v1/${name}`),
  "google/api/field_behavior.proto", "google/rpc/status.proto", "google/rpc/error_details.proto",
  "grpc/health/v1/health.proto"], { stdio: "inherit" });

// The clients run from there too, so that they and the generated code share one copy of each package.
for (const file of ["clients.js", "xhr.js", "events.js"]) copyFileSync(join(here, file), join(work, file));
const { declareTests } = await import(pathToFileURL(join(work, "clients.js")));
const tests = [];
await declareTests(url, process.env.RMLCELL_WEB_JOB, (name, body) => tests.push({ name, body }));
if (!process.env.RMLCELL_WEB_JOB) console.log("without RMLCELL_WEB_JOB: the event streams of a finished job are left out");

let failed = 0;
for (const { name, body } of tests) {
  const patience = new Promise((_, reject) => setTimeout(() => reject(new Error("took more than 60 s")), 60000).unref());
  try {
    await Promise.race([body(), patience]);
    console.log(`ok      ${name}`);
  } catch (error) {
    failed += 1;
    console.log(`FAILED  ${name}: ${error.stack ?? error}`);
  }
}
console.log(`${tests.length - failed} passed, ${failed} failed`);
process.exit(failed ? 1 : 0);
