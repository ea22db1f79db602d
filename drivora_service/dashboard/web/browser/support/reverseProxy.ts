/** A real reverse proxy that has a service under the path `/drivora` of its host. */

import { type ChildProcess, spawn } from "node:child_process";
import { once } from "node:events";
import { join } from "node:path";
import { PYTHON, REPOSITORY } from "./service";

/** Exit code of `tests.reverse_proxies` where the machine has no such proxy. */
const NO_PROXY = 3;

export class ReverseProxy {
  private constructor(
    readonly url: string,
    private readonly process: ChildProcess,
  ) {}

  /** Starts a proxy of a kind in `tests/reverse_proxies.py`; undefined where there is none. */
  static async start(
    kind: string,
    service: string,
    folder: string,
  ): Promise<ReverseProxy | undefined> {
    const words = ["-m", "tests.reverse_proxies", kind, new URL(service).host, join(folder, kind)];
    const process = spawn(PYTHON, words, {
      cwd: REPOSITORY,
      stdio: ["pipe", "pipe", "inherit"],
    });
    const said = await Promise.race([once(process.stdout, "data"), once(process, "exit")]);
    if (said[0] === NO_PROXY) return undefined;
    if (typeof said[0] === "number") throw new Error(`the proxy ended with ${said[0]}`);
    return new ReverseProxy(String(said[0]).trim(), process);
  }

  async stop(): Promise<void> {
    const ended = once(this.process, "exit");
    this.process.stdin?.end();
    await ended;
  }
}
