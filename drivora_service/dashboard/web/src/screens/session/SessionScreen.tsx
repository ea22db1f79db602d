import { Link } from "@tanstack/react-router";
import { Loading, Refused } from "../../components/States";
import { useSession, useSigning } from "../../shell/session";
import { useTitle } from "../../shell/useTitle";

const MAY: Readonly<Record<string, string>> = {
  read: "see everything",
  submit: "see everything, submit, pause, resume and cancel",
  admin: "do everything",
};

/** Who is signed in, and what that allows. */
export function SessionScreen() {
  useTitle("Session");
  const session = useSession();
  const { signOut } = useSigning();
  if (session.isPending) return <Loading rows={2} />;
  if (session.isError) return <Refused error={session.error} />;
  const { tokens_needed, scope, name } = session.data;
  return (
    <section className="panel sign-in">
      <div className="inside stack">
        <h1>{tokens_needed ? `Signed in as ${name}` : "No sign-in is needed"}</h1>
        {tokens_needed ? (
          <p>
            The scope <code>{scope}</code> allows to {MAY[scope ?? "read"]}.
          </p>
        ) : (
          <p>The service answers to this machine only, and allows it everything.</p>
        )}
        <div className="row-actions">
          {tokens_needed && (
            <button
              type="button"
              disabled={signOut.isPending}
              onClick={() => signOut.mutate(undefined)}
            >
              Sign out
            </button>
          )}
          <Link to="/" className="button">
            To the start
          </Link>
        </div>
      </div>
    </section>
  );
}
