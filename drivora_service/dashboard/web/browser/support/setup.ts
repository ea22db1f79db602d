/** Before all tests: a service with data, and the browser unpacked. */

import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type { TestProject } from "vitest/node";
import { Api } from "./api";
import { unpackBrowser } from "./browser";
import { type Made, makeData } from "./data";
import { Service } from "./service";

declare module "vitest" {
  export interface ProvidedContext {
    readonly url: string;
    readonly made: Made;
  }
}

export default async function setUp(project: TestProject): Promise<() => Promise<void>> {
  // Where tests are written, the data of an earlier time are kept in a folder and used again.
  const kept = process.env.DRIVORA_BROWSER_DATA;
  const folder = kept ?? mkdtempSync(join(tmpdir(), "drivora-browser-"));
  mkdirSync(folder, { recursive: true });
  const ids = join(folder, "made.json");
  const service = new Service(folder, { workers: 2 });
  try {
    await Promise.all([service.start(), unpackBrowser()]);
    const made = existsSync(ids)
      ? (JSON.parse(readFileSync(ids, "utf8")) as Made)
      : await makeData(new Api(service.url));
    writeFileSync(ids, JSON.stringify(made));
    project.provide("made", made);
  } catch (error) {
    await service.stop();
    throw error;
  }
  project.provide("url", service.url);
  return async () => {
    await service.stop();
    if (kept === undefined) rmSync(folder, { recursive: true, force: true });
  };
}
