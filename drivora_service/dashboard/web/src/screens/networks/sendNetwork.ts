import { addressOf } from "../../service";
/** Sends the file of a network to the service. */

import { Problem, problemOf, type Schemas } from "../../api/client";
import type { Format } from "./networkFile";

export interface Sending {
  readonly name: string;
  readonly format: Format;
  readonly replace: boolean;
  /** Told the share of the file that was sent, from 0 to 1. */
  readonly onSent: (share: number) => void;
  readonly signal: AbortSignal;
}

export class Cancelled extends Error {}

/** Imports a network; `fetch` tells nothing of what was sent so far. */
export function sendNetwork(file: File, sending: Sending): Promise<Schemas["Network"]> {
  const { name, format, replace, onSent, signal } = sending;
  const words = new URLSearchParams({ name, format, replace: String(replace) });
  return new Promise((done, refuse) => {
    const request = new XMLHttpRequest();
    request.open("POST", addressOf(`/api/v1/networks?${words}`));
    request.setRequestHeader("Content-Type", "application/octet-stream");
    request.upload.onprogress = ({ loaded, total }) => onSent(total > 0 ? loaded / total : 0);
    request.upload.onload = () => onSent(1);
    request.onload = () => {
      if (request.status === 201) done(JSON.parse(request.responseText) as Schemas["Network"]);
      else void answered(request).then(refuse);
    };
    request.onerror = () => refuse(unanswered(file));
    request.onabort = () => refuse(new Cancelled());
    signal.addEventListener("abort", () => request.abort(), { once: true });
    if (signal.aborted) refuse(new Cancelled());
    else request.send(file);
  });
}

function answered(request: XMLHttpRequest): Promise<Problem> {
  const { status, statusText, responseText } = request;
  return problemOf(new Response(responseText, { status, statusText }));
}

function unanswered(file: File): Problem {
  return new Problem(
    0,
    "No answer",
    `The service did not answer. Is it still running, and is ${file.name} still there and unchanged?`,
  );
}
