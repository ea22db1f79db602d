import { Link } from "@tanstack/react-router";
import type { ReactNode } from "react";
import { Problem } from "../api/client";
import { useLive } from "../live/hub";

/** A screen without content says what would fill it, with the command. */
export function Empty({
  title,
  command,
  children,
}: {
  readonly title: string;
  readonly command?: string;
  readonly children?: ReactNode;
}) {
  return (
    <section className="state">
      <h2>{title}</h2>
      {children}
      {command && <pre>{command}</pre>}
    </section>
  );
}

/** The layout of a list before its rows are there. */
export function Loading({ rows = 6 }: { readonly rows?: number }) {
  const live = useLive();
  return (
    <div className="loading" role="status">
      <span className="hidden-visually">Loading</span>
      {!live && <p className="late">No connection to the service, trying again.</p>}
      {Array.from({ length: rows }, (_, row) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: rows of the same look
        <div key={row} className="bar" style={{ width: `${92 - ((row * 13) % 40)}%` }} />
      ))}
    </div>
  );
}

/** What the service said of a refused request, and what to do. */
export function Refused({
  error,
  onRepeat,
}: {
  readonly error: unknown;
  readonly onRepeat?: () => void;
}) {
  const problem = error instanceof Problem ? error : undefined;
  return (
    <section className="state error" role="alert">
      <h2>
        {problem ? `${problem.title}${problem.status ? ` (${problem.status})` : ""}` : "Error"}
      </h2>
      <p>{error instanceof Error ? error.message : String(error)}</p>
      {problem && problem.problems.length > 0 && (
        <ul>
          {problem.problems.map((item) => (
            <li key={`${item.pointer} ${item.message}`}>
              <code>{item.pointer || "/"}</code> {item.message}
            </li>
          ))}
        </ul>
      )}
      {onRepeat && (
        <button type="button" onClick={onRepeat}>
          Ask again
        </button>
      )}
    </section>
  );
}

export function NotFound() {
  return (
    <Empty title="There is no such screen">
      <p>
        The address names no screen. <Link to="/">Begin at the start</Link>.
      </p>
    </Empty>
  );
}
