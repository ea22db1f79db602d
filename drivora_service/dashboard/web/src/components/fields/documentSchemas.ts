import { queryOptions } from "@tanstack/react-query";
import { Problem, problemOf } from "../../api/client";
import { addressOf } from "../../service";
import type { Definitions } from "./jsonSchema";

interface Described {
  readonly components: { readonly schemas: Definitions };
}

/** How the schemas of all documents are asked for; they do not change while the service runs. */
export const documentSchemas = queryOptions({
  queryKey: ["document-schemas"],
  queryFn: async (): Promise<Definitions> => {
    const answer = await fetch(addressOf("/api/v1/openapi.json")).catch(() => undefined);
    if (!answer)
      throw new Problem(0, "No answer", "The service does not answer. Is it still running?");
    if (!answer.ok) throw await problemOf(answer);
    return ((await answer.json()) as Described).components.schemas;
  },
});
