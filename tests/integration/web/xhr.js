// As much of XMLHttpRequest over fetch as the npm package grpc-web uses, which knows nothing else.
export class XMLHttpRequest {
  readyState = 0;
  status = 0;
  statusText = "";
  responseText = "";
  responseType = "";
  response = null;
  onreadystatechange = null;
  #method; #url; #headers = {}; #answer = new Map(); #abort = new AbortController();

  open(method, url) {
    this.#method = method;
    this.#url = url;
    this.#become(1);
  }
  setRequestHeader(name, value) { this.#headers[name] = value; }
  getResponseHeader(name) { return this.#answer.get(name.toLowerCase()) ?? null; }
  getAllResponseHeaders() { return [...this.#answer].map(([name, value]) => `${name}: ${value}\r\n`).join(""); }
  abort() { this.#abort.abort(); }

  async send(body) {
    try {
      const response = await fetch(this.#url, {
        method: this.#method, headers: this.#headers, body, signal: this.#abort.signal });
      this.status = response.status;
      this.statusText = response.statusText;
      response.headers.forEach((value, name) => this.#answer.set(name, value));
      this.#become(2);
      if (this.responseType === "arraybuffer") {
        this.response = await response.arrayBuffer();
      } else {
        for await (const text of response.body.pipeThrough(new TextDecoderStream())) {
          this.responseText += text;
          this.response = this.responseText;
          this.#become(3);
        }
      }
    } catch {
      this.status = 0;
    }
    this.#become(4);
  }
  #become(state) {
    this.readyState = state;
    this.onreadystatechange?.();
  }
}
