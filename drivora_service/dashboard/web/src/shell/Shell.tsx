import { Link, Outlet, useNavigate, useRouterState } from "@tanstack/react-router";
import { useEffect, useState } from "react";
import { LiveState } from "../live/LiveState";
import { useLiveQueries } from "../live/useLiveQueries";
import { KeysHelp } from "./KeysHelp";
import { handleKey, useKeys } from "./keys";
import { SearchField } from "./SearchField";
import { SECTIONS } from "./sections";
import { toggleTheme, useTheme } from "./theme";

export function Shell() {
  const navigate = useNavigate();
  const theme = useTheme();
  const [help, setHelp] = useState(false);
  const path = useRouterState({ select: (state) => state.location.pathname });
  useLiveQueries();
  useEffect(() => {
    document.addEventListener("keydown", handleKey);
    return () => document.removeEventListener("keydown", handleKey);
  }, []);
  useKeys([
    { keys: "?", does: "these keys", run: () => setHelp(true) },
    ...SECTIONS.map(({ to, name, key }) => ({
      keys: `g ${key}`,
      does: `go to ${name.toLowerCase()}`,
      run: () => void navigate({ to, search: {} }),
    })),
  ]);
  return (
    <>
      <a className="skip" href="#content">
        To the content
      </a>
      <header className="top">
        <Link to="/" className="brand">
          <img src="/icon.svg" alt="" />
          Drivora
        </Link>
        <nav aria-label="Screens">
          {SECTIONS.map(({ to, name }) => (
            <Link
              key={to}
              to={to}
              search={{}}
              aria-current={path.startsWith(to) ? "page" : undefined}
            >
              {name}
            </Link>
          ))}
        </nav>
        <SearchField />
        <LiveState />
        <button
          type="button"
          onClick={toggleTheme}
          aria-label={theme === "dark" ? "Light colours" : "Dark colours"}
          title={theme === "dark" ? "Light colours" : "Dark colours"}
        >
          ◐
        </button>
        <button type="button" onClick={() => setHelp(true)} aria-label="Keys" title="Keys (?)">
          ?
        </button>
      </header>
      <main id="content" tabIndex={-1}>
        <Outlet />
      </main>
      {help && <KeysHelp onClose={() => setHelp(false)} />}
    </>
  );
}
