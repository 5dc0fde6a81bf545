// The live page: one event stream (rmlcell.v1.CellService/WatchCell) shows all machines and jobs. A browser
// opens only six connections to a host, over all its tabs, so this page never opens a second stream.
// Text from the server only ever becomes text nodes.
"use strict";

const SUBSCRIPTIONS = [
  { id: "jobs", jobs: { withoutSignals: true } },
  { id: "machines", machines: {} },
];
const WATCH = `/rmlcell.v1.CellService/WatchCell?message=${encodeURIComponent(JSON.stringify({ subscriptions: SUBSCRIPTIONS }))}`;
const RETRY_MS = [1000, 2000, 4000, 8000, 15000]; // then again and again the last
const CALL_MS = 15000; // patience for one answer
const FINISHED_SHOWN = 200;

const jobs = new Map(); // by name
const progress = new Map(); // by name of the job
const rows = new Map(); // by name of the job: the elements of its row
const machines = new Map(); // by name
let filter = "all";
let retries = 0;

const byId = (id) => document.getElementById(id);

function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

// Writes only what differs, so that a selection or the focus stays where it is.
function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

// --- the stream -----------------------------------------------------------------------------------------

function showLink(state, text) {
  const link = byId("link");
  link.dataset.state = state;
  setText(link, text);
}

function connect() {
  const source = new EventSource(WATCH);
  let over = false;

  const again = (why) => {
    if (over) return;
    over = true;
    source.close();
    const wait = RETRY_MS[Math.min(retries++, RETRY_MS.length - 1)];
    showLink("lost", `${why} \u2013 trying again in ${Math.round(wait / 1000)} s`);
    setTimeout(connect, wait);
  };

  source.onmessage = (event) => {
    const message = JSON.parse(event.data);
    if (message.snapshot) {
      retries = 0;
      showLink("live", "Live");
      takeSnapshot(message.subscriptions, message.snapshot);
    } else if (message.event) {
      takeEvent(message.event);
    } else if (message.status) {
      const machine = machines.get(message.status.machine);
      if (machine) machine.status = message.status;
      scheduleDraw();
    } else if (message.progress) {
      progress.set(message.progress.job, message.progress);
      scheduleDraw();
    } else if (message.reconnect !== undefined) {
      again("The server is stopping");
    }
  };
  source.addEventListener("reconnect", () => again("The server is stopping"));
  source.addEventListener("end", () => again("The stream has ended"));
  source.addEventListener("error", (event) => {
    // Our own event has data; without, the browser lost the connection.
    if (event.data) again(`The server says: ${JSON.parse(event.data).message}`);
    else again("Connection lost");
  });
}

function takeSnapshot(subscriptions, snapshot) {
  if (subscriptions.includes("jobs")) {
    jobs.clear();
    progress.clear();
    for (const job of snapshot.jobs ?? []) jobs.set(job.name, job);
  } else {
    machines.clear();
    for (const machine of snapshot.machines ?? []) machines.set(machine.name, machine);
  }
  scheduleDraw();
}

function takeEvent(event) {
  if (event.job) takeJobEvent(event.job);
  if (event.jobDeleted) {
    jobs.delete(event.resource);
    progress.delete(event.resource);
  }
  const changed = event.machine?.changed;
  if (changed?.change === "RECORD_CHANGE_DELETED") machines.delete(event.resource);
  else if (changed) machines.set(event.resource, { ...changed.machine, status: machines.get(event.resource)?.status });
  scheduleDraw();
}

// What an event says about a job is little; what is not known from it is asked for.
function takeJobEvent(event) {
  const job = jobs.get(event.job);
  if (job && event.state) job.state = event.state;
  if (job && event.ended) {
    job.outcome = event.ended;
    job.state = ENDED[event.ended.kind] ?? "STATE_FAILED";
  }
  if (event.ended) progress.delete(event.job);
  if (!job || event.ended || event.productsMade || (event.state && isFinished(event.state))) refresh(event.job);
  scheduleDraw();
}

const asking = new Map(); // by name: whether to ask once more

async function refresh(name) {
  if (asking.has(name)) {
    asking.set(name, true);
    return;
  }
  asking.set(name, false);
  try {
    jobs.set(name, await call("JobService/GetJob", { name }));
    if (isFinished(jobs.get(name).state)) progress.delete(name);
    scheduleDraw();
  } catch {
    // The stream tells when the connection is gone; a snapshot follows.
  }
  const again = asking.get(name);
  asking.delete(name);
  if (again) refresh(name);
}

async function call(method, request) {
  const response = await fetch(`/rmlcell.v1.${method}`, {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify(request),
    signal: AbortSignal.timeout(CALL_MS),
  });
  const answer = await response.json();
  if (!response.ok) throw new Error(answer.message);
  return answer;
}

// --- words ----------------------------------------------------------------------------------------------

const STATES = {
  STATE_QUEUED: ["Queued", "wait"],
  STATE_RUNNING: ["Running", "run"],
  STATE_SUCCEEDED: ["Succeeded", "good"],
  STATE_FAILED: ["Failed", "bad"],
  STATE_CANCELLED: ["Cancelled", "off"],
  STATE_INTERRUPTED: ["Interrupted", "bad"],
};
// What the part will come out like says more than that a job was done.
const VERDICTS = {
  VERDICT_GOOD: ["Good", "good"],
  VERDICT_DOUBTFUL: ["Doubtful", "wait"],
  VERDICT_BAD: ["Bad", "bad"],
};
// No part, and nothing that went wrong.
const STOPPED = ["Stopped", "wait"];
const KINDS = { JOB_KIND_CHECK: "check", JOB_KIND_SIMULATE: "simulation", JOB_KIND_RUN: "run" };
const MACHINE_STATES = {
  MACHINE_STATE_OFF: ["Off", "off"],
  MACHINE_STATE_STARTING: ["Starting", "wait"],
  MACHINE_STATE_RECOVERING: ["Recovering", "wait"],
  MACHINE_STATE_NOT_ZEROED: ["Not zeroed", "wait"],
  MACHINE_STATE_IDLE: ["Idle", "off"],
  MACHINE_STATE_JOGGING: ["Jogging", "run"],
  MACHINE_STATE_RUNNING: ["Running", "run"],
  MACHINE_STATE_STOPPING: ["Stopping", "wait"],
  MACHINE_STATE_HELD: ["Held", "wait"],
  MACHINE_STATE_ALARM: ["Alarm", "bad"],
  MACHINE_STATE_INSPECT: ["Inspect", "bad"],
  MACHINE_STATE_LOST: ["Lost", "bad"],
};
const OUTCOMES = {
  KIND_COMPLETED: "Completed",
  KIND_STOPPED: "Stopped: it waits for START, and nothing gives it",
  KIND_FAILED: "Failed",
  KIND_CANCELLED: "Cancelled",
  KIND_BUDGET_EXCEEDED: "Budget exceeded",
  KIND_INTERRUPTED: "Interrupted: look where the machine stands",
};

const WAITS = {
  WAIT_REASON_WORKER: "Waits for a worker",
  WAIT_REASON_HELD: "Held back until somebody lets it go",
  WAIT_REASON_NOT_BEFORE: "Waits for its time",
  WAIT_REASON_AFTER_JOB: "Waits for",
  WAIT_REASON_AFTER_JOB_FAILED: "Somebody decides: it was to follow",
  WAIT_REASON_MACHINE_BUSY: "Its machine runs",
  WAIT_REASON_MACHINE_NOT_READY: "Its machine cannot start now",
  WAIT_REASON_CONTROL: "Its machine is not free,",
};
// Products that programs read, and people do not.
const FOR_PROGRAMS = ["steps", "series"];

// Until the job itself is read again.
const ENDED = { KIND_COMPLETED: "STATE_SUCCEEDED", KIND_CANCELLED: "STATE_CANCELLED", KIND_INTERRUPTED: "STATE_INTERRUPTED" };

const isFinished = (state) => state !== "STATE_QUEUED" && state !== "STATE_RUNNING";
const lastPart = (name) => (name ?? "").split("/").pop();
const numberOf = (job) => Number(lastPart(job.name)) || 0;

function titleOf(job) {
  if (job.title) return job.title;
  if (job.program) return `Program ${lastPart(job.program)}`;
  return job.inlineProgram?.fileName || "Untitled";
}

function placeText(place) {
  if (!place) return "";
  const parts = [];
  if (place.program) parts.push(`program ${place.program}`);
  if (place.step) parts.push(`step ${place.step}`);
  else if (place.line) parts.push(`line ${place.line}`);
  return parts.join(", ");
}

function duration(seconds) {
  if (seconds < 60) return `${seconds.toFixed(1)} s`;
  const whole = Math.round(seconds);
  const two = (n) => String(n).padStart(2, "0");
  const hours = Math.floor(whole / 3600);
  const minutes = Math.floor(whole / 60) % 60;
  return hours ? `${hours}:${two(minutes)}:${two(whole % 60)} h` : `${minutes}:${two(whole % 60)} min`;
}

function timeTexts(job) {
  const begun = job.startTime ?? job.createTime;
  if (!begun) return ["", "", ""];
  const date = new Date(begun);
  const today = date.toDateString() === new Date().toDateString();
  const shown = today ? date.toLocaleTimeString([], { hour12: false }) : date.toLocaleDateString();
  let note = job.startTime ? "" : "submitted";
  if (job.startTime && job.endTime) note = `took ${duration((new Date(job.endTime) - date) / 1000)}`;
  return [shown, note, date.toLocaleString()];
}

// --- drawing --------------------------------------------------------------------------------------------

let drawing = false;
function scheduleDraw() {
  if (drawing) return;
  drawing = true;
  requestAnimationFrame(() => {
    drawing = false;
    draw();
  });
}

const REASONS_SHOWN = 3;

const FILTERS = {
  all: () => true,
  active: (job) => !isFinished(job.state),
  failed: (job) => job.state === "STATE_FAILED" || job.state === "STATE_INTERRUPTED" ||
    job.outcome?.verdict === "VERDICT_BAD",
};

function draw() {
  const ordered = [...jobs.values()].sort((a, b) => numberOf(b) - numberOf(a));
  ordered.filter((job) => isFinished(job.state)).slice(FINISHED_SHOWN).forEach((job) => jobs.delete(job.name));
  const kept = ordered.filter((job) => jobs.has(job.name));
  drawMachines(kept);
  for (const button of document.querySelectorAll("[data-filter]")) {
    button.setAttribute("aria-pressed", String(button.dataset.filter === filter));
    setText(button.querySelector("span"), String(kept.filter(FILTERS[button.dataset.filter]).length));
  }
  const shown = kept.filter(FILTERS[filter]);
  drawRows(shown);
  byId("empty").hidden = shown.length > 0;
  setText(byId("empty"), kept.length ? "No such job." : "No jobs yet. Submit one with: rmlcell submit MACHINE FILE");
}

function drawMachines(all) {
  const list = byId("machines");
  const ordered = [...machines.values()].sort((a, b) => (a.name < b.name ? -1 : 1));
  const items = ordered.map((machine) => {
    const active = all.filter((job) => job.machine === machine.name && !isFinished(job.state)).length;
    const [word, tone] = MACHINE_STATES[machine.status?.state] ?? ["Unknown", "off"];
    const chip = element("span", { className: "chip" }, word);
    chip.dataset.tone = tone;
    const jobsText = active === 0 ? "no job" : active === 1 ? "1 job" : `${active} jobs`;
    return element("li", { className: "machine" },
      element("div", {}, element("strong", {}, machine.title || lastPart(machine.name)), chip),
      element("p", {}, `${lastPart(machine.name)} \u00b7 ${machine.family}${machine.profile ? ` ${machine.profile}` : ""}`),
      element("p", {}, `${machine.connection?.kind === "KIND_DEVICE" ? "Device" : "Virtual"} \u00b7 ${jobsText}`));
  });
  const text = items.map((item) => item.textContent).join("|");
  if (list.dataset.text === text) return;
  list.dataset.text = text;
  list.replaceChildren(...items);
}

function makeRow() {
  const row = {
    tr: element("tr"),
    title: element("div", { className: "title" }),
    sub: element("div", { className: "sub" }),
    machine: element("td"),
    chip: element("span", { className: "chip" }),
    outcome: element("td"),
    time: element("div"),
    took: element("div", { className: "sub" }),
    results: element("div", { className: "results" }),
    look: element("div", { className: "look" }),
    bar: element("progress", { max: 1 }),
    percent: element("span", { className: "number" }),
    where: element("div", { className: "sub" }),
  };
  row.barLine = element("div", { className: "progress" }, row.bar, row.percent);
  const job = element("div", { className: "job" }, row.look, element("div", {}, row.title, row.sub));
  row.tr.append(element("td", {}, job), row.machine, element("td", {}, row.chip), row.outcome,
    element("td", {}, row.time, row.took), element("td", {}, row.results));
  return row;
}

function drawRows(shown) {
  const body = byId("rows");
  const names = new Set(shown.map((job) => job.name));
  for (const [name, row] of rows) {
    if (names.has(name)) continue;
    row.tr.remove();
    rows.delete(name);
  }
  let before = body.firstElementChild;
  for (const job of shown) {
    let row = rows.get(job.name);
    if (!row) rows.set(job.name, (row = makeRow()));
    fillRow(row, job);
    if (row.tr === before) before = before.nextElementSibling;
    else body.insertBefore(row.tr, before);
  }
}

function fillRow(row, job) {
  setText(row.title, titleOf(job));
  row.title.title = titleOf(job);
  const tries = job.attempts > 1 ? ` \u00b7 attempt ${job.attempts}` : "";
  setText(row.sub, `#${lastPart(job.name)} \u00b7 ${KINDS[job.kind] ?? "job"}${tries}`);
  setText(row.machine, lastPart(job.machine));
  const judged = job.state === "STATE_SUCCEEDED" ? VERDICTS[job.outcome?.verdict]
    : job.outcome?.kind === "KIND_STOPPED" ? STOPPED : undefined;
  const [word, tone] = judged ?? STATES[job.state] ?? ["Unknown", "off"];
  const held = progress.get(job.name)?.held && job.state === "STATE_RUNNING";
  setText(row.chip, held ? "Held" : word);
  row.chip.dataset.tone = held ? "wait" : tone;
  const [time, took, full] = timeTexts(job);
  setText(row.time, time);
  row.time.title = full;
  setText(row.took, took);
  if (job.state === "STATE_RUNNING") drawProgress(row, job);
  else drawOutcome(row, job);
  drawResults(row, job);
}

function drawProgress(row, job) {
  const now = progress.get(job.name) ?? {};
  const name = `Progress of job ${lastPart(job.name)}`;
  if (row.bar.getAttribute("aria-label") !== name) row.bar.setAttribute("aria-label", name);
  if (now.progress === undefined) row.bar.removeAttribute("value");
  else row.bar.value = now.progress;
  setText(row.percent, now.progress === undefined ? "" : `${Math.floor(now.progress * 100)} %`);
  const parts = [placeText(now.place), now.instruction];
  const planned = now.plannedTimeNs ? ` of ${duration(Number(now.plannedTimeNs) / 1e9)}` : "";
  if (now.virtualTimeNs) parts.push(duration(Number(now.virtualTimeNs) / 1e9) + planned);
  if (now.speedMmS) parts.push(`${now.speedMmS.toFixed(1)} mm/s`);
  const tip = now.workTip ?? now.position?.tip;  // a mill's as its program counts
  if (tip) parts.push(`X ${tip.x.toFixed(2)}  Y ${tip.y.toFixed(2)}  Z ${tip.z.toFixed(2)}`);
  setText(row.where, parts.filter(Boolean).join(" \u00b7 "));
  if (row.outcome.firstChild !== row.barLine) row.outcome.replaceChildren(row.barLine, row.where);
  delete row.outcome.dataset.key;
}

// Of an error that ended a job: the verdict, where it came, and what to do.
function endText(outcome) {
  const [word] = VERDICTS[outcome.verdict] ?? [];
  const advice = (outcome.reasons ?? []).find((reason) => reason.code === outcome.code)?.advice;
  return [word && `Verdict ${word}`, placeText(outcome.place), advice].filter(Boolean).join(" \u00b7 ");
}

function waitText(job) {
  const [collection, id] = (job.waitsFor ?? "").split("/");
  const name = collection === "jobs" ? `#${id}` : id;
  const whom = job.waitReason === "WAIT_REASON_CONTROL" ? job.waitsFor : name;
  return [WAITS[job.waitReason], whom].filter(Boolean).join(" ");
}

function drawOutcome(row, job) {
  const outcome = job.outcome;
  const key = JSON.stringify([job.state, outcome ?? null, job.waitReason, job.waitsFor]);
  if (row.outcome.dataset.key === key) return;
  row.outcome.dataset.key = key;
  row.outcome.replaceChildren();
  if (job.state === "STATE_QUEUED") row.outcome.append(waitText(job));
  if (!outcome) return;
  const words = OUTCOMES[outcome.kind] ?? "";
  const reasons = outcome.code ? [] : outcome.reasons ?? [];
  if (outcome.code) {
    row.outcome.append(explainLink(outcome.code), ` ${outcome.message || words}`,
      element("div", { className: "sub" }, endText(outcome)));
  } else {
    row.outcome.append(words);
  }
  for (const [index, reason] of reasons.slice(0, REASONS_SHOWN).entries()) {
    const again = index > 0 && reasons[index - 1].code === reason.code;
    const advice = again ? "" : reason.advice;
    row.outcome.append(element("div", { className: "reason" }, explainLink(reason.code), ` ${reason.message}`,
      element("div", { className: "sub" }, [placeText(reason.first), advice].filter(Boolean).join(" \u00b7 "))));
  }
  if (reasons.length > REASONS_SHOWN) {
    row.outcome.append(element("div", { className: "sub" }, `and ${reasons.length - REASONS_SHOWN} more in the report`));
  }
}

const PRODUCTS = { "picture.svg": "Picture", "relief.png": "Relief", "height.png": "Heights", "height.grid": "Height grid", "left.stl": "STL" };
const productWord = (name) => PRODUCTS[name] ?? name[0].toUpperCase() + name.slice(1);

// What the part looks like, small: what a mill left of its block says more than the path.
function drawLook(row, job, artifacts) {
  const shown = artifacts.find((one) => one.name === "relief.png") ?? artifacts.find((one) => one.name === "picture.svg");
  if (!shown) return row.look.replaceChildren();
  const text = `${productWord(shown.name)} of job ${lastPart(job.name)}`;
  const image = element("img", { loading: "lazy", width: 96, height: 64, alt: text });
  image.addEventListener("error", () => row.look.replaceChildren());
  image.src = shown.urlPath;
  row.look.replaceChildren(element("a", { href: shown.urlPath, target: "_blank", rel: "noopener", title: text }, image));
}

function drawResults(row, job) {
  const artifacts = (job.artifacts ?? [])
    .filter((one) => one.urlPath?.startsWith("/v1/") && !FOR_PROGRAMS.includes(one.name));
  const key = artifacts.map((one) => one.urlPath).join(" ");
  if (row.results.dataset.key === key) return;
  row.results.dataset.key = key;
  drawLook(row, job, artifacts);
  row.results.replaceChildren(...artifacts.map((one) => {
    const word = productWord(one.name);
    const link = element("a", { href: one.urlPath, target: "_blank", rel: "noopener" }, word);
    link.setAttribute("aria-label", `${word} of job ${lastPart(job.name)}, opens in a new tab`);
    if (one.name !== "report") return link;
    link.setAttribute("aria-label", `Report of job ${lastPart(job.name)}`);
    link.addEventListener("click", (event) => {
      if (event.ctrlKey || event.metaKey || event.shiftKey) return;
      event.preventDefault();
      showReport(job, one.urlPath);
    });
    return link;
  }));
}

// A code in a report is explained in the same dialog.
function openDialog() {
  const dialog = byId("explain");
  if (!dialog.open) dialog.showModal();
}

// --- the report -----------------------------------------------------------------------------------------

const SHOWN_OF_A_LIST = 8;
const fixed = (number, digits) => (number ?? 0).toFixed(digits);

function countsText(pairs) {
  return pairs.filter(([number]) => Number(number) > 0).map(([number, what]) => `${number} ${what}`).join(", ");
}

// Which machine it was, and what of it is not as its profile has it.
function machineText(report) {
  if (!report.profile) return report.family ?? "";
  const own = report.machineName;
  const unnamed = own ? ": the default, as it names no profile" : ": no profile was named";
  return `${own ? `${own}, based on ` : ""}${report.family}, ${report.profile}${report.profileNamed ? "" : unnamed}`;
}

function changesText(report) {
  const changes = (report.profileChanges ?? []).map((one) => `${one.name} ${one.value} (profile: ${one.ofProfile}${one.source ? `; source: ${one.source}` : ""})`);
  const who = report.profileChangedBy;
  if (!changes.length) return who ? `nothing, by ${who}` : "";
  return changes.join(", ") + (who ? `; by ${who}` : "");
}

// The verdict and what makes it so.
function verdictBlock(outcome) {
  const [word, tone] = VERDICTS[outcome?.verdict] ?? [];
  if (!word) return [];
  const chip = element("span", { className: "chip" }, word);
  chip.dataset.tone = tone;
  const reasons = (outcome.reasons ?? []).map((reason) =>
    element("li", {}, explainLink(reason.code), ` ${reason.message}`,
      element("div", { className: "sub" }, [placeText(reason.first), reason.advice].filter(Boolean).join(" \u00b7 "))));
  return [element("p", { className: "verdict" }, "Verdict ", chip, ` ${OUTCOMES[outcome.kind] ?? ""}`),
    element("ul", { className: "findings" }, ...reasons)];
}

// Findings of one code at many places are told once.
function findingItems(report) {
  const kinds = new Map();
  for (const one of report.diagnostics ?? []) {
    if (!kinds.has(one.code)) kinds.set(one.code, []);
    kinds.get(one.code).push(one);
  }
  // Those that no list had room for come with the first and the last place of each code.
  for (const { first, last, ...one } of report.gathered ?? []) {
    if (!kinds.has(one.code)) kinds.set(one.code, []);
    kinds.get(one.code).push({ ...one, place: first, count: Number(one.count) - 1 }, { ...one, place: last, count: 1 });
  }
  const items = [...kinds.values()].map((all) => {
    const [first] = all;
    const count = all.reduce((sum, one) => sum + Number(one.count ?? 1), 0);
    const word = VERDICTS[first.verdict]?.[0] ?? severityWord(first.severity ?? "SEVERITY_UNSPECIFIED");
    const extent = all.length > 1 ? `${placeText(first.place)} to ${placeText(all[all.length - 1].place)}` : placeText(first.place);
    return element("li", {}, explainLink(first.code), ` ${word}: ${first.message} `,
      element("span", { className: "sub" }, [count > 1 ? `${count} times` : "", extent].filter(Boolean).join(", ")));
  });
  const gathered = (report.gathered ?? []).reduce((sum, one) => sum + Number(one.count), 0);
  const dropped = Number(report.diagnosticsDropped ?? 0) - gathered;
  if (dropped > 0) items.push(element("li", { className: "sub" }, `and ${dropped} more`));
  return items;
}

// What a person wants to know first; the link below has everything.
function reportRows(report) {
  const rows = [];
  const total = report.total;
  const add = (word, text) => {
    if (text) rows.push([word, text]);
  };
  add("Machine", machineText(report));
  add("Changed", changesText(report));
  if (total) {
    const times = total.times ?? {};
    add("Cycle time", duration(times.cycleS ?? 0));
    add("Path", `${fixed(total.pathLengthMm, 1)} mm, cut ${fixed(total.cutLengthMm, 1)}, travel ${fixed(total.travelLengthMm, 1)}`);
    if (total.beamOnS) add("Beam", `on ${fixed(total.beamOnS, 1)} s, ${total.pierces ?? 0} pierces, ${fixed(total.energyJ, 0)} J`);
    if (total.energyJPerMm) add("", `${fixed(total.energyJPerMm, 2)} J/mm, of a step at most ${fixed(total.energyJPerMmMax, 2)}`);
    if (Number(total.plunges) > 0) add("Plunges", String(total.plunges));
  }
  const corners = report.corners ?? {};
  add("Corners", countsText([[corners.stopped, "stops"], [corners.stoppedWithFly, "stops with /FLY"],
    [corners.reversed, "reversals"], [corners.through, "straight on"], [corners.blended, "blended"],
    [corners.capped, "blended slower"]]));
  if (corners.deviationMmMax) add("", `deviation up to ${fixed(corners.deviationMmMax, 3)} mm, ${placeText(corners.deviationPlace)}`);
  const shortfall = report.shortfall ?? {};
  if (Number(shortfall.moves) > 0) {
    add("Too slow", `${shortfall.moves} moves: ` + countsText([[shortfall.byAxis, "by an axis"],
      [shortfall.byRadius, "by a radius"], [shortfall.tooShort, "too short"], [shortfall.byAcceleration, "by acceleration"]]));
  }
  for (const axis of report.axes ?? []) {
    if (!axis.peakSpeed) continue;
    const share = axis.peakSpeedShare ? ` (${fixed(axis.peakSpeedShare * 100, 0)} %)` : "";
    add(`Peak ${axis.axis}`, `${fixed(axis.peakSpeed, axis.rotary ? 3 : 1)} ${axis.rotary ? "rad/s" : "mm/s"}${share}`);
  }
  const violations = report.violations ?? [];
  for (const one of violations.slice(0, SHOWN_OF_A_LIST)) {
    add("Leaves its travel", `${one.axis} by ${fixed(one.excess, 3)} ${one.rotary ? "rad" : "mm"}, ${placeText(one.place)}, at ${fixed(one.timeS, 3)} s`);
  }
  const more = violations.length + Number(report.violationsDropped ?? 0) - SHOWN_OF_A_LIST;
  if (more > 0) add("", `and ${more} more`);
  add("Motion checked", report.motionCheck);
  return rows;
}

async function showReport(job, address) {
  const body = byId("explain-body");
  setText(byId("explain-title"), `Report of job ${lastPart(job.name)}`);
  body.replaceChildren("Asking the server");
  openDialog();
  try {
    const response = await fetch(address, { signal: AbortSignal.timeout(CALL_MS) });
    if (!response.ok) throw new Error(response.statusText);
    const report = await response.json();
    const list = element("dl", { className: "report" });
    for (const [word, text] of reportRows(report)) list.append(element("dt", {}, word), element("dd", {}, text));
    const findings = findingItems(report);
    const all = element("a", { href: address, target: "_blank", rel: "noopener" }, "All of it as JSON");
    const about = findings.length ? [element("h3", {}, "Findings"), element("ul", { className: "findings" }, ...findings)] : [];
    body.replaceChildren(...verdictBlock(report.outcome), list, ...about, element("p", {}, all));
  } catch (error) {
    setText(body, `The report cannot be read: ${error.message}`);
  }
}

// --- explanations ---------------------------------------------------------------------------------------

// Works as a plain link too: the address gives the same as JSON.
function explainLink(code) {
  const query = encodeURIComponent(JSON.stringify({ code }));
  const link = element("a", { className: "code", href: `/rmlcell.v1.ProgramService/ExplainError?message=${query}` }, code);
  link.title = `What ${code} means`;
  link.addEventListener("click", (event) => {
    if (event.ctrlKey || event.metaKey || event.shiftKey) return;
    event.preventDefault();
    explain(code);
  });
  return link;
}

const severityWord = (severity) =>
  severity === "SEVERITY_UNSPECIFIED" ? "" : severity.replace("SEVERITY_", "").toLowerCase();

async function explain(code) {
  const body = byId("explain-body");
  setText(byId("explain-title"), code);
  body.replaceChildren("Asking the server");
  openDialog();
  try {
    const answer = await call("ProgramService/ExplainError", { code });
    body.replaceChildren(...(answer.errors ?? []).map((error) => {
      const list = element("dl");
      for (const [word, text] of [["What happened", error.when], ["The machine", error.effect],
        ["What to do", error.advice], ["Symbol", error.symbol], ["Severity", severityWord(error.severity)]]) {
        if (text) list.append(element("dt", {}, word), element("dd", {}, text));
      }
      return list;
    }));
    if (!body.childNodes.length) setText(body, "The catalogue has no such code.");
  } catch (error) {
    setText(body, `The server cannot be asked: ${error.message}`);
  }
}

document.querySelector(".filters").addEventListener("click", (event) => {
  const button = event.target.closest("[data-filter]");
  if (!button) return;
  filter = button.dataset.filter;
  draw();
});

connect();
