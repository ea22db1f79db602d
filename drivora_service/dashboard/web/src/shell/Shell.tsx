import { Link, Outlet, useNavigate, useRouterState } from "@tanstack/react-router";
import { useEffect, useState } from "react";
import { Loading } from "../components/States";
import { LiveState } from "../live/LiveState";
import { useLiveQueries } from "../live/useLiveQueries";
import { addressOf } from "../service";
import { KeysHelp } from "./KeysHelp";
import { handleKey, useKeys } from "./keys";
import { SearchField } from "./SearchField";
import { SignIn } from "./SignIn";
import { allows } from "./scope";
import { SECTIONS } from "./sections";
import { useSession } from "./session";
import { toggleTheme, useTheme } from "./theme";

export function Shell() {
  const navigate = useNavigate();
  const theme = useTheme();
  const [help, setHelp] = useState(false);
  const path = useRouterState({ select: (state) => state.location.pathname });
  const session = useSession();
  // A service that cannot be asked is told of by the screen.
  const signedOut = session.isSuccess && !allows(session.data, "read");
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
          <img src={addressOf("/icon.svg")} alt="" />
          Drivora
        </Link>
        {!signedOut && <Sections path={path} />}
        {session.isSuccess && !signedOut && (
          <>
            <SearchField />
            <Live />
          </>
        )}
        {session.data?.tokens_needed && !signedOut && (
          <Link to="/session" search={{}} className="button" title="Signed in; sign out here">
            {session.data.name || "session"}
          </Link>
        )}
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
        {session.isPending ? <Loading /> : signedOut ? <SignIn /> : <Outlet />}
      </main>
      {help && <KeysHelp onClose={() => setHelp(false)} />}
    </>
  );
}

function Sections({ path }: { readonly path: string }) {
  return (
    <nav aria-label="Screens">
      {SECTIONS.map(({ to, name }) => (
        <Link key={to} to={to} search={{}} aria-current={path.startsWith(to) ? "page" : undefined}>
          {name}
        </Link>
      ))}
    </nav>
  );
}

/** The connection for what changes: it is there once the reader may see something. */
function Live() {
  useLiveQueries();
  return <LiveState />;
}
