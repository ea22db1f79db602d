import { type ErrorComponentProps, useRouter } from "@tanstack/react-router";
import { Problem } from "../api/client";
import { Copy } from "../components/Copy";
import { Refused } from "../components/States";
import { adviceFor } from "./advice";

/** What a screen that cannot be shown says, and what to do. */
export function ScreenError({ error: thrown, reset }: ErrorComponentProps) {
  const error = thrown instanceof Error ? thrown : new Error(String(thrown));
  const router = useRouter();
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
