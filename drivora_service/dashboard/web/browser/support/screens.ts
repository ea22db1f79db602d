/** Every screen of the router with an address that has content; a new screen has to be added. */

import type { Made } from "./data";

export interface Screen {
  /** Its path in the router. */
  readonly route: string;
  /** Its file in build/screenshots. */
  readonly name: string;
  /** Its address. */
  readonly at: string;
}

export function screens(made: Made): readonly Screen[] {
  return [
    { route: "/campaigns", name: "campaigns", at: "/campaigns" },
    { route: "/campaigns/new", name: "campaign-new", at: `/campaigns/new?run=${made.run}` },
    { route: "/campaigns/$id", name: "campaign", at: `/campaigns/${made.campaign}` },
    {
      route: "/campaigns/$id",
      name: "campaign-coverage",
      at: `/campaigns/${made.campaign}?tab=coverage`,
    },
    {
      route: "/compare",
      name: "compare",
      at: `/compare?${made.compared.map((id) => `campaign=${id}`).join("&")}`,
    },
    {
      route: "/compare/batches",
      name: "compare-batches",
      at: `/compare/batches?a=${made.paired[0]}&b=${made.paired[1]}`,
    },
    { route: "/failures", name: "failures", at: "/failures" },
    { route: "/suites", name: "suites", at: "/suites" },
    { route: "/suites", name: "suite", at: `/suites?suite=${made.suite}` },
    { route: "/minimizations", name: "minimizations", at: "/minimizations" },
    {
      route: "/minimizations/$id",
      name: "minimization",
      at: `/minimizations/${made.minimization}`,
    },
    { route: "/studies", name: "studies", at: "/studies" },
    { route: "/studies/new", name: "study-new", at: `/studies/new?study=${made.study}` },
    { route: "/studies/$id", name: "study", at: `/studies/${made.study}` },
    { route: "/runs", name: "runs", at: "/runs" },
    { route: "/runs", name: "runs-filtered", at: `/runs?batch=${made.collisions}&status=finished` },
    { route: "/runs/$runId", name: "run", at: `/runs/${made.run}` },
    { route: "/batches", name: "batches", at: "/batches" },
    { route: "/batches/$batchId", name: "batch", at: `/batches/${made.collisions}` },
    { route: "/agents", name: "agents", at: "/agents" },
    { route: "/workers", name: "workers", at: "/workers" },
    { route: "/session", name: "session", at: "/session" },
    { route: "/author", name: "author", at: `/author?run=${made.run}` },
    { route: "/networks", name: "networks", at: "/networks" },
    { route: "/networks/$name", name: "network", at: "/networks/tee-town" },
  ];
}
