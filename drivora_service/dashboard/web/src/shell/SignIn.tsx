import { useState } from "react";
import { useSigning } from "./session";
import { useTitle } from "./useTitle";

/** Asks for a token; the service keeps the reader signed in by a cookie that scripts cannot read. */
export function SignIn() {
  useTitle("Sign in");
  const { signIn } = useSigning();
  const [token, setToken] = useState("");
  return (
    <section className="panel sign-in">
      <form
        className="inside stack"
        onSubmit={(event) => {
          event.preventDefault();
          signIn.mutate(token.trim());
        }}
      >
        <h1>Sign in</h1>
        <p className="quiet">This service needs a token. Its operator makes one with:</p>
        <pre>drivora tokens create NAME --scope read</pre>
        <label htmlFor="token">Token</label>
        <input
          id="token"
          type="password"
          autoComplete="current-password"
          // The only thing to do on this screen.
          // biome-ignore lint/a11y/noAutofocus: the reader came to type a token
          autoFocus
          value={token}
          onChange={(event) => setToken(event.target.value)}
          aria-invalid={signIn.isError}
          aria-describedby={signIn.isError ? "token-refused" : undefined}
        />
        {signIn.isError && (
          <p id="token-refused" role="alert" className="refusal">
            {signIn.error.message}
          </p>
        )}
        <button type="submit" className="primary" disabled={!token.trim() || signIn.isPending}>
          {signIn.isPending ? "Signing in" : "Sign in"}
        </button>
      </form>
    </section>
  );
}
