import { useMutation, useQueryClient } from "@tanstack/react-query";
import { api, body, type Schemas } from "../../api/client";
import { useRemembered } from "../../lists/remembered";

type Decision = Omit<Schemas["DecisionRequest"], "by">;

/** The name under which the reader decides; the browser remembers it. */
export function usePerson() {
  return useRemembered("drivora-person", (stored) => (typeof stored === "string" ? stored : ""));
}

/** Decides about groups of failures, under the reader's name. */
export function useDecisions() {
  const queries = useQueryClient();
  const [by] = usePerson();
  const onSuccess = (group: Schemas["FailureGroup"]) => {
    queries.setQueryData(["group", group.id], group);
    void queries.invalidateQueries({ queryKey: ["group"] });
    void queries.invalidateQueries({ queryKey: ["shown", "failure groups"] });
  };
  const decide = useMutation({
    mutationFn: async ({ id, ...decision }: Decision & { readonly id: string }) =>
      body(
        await api.POST("/api/v1/failures/groups/{group_id}:decide", {
          params: { path: { group_id: id } },
          body: { ...decision, by },
        }),
      ),
    onSuccess,
  });
  const merge = useMutation({
    mutationFn: async (request: { readonly into: string; readonly groups: string[] }) =>
      body(await api.POST("/api/v1/failures/groups:merge", { body: { ...request, by } })),
    onSuccess,
  });
  const split = useMutation({
    mutationFn: async ({
      id,
      ...part
    }: Omit<Schemas["SplitRequest"], "by"> & { readonly id: string }) =>
      body(
        await api.POST("/api/v1/failures/groups/{group_id}:split", {
          params: { path: { group_id: id } },
          body: { ...part, by },
        }),
      ),
    onSuccess: (group) => {
      onSuccess(group);
      void queries.invalidateQueries({ queryKey: ["shown", "failures"] });
    },
  });
  return { decide, merge, split };
}
