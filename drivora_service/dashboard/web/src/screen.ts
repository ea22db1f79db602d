import { lazyRouteComponent } from "@tanstack/react-router";
import { addressOf } from "./service";

const FIRST_WAIT_MS = 400;
const LONGEST_WAIT_MS = 4000;

/**
 * Loads the code of a screen when it is opened.
 *
 * While the service does not answer, the screen before stays and the code is asked for again. If
 * the service answers, and the code still cannot be loaded, the error says so: it is not there any
 * more, or the browser remembers that it was not.
 */
export function untilLoaded<Loaded>(
  load: () => Promise<Loaded>,
  isThere: () => Promise<boolean> = serviceAnswers,
  wait = (ms: number) => new Promise<void>((done) => setTimeout(done, ms)),
): () => Promise<Loaded> {
  return async () => {
    for (let pause = FIRST_WAIT_MS; ; pause = Math.min(2 * pause, LONGEST_WAIT_MS)) {
      try {
        return await load();
      } catch (error) {
        if (await isThere()) throw new ScreenNotLoaded(error);
        await wait(pause);
      }
    }
  };
}

/** The code of a screen cannot be loaded although the service answers. */
export class ScreenNotLoaded extends Error {
  override readonly name = "ScreenNotLoaded";

  constructor(cause: unknown) {
    // The words of the browser would make the router load the whole page again.
    super("the code of the screen cannot be loaded", { cause });
  }
}

async function serviceAnswers(): Promise<boolean> {
  try {
    return (await fetch(addressOf("/healthz"), { cache: "no-store" })).ok;
  } catch {
    return false;
  }
}

/** Returns the component of a screen's module, which is loaded when it is needed. */
export function lazyScreen<
  Module extends Record<string, unknown>,
  Name extends keyof Module & string,
>(load: () => Promise<Module>, name: Name) {
  return lazyRouteComponent(untilLoaded(load), name);
}
