import { Link, useNavigate } from "@tanstack/react-router";
import type { ReactNode } from "react";
import { useKeys } from "../../shell/keys";
import { useScope } from "../../shell/session";

/** Leads to the form for a campaign or a study, as `n` does; nothing for who may not start one. */
export function NewLink({
  to,
  isShort = false,
  children,
}: {
  readonly to: "/campaigns/new" | "/studies/new";
  /** Whether another one on the screen has the key. */
  readonly isShort?: boolean;
  readonly children: ReactNode;
}) {
  const navigate = useNavigate();
  const { maySubmit } = useScope();
  const what = to === "/campaigns/new" ? "compose a campaign" : "compose a study";
  useKeys(
    maySubmit && !isShort
      ? [{ keys: "n", does: what, run: () => void navigate({ to, search: {} }) }]
      : [],
  );
  if (!maySubmit) return null;
  return (
    <Link to={to} search={{}} className="button" title={isShort ? undefined : `${what} (n)`}>
      {children}
    </Link>
  );
}
