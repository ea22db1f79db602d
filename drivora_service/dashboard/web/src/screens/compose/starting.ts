import { api, body, type Schemas } from "../../api/client";
import type { JsonObject } from "../../components/fields/pointers";

/** Asks the service whether a campaign can be started. */
export async function validateCampaign(document: JsonObject, signal: AbortSignal) {
  const content = document as unknown as Schemas["CampaignDocument"];
  return body(await api.POST("/api/v1/campaigns:validate", { body: content, signal }));
}

/** Asks the service whether a study can be started. */
export async function validateStudy(document: JsonObject, signal: AbortSignal) {
  const content = document as unknown as Schemas["StudyDocument"];
  return body(await api.POST("/api/v1/studies:validate", { body: content, signal }));
}

/** Starts a campaign; the same request sent again starts nothing a second time. */
export async function postCampaign(document: JsonObject, request: string) {
  const content = document as unknown as Schemas["CampaignDocument"];
  const params = { header: { "Idempotency-Key": request } };
  return body(await api.POST("/api/v1/campaigns", { body: content, params }));
}

/** Starts a study; the same request sent again starts nothing a second time. */
export async function postStudy(document: JsonObject, request: string) {
  const content = document as unknown as Schemas["StudyDocument"];
  const params = { header: { "Idempotency-Key": request } };
  return body(await api.POST("/api/v1/studies", { body: content, params }));
}

const requests = new WeakMap<JsonObject, string>();

/** Returns the name of the request that starts a document: the same whenever it is asked for. */
export function requestOf(document: JsonObject): string {
  const known = requests.get(document);
  if (known) return known;
  // Not `randomUUID`, which pages of plain HTTP do not have.
  const parts = crypto.getRandomValues(new Uint32Array(4));
  const made = [...parts].map((part) => part.toString(16).padStart(8, "0")).join("");
  requests.set(document, made);
  return made;
}
