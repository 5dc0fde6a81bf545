"use strict";
// The extension against stand-ins for the editor and its client library: what it starts, when it
// starts it again, and what it says when that fails. No packages are needed.
const assert = require("node:assert/strict");
const Module = require("node:module");
const path = require("node:path");
const test = require("node:test");

const settings = {};
const commands = {};
const told = [];
const clients = [];
let whenChanged;
let failing = false;

class LanguageClient {
  constructor(id, name, server, options) {
    Object.assign(this, { id, name, server, options, started: 0, stopped: 0 });
    clients.push(this);
  }
  async start() {
    if (failing) throw new Error("spawn ENOENT");
    this.started += 1;
  }
  async stop() {
    this.stopped += 1;
  }
}

const stands = {
  vscode: {
    workspace: {
      getConfiguration: () => ({ get: (key) => settings[key] }),
      onDidChangeConfiguration: (handler) => ((whenChanged = handler), { dispose() {} }),
    },
    commands: { registerCommand: (name, handler) => ((commands[name] = handler), { dispose() {} }) },
    window: { showErrorMessage: (text) => told.push(text) },
  },
  "vscode-languageclient/node": { LanguageClient },
};
const load = Module._load;
Module._load = (name, ...rest) => stands[name] ?? load(name, ...rest);

const root = path.join(__dirname, "..");
const extension = require(path.join(root, "extension.js"));
const manifest = require(path.join(root, "package.json"));

test("it starts `rmlcell lsp` for both languages of the manifest", async () => {
  const context = { subscriptions: [] };
  await extension.activate(context);
  assert.equal(clients.length, 1);
  assert.deepEqual(clients[0].server, { command: "rmlcell", args: ["lsp"] });
  assert.equal(clients[0].started, 1);
  const served = new Set(clients[0].options.documentSelector.map((one) => one.language));
  assert.deepEqual([...served].sort(), manifest.contributes.languages.map((one) => one.id).sort());
  assert.equal(context.subscriptions.length, 2);
});

test("another command in the settings starts another server", async () => {
  settings.command = "/opt/rmlcell/bin/rmlcell";
  await whenChanged({ affectsConfiguration: (name) => name === "editor.fontSize" });
  assert.equal(clients.length, 1);
  await whenChanged({ affectsConfiguration: (name) => name === "rmlcell.command" });
  assert.equal(clients[0].stopped, 1);
  assert.equal(clients[1].server.command, "/opt/rmlcell/bin/rmlcell");
});

test("a server that does not start is told, and can be started later", async () => {
  failing = true;
  await commands["rmlcell.restart"]();
  assert.equal(told.length, 1);
  assert.match(told[0], /rmlcell\.command/);
  failing = false;
  await commands["rmlcell.restart"]();
  assert.equal(clients.at(-1).started, 1);
  await extension.deactivate();
  assert.equal(clients.at(-1).stopped, 1);
});

test("every file and command that the manifest names is there", () => {
  const fs = require("node:fs");
  const files = [
    manifest.main,
    ...manifest.contributes.grammars.map((one) => one.path),
    ...manifest.contributes.languages.flatMap((one) => one.configuration ?? []),
  ];
  for (const file of files) assert.ok(fs.existsSync(path.join(root, file)), file);
  for (const { command } of manifest.contributes.commands) assert.ok(commands[command], command);
});
