// Where the record comes from: the server, line by line as it grows, or the report that holds it.

/** The page stays responsive while a long record is read: after so many milliseconds it gets a turn. */
const SLICE_MS = 10;
const AGAIN_MS = 1000;

/**
 * @typedef {object} Reader
 * @property {(line: import("./record.js").Line) => void} take
 * @property {() => void} arrived After a piece.
 * @property {(connected: boolean) => void} connection
 */

/**
 * Follows the record of the server until it ends. When the server goes away, it is asked again from there on.
 * @param {Reader} reader
 */
export async function followServer(reader) {
  let lines = 0;
  let ended = false;
  const take = (/** @type {import("./record.js").Line} */ line) => {
    lines += 1;
    ended ||= line.end !== undefined;
    reader.take(line);
  };
  while (!ended) {
    try {
      const answer = await fetch(`record?from=${lines}`);
      if (!answer.ok || !answer.body) throw new Error(answer.statusText);
      reader.connection(true);
      await readLines(answer.body, take, reader.arrived);
    } catch {
      reader.connection(false);
    }
    if (!ended) await new Promise((done) => setTimeout(done, AGAIN_MS));
  }
}

/**
 * Reads the record that is packed in the page.
 * @param {string} packed
 * @param {Reader} reader
 */
export async function readPacked(packed, reader) {
  const bytes = Uint8Array.from(atob(packed.trim()), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  await readLines(stream, reader.take, reader.arrived);
}

/**
 * @param {string} path
 * @returns {Promise<string>}
 */
export async function askServer(path) {
  const answer = await fetch(path);
  if (!answer.ok) throw new Error(answer.statusText);
  return answer.text();
}

/**
 * @param {ReadableStream<Uint8Array>} stream
 * @param {(line: import("./record.js").Line) => void} take
 * @param {() => void} arrived
 */
async function readLines(stream, take, arrived) {
  const reader = stream.getReader();
  const decoder = new TextDecoder();
  let rest = "";
  let start = performance.now();
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    const lines = (rest + decoder.decode(value, { stream: true })).split("\n");
    rest = lines.pop() ?? "";
    for (const line of lines) if (line) take(JSON.parse(line));
    arrived();
    if (performance.now() - start > SLICE_MS) {
      await new Promise((turn) => setTimeout(turn));
      start = performance.now();
    }
  }
}
