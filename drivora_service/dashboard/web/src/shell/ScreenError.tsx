import { type ErrorComponentProps, useRouter } from "@tanstack/react-router";
import { useEffect } from "react";
import { Problem } from "../api/client";
import { Copy } from "../components/Copy";
import { Refused } from "../components/States";
import { ScreenNotLoaded } from "../screen";
import { adviceFor } from "./advice";

const RELOADED = "drivora.reloaded";
const ONCE_IN_MS = 30_000;

/** Loads the page anew if a part of it is missing, which that mends; once, if it does not. */
function useReload(error: Error): void {
  useEffect(() => {
    if (!(error instanceof ScreenNotLoaded)) return;
    const key = `${RELOADED} ${window.location.pathname}`;
    if (Date.now() - Number(sessionStorage.getItem(key)) < ONCE_IN_MS) return;
    sessionStorage.setItem(key, String(Date.now()));
    window.location.reload();
  }, [error]);
}

/** What a screen that cannot be shown says, and what to do. */
export function ScreenError({ error: thrown, reset }: ErrorComponentProps) {
  const error = thrown instanceof Error ? thrown : new Error(String(thrown));
  const router = useRouter();
  useReload(error);
  const again = () => {
    reset();
    void router.invalidate();
  };
  if (error instanceof Problem) return <Refused error={error} onRepeat={again} />;
  const { title, says } = adviceFor(error);
  const report = [
    `${error.name}: ${error.message}`,
    `address: ${window.location.href}`,
    `browser: ${navigator.userAgent}`,
    error.stack ?? "",
  ].join("\n");
  return (
    <section className="state error" role="alert">
      <h1>{title}</h1>
      <p>{says}</p>
      <pre>{error.message || error.name}</pre>
      <div className="row-actions">
        <button type="button" className="primary" onClick={() => window.location.reload()}>
          Reload the page
        </button>
        <button type="button" onClick={again}>
          Try again
        </button>
        <Copy text={report} label="Copy the report" />
      </div>
    </section>
  );
}
