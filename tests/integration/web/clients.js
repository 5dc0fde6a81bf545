// The tests. Each holds for any server with at least one machine; `job` names a job that has ended and has
// at least three events.
import assert from "node:assert/strict";
import { create, fromBinary, toBinary } from "@bufbuild/protobuf";
import { Code, ConnectError, createClient } from "@connectrpc/connect";
import { createConnectTransport, createGrpcWebTransport } from "@connectrpc/connect-web";
import { ErrorInfoSchema } from "./gen/google/rpc/error_details_pb.js";
import { CellService, WatchCellRequestSchema, WatchCellResponseSchema } from "./gen/rmlcell/v1/cell_pb.js";
import { ErrorDetailSchema } from "./gen/rmlcell/v1/common_pb.js";
import { GetJobRequestSchema, JobSchema, JobService }
  from "./gen/rmlcell/v1/job_pb.js";
import { ListMachinesRequestSchema, ListMachinesResponseSchema, MachineService } from "./gen/rmlcell/v1/machine_pb.js";
import { ProgramService } from "./gen/rmlcell/v1/program_pb.js";
import { readEvents } from "./events.js";
import { XMLHttpRequest } from "./xhr.js";

const MISSING = "jobs/987654321";

async function refusal(promise) {
  try {
    await promise;
  } catch (error) {
    return ConnectError.from(error);
  }
  assert.fail("the call was expected to fail");
}

// The same for each transport of connect-web.
function connectTests(name, transport, job, test) {
  const cell = createClient(CellService, transport);
  const jobs = createClient(JobService, transport);
  const machines = createClient(MachineService, transport);
  const programs = createClient(ProgramService, transport);

  test(`${name}: unary call`, async () => {
    const answer = await machines.listMachines({});
    assert.ok(answer.machines.length > 0);
    assert.match(answer.machines[0].name, /^machines\/[a-z][a-z0-9-]*$/);
  });

  test(`${name}: error with details`, async () => {
    const error = await refusal(jobs.getJob({ name: MISSING }));
    assert.equal(error.code, Code.NotFound);
    const [info] = error.findDetails(ErrorInfoSchema);
    assert.equal(info.domain, "rmlcell");
    const [detail] = error.findDetails(ErrorDetailSchema);
    assert.match(detail.code, /^CELL-E\d{4}$/);
  });

  test(`${name}: the machine's own errors are explained`, async () => {
    const answer = await programs.explainError({ code: "OPT-E348" });
    assert.deepEqual(answer.errors.map((error) => error.symbol), ["HOLE_RADIUS_ZERO"]);
  });

  test(`${name}: stream, first message, abort`, async () => {
    const abort = new AbortController();
    const seen = [];
    try {
      for await (const message of cell.watchCell({}, { signal: abort.signal })) {
        seen.push(message.what.case);
        abort.abort();
      }
    } catch (error) {
      assert.equal(ConnectError.from(error).code, Code.Canceled);
    }
    assert.deepEqual(seen.slice(0, 1), ["snapshot"]);
  });

  test(`${name}: deadline`, async () => {
    const run = async () => {
      for await (const message of cell.watchCell({}, { timeoutMs: 400 })) assert.ok(message);
    };
    assert.equal((await refusal(run())).code, Code.DeadlineExceeded);
  });

  if (job) {
    test(`${name}: all events of a job, in order`, async () => {
      const sequences = [];
      for await (const message of jobs.watchJob({ name: job, afterSequence: 0n })) {
        if (message.what.case === "event") sequences.push(Number(message.sequence));
      }
      assert.ok(sequences.length >= 3);
      assert.deepEqual(sequences, sequences.map((_, i) => i + 1));
    });
  }
}

// npm grpc-web with descriptors made by hand: its generator is not used.
async function grpcWebTests(url, format, test) {
  globalThis.XMLHttpRequest ??= XMLHttpRequest;
  globalThis.self ??= globalThis;
  const { default: grpcWeb } = await import("grpc-web");
  const describe = (path, type, input, output) => new grpcWeb.MethodDescriptor(
    path, type, Object, Object, (message) => toBinary(input, message), (bytes) => fromBinary(output, bytes));
  const client = new grpcWeb.GrpcWebClientBase({ format });
  const call = (method, path, message) => new Promise((resolve, reject) => client.rpcCall(
    url + path, message, {}, method, (error, answer) => (error ? reject(error) : resolve(answer))));

  const listMachines = describe("/rmlcell.v1.MachineService/ListMachines", grpcWeb.MethodType.UNARY,
    ListMachinesRequestSchema, ListMachinesResponseSchema);
  test(`grpc-web ${format}: unary call`, async () => {
    const answer = await call(listMachines, "/rmlcell.v1.MachineService/ListMachines", create(ListMachinesRequestSchema));
    assert.ok(answer.machines.length > 0);
  });

  const getJob = describe("/rmlcell.v1.JobService/GetJob", grpcWeb.MethodType.UNARY, GetJobRequestSchema, JobSchema);
  test(`grpc-web ${format}: error`, async () => {
    const error = await call(getJob, "/rmlcell.v1.JobService/GetJob", create(GetJobRequestSchema, { name: MISSING }))
      .then(() => assert.fail("the call was expected to fail"), (reason) => reason);
    assert.equal(error.code, 5);
    assert.ok(error.message.length > 0);
  });

  if (format !== "text") return; // the binary form of this package has no streams
  const watchCell = describe("/rmlcell.v1.CellService/WatchCell", grpcWeb.MethodType.SERVER_STREAMING,
    WatchCellRequestSchema, WatchCellResponseSchema);
  test(`grpc-web ${format}: stream`, async () => {
    const stream = client.serverStreaming(`${url}/rmlcell.v1.CellService/WatchCell`, create(WatchCellRequestSchema), {}, watchCell);
    const first = await new Promise((resolve, reject) => {
      stream.on("data", resolve);
      stream.on("error", reject);
    });
    stream.cancel();
    assert.equal(first.what.case, "snapshot");
  });
}

function eventTests(url, job, test) {
  const watch = (method, message) => `${url}/rmlcell.v1.${method}?message=${encodeURIComponent(JSON.stringify(message))}`;

  test("events: snapshot of the cell", async () => {
    const abort = new AbortController();
    for await (const event of readEvents(watch("CellService/WatchCell", { subscriptions: [{ id: "machines", machines: {} }] }), { signal: abort.signal })) {
      assert.equal(event.type, "message");
      const { snapshot } = JSON.parse(event.data);
      assert.ok(snapshot.machines.length > 0);
      break;
    }
    abort.abort();
  });

  test("events: a wrong field has its HTTP status", async () => {
    const error = await readEvents(watch("CellService/WatchCell", { nam: "x" })).next().then(() => null, (reason) => reason);
    assert.equal(error.status, 400);
    assert.equal(JSON.parse(error.message).code, "invalid_argument");
  });

  if (!job) return;
  test("events: resume after Last-Event-ID, no gap and no repeat", async () => {
    const whole = [];
    for await (const event of readEvents(watch("JobService/WatchJob", { name: job, afterSequence: 0 }))) whole.push(event);
    assert.equal(whole.at(-1).type, "end");
    const ids = whole.map((event) => event.id).filter(Boolean);
    assert.ok(ids.length >= 3);
    const rest = [];
    for await (const event of readEvents(watch("JobService/WatchJob", { name: job, afterSequence: 0 }), { headers: { "Last-Event-ID": ids[1] } })) {
      if (event.id) rest.push(event.id);
    }
    // The snapshot has the number that it goes on after.
    assert.deepEqual(rest, ids.slice(1));
  });
}

function httpTests(url, test) {
  const post = (path, body, headers = { "Content-Type": "application/json" }) =>
    fetch(url + path, { method: "POST", headers, body });

  test("http: an error is JSON with code, message and details", async () => {
    const response = await post("/rmlcell.v1.JobService/GetJob", JSON.stringify({ name: MISSING }));
    assert.equal(response.status, 404);
    const error = await response.json();
    assert.equal(error.code, "not_found");
    assert.equal(error.details[0]["@type"], "type.googleapis.com/google.rpc.ErrorInfo");
  });
  test("http: the form of a foreign page is refused", async () => {
    const response = await post("/rmlcell.v1.JobService/SubmitJob", "a=b", { "Content-Type": "application/x-www-form-urlencoded" });
    assert.equal(response.status, 415);
  });
  test("http: health and page", async () => {
    assert.deepEqual(await (await fetch(`${url}/healthz`)).json(), { status: "SERVING" });
    const page = await fetch(`${url}/`);
    assert.match(page.headers.get("content-security-policy"), /default-src 'none'/);
    const etag = page.headers.get("etag");
    assert.equal((await fetch(`${url}/`, { headers: { "If-None-Match": etag } })).status, 304);
  });
}

export async function declareTests(url, job, test) {
  connectTests("connect json", createConnectTransport({ baseUrl: url }), job, test);
  connectTests("connect binary", createConnectTransport({ baseUrl: url, useBinaryFormat: true }), job, test);
  connectTests("connect by GET", createConnectTransport({ baseUrl: url, useHttpGet: true }), undefined, test);
  connectTests("grpc-web of connect", createGrpcWebTransport({ baseUrl: url }), job, test);
  await grpcWebTests(url, "text", test);
  await grpcWebTests(url, "binary", test);
  eventTests(url, job, test);
  httpTests(url, test);
}
