/** A real service: `drivora serve` with a data folder of its own. */

import { type ChildProcess, spawn } from "node:child_process";
import { appendFileSync, existsSync, readFileSync, rmSync } from "node:fs";
import { join, resolve } from "node:path";

export const REPOSITORY = resolve(import.meta.dirname, "../../../../..");
export const PYTHON = process.env.DRIVORA_PYTHON ?? join(REPOSITORY, ".venv/bin/python");
const START_MS = 180_000;
const STOP_MS = 30_000;

export interface Options {
  readonly workers?: number;
  readonly host?: string;
  /** Environment variables beside those of this process. */
  readonly settings?: Readonly<Record<string, string>>;
}

export class Service {
  private process: ChildProcess | undefined;
  private port = 0;
  url = "";

  constructor(
    readonly folder: string,
    private readonly options: Options = {},
  ) {}

  /** Starts it, after the first time at the same address, and waits until it is ready. */
  async start(): Promise<void> {
    const told = join(this.folder, "service.json");
    rmSync(told, { force: true });
    const { workers = 1, host = "127.0.0.1", settings = {} } = this.options;
    const service = spawn(
      PYTHON,
      [
        ...["-m", "drivora_service.cli", "serve", "--data-dir", this.folder],
        ...["--workers", String(workers), "--host", host, "--port", String(this.port)],
      ],
      { cwd: REPOSITORY, env: { ...process.env, DRIVORA_DRAIN_S: "0", ...settings } },
    );
    this.process = service;
    const log = join(this.folder, "service.log");
    for (const stream of [service.stdout, service.stderr]) {
      stream?.on("data", (said: Buffer) => appendFileSync(log, said));
    }
    const deadline = Date.now() + START_MS;
    while (Date.now() < deadline) {
      if (service.exitCode !== null) {
        throw new Error(
          `the service ended with ${service.exitCode}:\n${readFileSync(log, "utf8")}`,
        );
      }
      if (existsSync(told)) {
        const { url } = JSON.parse(readFileSync(told, "utf8")) as { url: string };
        const answer = await fetch(`${url}/readyz`).catch(() => undefined);
        if (answer?.ok) {
          this.url = url;
          this.port = Number(new URL(url).port);
          return;
        }
      }
      await sleep(50);
    }
    throw new Error(`the service was not ready:\n${readFileSync(log, "utf8")}`);
  }

  stop(): Promise<void> {
    return this.end("SIGTERM");
  }

  /** Ends it without a chance to tidy up, as a lack of memory or of power does. */
  kill(): Promise<void> {
    return this.end("SIGKILL");
  }

  private async end(signal: "SIGTERM" | "SIGKILL"): Promise<void> {
    const service = this.process;
    if (!service || service.exitCode !== null || service.signalCode !== null) return;
    const ended = new Promise<void>((done) => service.once("exit", () => done()));
    service.kill(signal);
    const late = setTimeout(() => service.kill("SIGKILL"), STOP_MS);
    await ended;
    clearTimeout(late);
  }
}

export function sleep(ms: number): Promise<void> {
  return new Promise((done) => setTimeout(done, ms));
}

/** Runs a command of Drivora, which must end well, and returns what it prints. */
export async function drivora(...words: string[]): Promise<string> {
  const { code, out, err } = await ended(...words);
  if (code !== 0) throw new Error(`drivora ${words.join(" ")} ended with ${code}: ${err}`);
  return out;
}

export interface Ended {
  readonly code: number | null;
  readonly out: string;
  readonly err: string;
}

/** Runs a command of Drivora, however it ends. */
export async function ended(...words: string[]): Promise<Ended> {
  const command = spawn(PYTHON, ["-m", "drivora_service.cli", ...words], { cwd: REPOSITORY });
  let out = "";
  let err = "";
  command.stdout.on("data", (said: Buffer) => {
    out += said;
  });
  command.stderr.on("data", (said: Buffer) => {
    err += said;
  });
  const code = await new Promise<number | null>((done) => command.once("close", done));
  return { code, out, err };
}
