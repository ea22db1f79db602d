import type { Schemas } from "../api/client";

export type Session = Schemas["SessionState"];
export type Scope = NonNullable<Session["scope"]>;

const RANKS: readonly Scope[] = ["read", "submit", "admin"];

/** Returns whether a session may do what a scope allows; without tokens everything is allowed. */
export function allows(session: Session | undefined, scope: Scope): boolean {
  if (!session) return false;
  if (!session.tokens_needed) return true;
  return session.scope !== null && RANKS.indexOf(session.scope) >= RANKS.indexOf(scope);
}
