import { QueryCache, QueryClient, QueryClientProvider } from "@tanstack/react-query";
import { RouterProvider } from "@tanstack/react-router";
import { StrictMode } from "react";
import { createRoot } from "react-dom/client";
import { Problem } from "./api/client";
import { makeRouter } from "./router";
import { addressOf, ROOT } from "./service";
import { SESSION_KEY } from "./shell/session";
import { applyTheme } from "./shell/theme";
import "./style/index.css";

const AFTER_FIRST_SCREEN_MS = 3000;

applyTheme();

const queries: QueryClient = new QueryClient({
  queryCache: new QueryCache({
    onError: (error, query) => {
      // The token has ended or was withdrawn: the page asks for another one.
      if (error instanceof Problem && error.status === 401 && query.queryKey[0] !== "session")
        void queries.invalidateQueries({ queryKey: SESSION_KEY });
    },
  }),
  defaultOptions: {
    queries: {
      // What has changed is told by events; nothing is asked for again because time has passed.
      staleTime: Number.POSITIVE_INFINITY,
      refetchOnWindowFocus: false,
      retry: (count, error) =>
        count < 3 && error instanceof Problem && [0, 429, 503].includes(error.status),
    },
  },
});

// A document that was asked for without the path of the proxy, from the service itself.
if (!`${window.location.pathname}/`.startsWith(`${ROOT}/`))
  window.history.replaceState(
    null,
    "",
    addressOf(window.location.pathname + window.location.search),
  );

const router = makeRouter(queries);

/** Loads the code of all screens, so that each can be opened even if the service has ended. */
async function loadScreens(): Promise<void> {
  for (const route of Object.values(router.routesById)) {
    // The error is told when the screen is opened.
    await router.loadRouteChunk(route)?.catch(() => undefined);
  }
}

const page = document.getElementById("page");
if (page) {
  createRoot(page).render(
    <StrictMode>
      <QueryClientProvider client={queries}>
        <RouterProvider router={router} />
      </QueryClientProvider>
    </StrictMode>,
  );
  // After what the first screen needs.
  setTimeout(() => void loadScreens(), AFTER_FIRST_SCREEN_MS);
}
