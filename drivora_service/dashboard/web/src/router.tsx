import type { QueryClient } from "@tanstack/react-query";
import {
  createRootRouteWithContext,
  createRoute,
  createRouter,
  redirect,
} from "@tanstack/react-router";
import { parseSearch, type Search, stringifySearch } from "./address";
import { NotFound } from "./components/States";
import { lazyScreen } from "./screen";
import { prepareRun } from "./screens/replay/runQuery";
import { firstScreen } from "./screens/start/first";
import { ROOT } from "./service";
import { ScreenError } from "./shell/ScreenError";
import { Shell } from "./shell/Shell";

interface Context {
  readonly queries: QueryClient;
}

const root = createRootRouteWithContext<Context>()({
  component: Shell,
  notFoundComponent: NotFound,
  errorComponent: ScreenError,
});
const anySearch = (search: Record<string, unknown>) => search as Search;

/** One line a screen; its code is loaded when it is opened. */
const screens = [
  createRoute({
    getParentRoute: () => root,
    path: "/",
    beforeLoad: async ({ context }) => {
      const to = await firstScreen(context.queries);
      if (to) throw redirect({ to, search: {} });
    },
    component: lazyScreen(() => import("./screens/start/Start"), "Start"),
  }),
  createRoute({
    getParentRoute: () => root,
    path: "/campaigns",
    validateSearch: anySearch,
    component: lazyScreen(() => import("./screens/campaigns/Campaigns"), "Campaigns"),
  }),
  createRoute({
    getParentRoute: () => root,
    path: "/campaigns/new",
    validateSearch: anySearch,
    component: lazyScreen(() => import("./screens/compose/NewCampaign"), "NewCampaign"),
  }),
  createRoute({
    getParentRoute: () => root,
    path: "/campaigns/$id",
    validateSearch: anySearch,
    component: lazyScreen(() => import("./screens/campaign/Campaign"), "Campaign"),
  }),
  createRoute({
    getParentRoute: () => root,
    path: "/studies",
    validateSearch: anySearch,
    component: lazyScreen(() => import("./screens/studies/Studies"), "Studies"),
  }),
  createRoute({
    getParentRoute: () => root,
    path: "/studies/new",
    validateSearch: anySearch,
    component: lazyScreen(() => import("./screens/compose/NewStudy"), "NewStudy"),
  }),
  createRoute({
    getParentRoute: () => root,
    path: "/studies/$id",
    validateSearch: anySearch,
    component: lazyScreen(() => import("./screens/study/Study"), "Study"),
  }),
  createRoute({
    getParentRoute: () => root,
    path: "/compare",
    validateSearch: anySearch,
    component: lazyScreen(() => import("./screens/compare/Compare"), "Compare"),
  }),
  createRoute({
    getParentRoute: () => root,
    path: "/compare/batches",
    validateSearch: anySearch,
    component: lazyScreen(() => import("./screens/paired/PairedBatches"), "PairedBatches"),
  }),
  createRoute({
    getParentRoute: () => root,
    path: "/failures",
    validateSearch: anySearch,
    component: lazyScreen(() => import("./screens/failures/Failures"), "Failures"),
  }),
  createRoute({
    getParentRoute: () => root,
    path: "/suites",
    validateSearch: anySearch,
    component: lazyScreen(() => import("./screens/suites/Suites"), "Suites"),
  }),
  createRoute({
    getParentRoute: () => root,
    path: "/minimizations",
    validateSearch: anySearch,
    component: lazyScreen(() => import("./screens/minimizations/Minimizations"), "Minimizations"),
  }),
  createRoute({
    getParentRoute: () => root,
    path: "/minimizations/$id",
    validateSearch: anySearch,
    component: lazyScreen(
      () => import("./screens/minimizations/MinimizationScreen"),
      "MinimizationScreen",
    ),
  }),
  createRoute({
    getParentRoute: () => root,
    path: "/runs",
    validateSearch: anySearch,
    component: lazyScreen(() => import("./screens/runs/Runs"), "Runs"),
  }),
  createRoute({
    getParentRoute: () => root,
    path: "/agents",
    validateSearch: anySearch,
    component: lazyScreen(() => import("./screens/agents/Agents"), "Agents"),
  }),
  createRoute({
    getParentRoute: () => root,
    path: "/workers",
    validateSearch: anySearch,
    component: lazyScreen(() => import("./screens/workers/WorkersScreen"), "WorkersScreen"),
  }),
  createRoute({
    getParentRoute: () => root,
    path: "/session",
    validateSearch: anySearch,
    component: lazyScreen(() => import("./screens/session/SessionScreen"), "SessionScreen"),
  }),
  createRoute({
    getParentRoute: () => root,
    path: "/batches",
    validateSearch: anySearch,
    component: lazyScreen(() => import("./screens/batches/Batches"), "Batches"),
  }),
  createRoute({
    getParentRoute: () => root,
    path: "/batches/$batchId",
    validateSearch: anySearch,
    component: lazyScreen(() => import("./screens/batches/BatchScreen"), "BatchScreen"),
  }),
  createRoute({
    getParentRoute: () => root,
    path: "/runs/$runId",
    validateSearch: anySearch,
    loader: ({ context, params }) => {
      // Not waited for: the screen shows what is there.
      void prepareRun(context.queries, params.runId);
    },
    component: lazyScreen(() => import("./screens/replay/Run"), "Run"),
  }),
  createRoute({
    getParentRoute: () => root,
    path: "/author",
    validateSearch: anySearch,
    component: lazyScreen(() => import("./screens/author/Author"), "Author"),
  }),
  createRoute({
    getParentRoute: () => root,
    path: "/networks",
    validateSearch: anySearch,
    component: lazyScreen(() => import("./screens/networks/Networks"), "Networks"),
  }),
  createRoute({
    getParentRoute: () => root,
    path: "/networks/$name",
    validateSearch: anySearch,
    component: lazyScreen(() => import("./screens/networks/Network"), "Network"),
  }),
] as const;

export function makeRouter(queries: QueryClient) {
  return createRouter({
    routeTree: root.addChildren(screens),
    basepath: ROOT || "/",
    context: { queries },
    parseSearch,
    stringifySearch,
    scrollRestoration: true,
    defaultPreload: "intent",
    defaultErrorComponent: ScreenError,
  });
}

declare module "@tanstack/react-router" {
  interface Register {
    router: ReturnType<typeof makeRouter>;
  }
}
