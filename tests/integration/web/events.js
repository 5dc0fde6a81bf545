// Reads server-sent events as the standard says (fields, comments, several data lines), over fetch, since
// node has no EventSource of its own.
export async function* readEvents(url, { headers = {}, signal } = {}) {
  const response = await fetch(url, { headers: { Accept: "text/event-stream", ...headers }, signal });
  if (response.status !== 200) throw Object.assign(new Error(await response.text()), { status: response.status });
  if (!response.headers.get("content-type").startsWith("text/event-stream")) throw new Error("no event stream");
  let buffer = "";
  let event = { type: "message", data: [], id: undefined };
  for await (const text of response.body.pipeThrough(new TextDecoderStream())) {
    buffer += text;
    let end;
    while ((end = buffer.indexOf("\n")) >= 0) {
      const line = buffer.slice(0, end).replace(/\r$/, "");
      buffer = buffer.slice(end + 1);
      if (line === "") {
        if (event.data.length) yield { type: event.type, data: event.data.join("\n"), id: event.id };
        event = { type: "message", data: [], id: undefined };
      } else if (!line.startsWith(":")) {
        const [, field, value] = /^([^:]*):? ?(.*)$/.exec(line);
        if (field === "event") event.type = value;
        if (field === "data") event.data.push(value);
        if (field === "id") event.id = value;
      }
    }
  }
}
