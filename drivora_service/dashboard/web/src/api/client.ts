import createClient, { type Middleware } from "openapi-fetch";
import { serviceAddress } from "../service";
import type { components, paths } from "./schema";

export type Schemas = components["schemas"];

/** An error of the API: what was found, what is allowed and what to do, in its own words. */
export class Problem extends Error {
  constructor(
    readonly status: number,
    readonly title: string,
    detail: string,
    readonly problems: readonly Schemas["ProblemItem"][] = [],
  ) {
    super(detail);
  }
}

/** Throws what the service says of a refused request. */
const refusals: Middleware = {
  async onResponse({ response }) {
    if (!response.ok) throw await problemOf(response);
  },
  onError() {
    return new Problem(0, "No answer", "The service does not answer. Is it still running?");
  },
};

export const api = createClient<paths>({ baseUrl: serviceAddress() });
api.use(refusals);

/** Reads the problem of a refused request. */
export async function problemOf(response: Response): Promise<Problem> {
  const text = await response.text();
  try {
    const told = JSON.parse(text) as Partial<Schemas["ProblemDetails"]>;
    return new Problem(
      response.status,
      told.title ?? response.statusText,
      told.detail ?? text,
      told.problems ?? [],
    );
  } catch {
    return new Problem(response.status, response.statusText, text || response.statusText);
  }
}

/** Returns the answer's body; every refused request has thrown before. */
export function body<T>(answer: { data?: T }): T {
  if (answer.data === undefined) throw new Problem(0, "Empty answer", "The answer has no body.");
  return answer.data;
}
