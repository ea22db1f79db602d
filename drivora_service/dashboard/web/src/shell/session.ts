import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { useRouter } from "@tanstack/react-router";
import { api, body } from "../api/client";
import { connectAgain } from "../live/hub";
import { allows, type Scope } from "./scope";

export const SESSION_KEY = ["session"] as const;

/** What the reader may do: asked once, and again when a request is refused. */
export function useSession() {
  return useQuery({
    queryKey: SESSION_KEY,
    queryFn: async () => body(await api.GET("/api/v1/session")),
  });
}

/** What the reader may do: screens offer only this. */
export function useScope(): {
  readonly mayRead: boolean;
  readonly maySubmit: boolean;
  readonly mayAdminister: boolean;
  /** The scope of the reader's token; null where no token is needed. */
  readonly scope: Scope | null;
} {
  const { data } = useSession();
  return {
    mayRead: allows(data, "read"),
    maySubmit: allows(data, "submit"),
    mayAdminister: allows(data, "admin"),
    scope: data?.scope ?? null,
  };
}

/** Begins and ends the reader's session. */
export function useSigning() {
  const queries = useQueryClient();
  const router = useRouter();
  const renew = async () => {
    connectAgain();
    await queries.resetQueries();
    await router.invalidate();
  };
  const signIn = useMutation({
    mutationFn: (token: string) => api.POST("/api/v1/session", { body: { token } }),
    onSuccess: renew,
  });
  const signOut = useMutation({
    mutationFn: () => api.DELETE("/api/v1/session"),
    onSettled: renew,
  });
  return { signIn, signOut };
}
