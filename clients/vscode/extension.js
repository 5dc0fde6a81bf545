"use strict";
// Starts `rmlcell lsp` for part programs and leaves the rest to it.
const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

const LANGUAGES = ["optimo-rml", "rml1"];
let client;

function makeClient() {
  const command = vscode.workspace.getConfiguration("rmlcell").get("command") || "rmlcell";
  const server = { command, args: ["lsp"] };
  const options = {
    documentSelector: LANGUAGES.flatMap((language) => [
      { scheme: "file", language },
      { scheme: "untitled", language },
    ]),
  };
  return new LanguageClient("rmlcell", "rmlcell", server, options);
}

async function start() {
  const made = makeClient();
  try {
    await made.start();
    client = made;
  } catch (error) {
    vscode.window.showErrorMessage(
      `rmlcell: the language server does not start (${error.message}). Set rmlcell.command to the path of the command.`,
    );
  }
}

async function stop() {
  const ending = client;
  client = undefined;
  if (ending) await ending.stop();
}

async function restart() {
  await stop();
  await start();
}

async function activate(context) {
  context.subscriptions.push(
    vscode.commands.registerCommand("rmlcell.restart", restart),
    vscode.workspace.onDidChangeConfiguration((change) => {
      if (change.affectsConfiguration("rmlcell.command")) return restart();
    }),
  );
  await start();
}

module.exports = { activate, deactivate: stop };
