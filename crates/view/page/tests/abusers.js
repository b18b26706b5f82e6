// Two hundred clients that mean no good: some ask for the record and do not read, some send half a request, some follow,
// some are foreign, and some ask for what is not there at great length.

import { connect } from "node:net";

const CLIENTS = 200;
/** How often those that do not stay come again, milliseconds. */
const AGAIN_MS = 50;

/**
 * Begins to abuse the server at `url`.
 * @param {string} url
 * @returns {() => void} Ends it.
 */
export function abuse(url) {
  const { host, port } = new URL(url);
  const open = () => connect(Number(port), "127.0.0.1").on("error", () => {});
  const record = `GET /record HTTP/1.1\r\nHost: ${host}\r\n\r\n`;
  const held = Array.from({ length: CLIENTS }, (_, k) => {
    const socket = open();
    if (k % 4 === 0) socket.pause();
    else if (k % 4 === 1) socket.on("data", () => {});
    if (k % 4 < 2) socket.write(record);
    else socket.write("GET / HT");
    return socket;
  });
  let round = 0;
  const timer = setInterval(() => {
    round += 1;
    const path = round % 2 === 0 ? "a".repeat(100_000) : "../../etc/passwd";
    const socket = open();
    socket.on("data", () => {});
    socket.end(`GET /${path} HTTP/1.1\r\nHost: evil.example\r\n\r\n`);
  }, AGAIN_MS);
  return () => {
    clearInterval(timer);
    for (const socket of held) socket.destroy();
  };
}
